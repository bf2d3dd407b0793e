"""Environments of functions that compiled code contains, kept without the modules they are from.

An environment holds the Python objects that a function refers to. Numba keeps it by the name of its
module, and imports that module to read it, such as all of Numba's functions of arrays and of text.
Compiled code uses the objects but not the module. The imports took a twentieth of a short command.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from numba.core.environment import Environment, lookup_environment


class Kept(NamedTuple):
    """An environment as the cache stores it."""

    name: str
    module: str
    objects: list[Any]


def to_keep(environments: Iterable[Environment]) -> tuple[Kept, ...]:
    """Return environments as the cache stores them."""
    return tuple(
        Kept(each.env_name, each.globals["__name__"], each.consts) for each in environments
    )


def rebuilt(kept: Iterable[Kept]) -> tuple[Environment, ...]:
    """Return the environments, with only the name of their module for its contents."""
    return tuple(lookup_environment(each.name) or _made(each) for each in kept)


def _made(kept: Kept) -> Environment:
    """Make an environment, as `numba.core.environment._rebuild_env` does of a module."""
    environment = Environment({"__name__": kept.module})
    environment.consts[:] = kept.objects
    environment.env_name = kept.name
    Environment._memo[kept.name] = environment
    return environment
