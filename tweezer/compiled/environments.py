"""Environments of compiled functions, stored so that loading them imports no other modules.

An environment is Numba's list of the Python objects that a function refers to. Numba stores it by
the name of its module, and imports that module to load it, for example all of Numba's functions of
arrays and text. Compiled code needs only the objects. The imports took a twentieth of a short
command.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from numba.core.environment import Environment, lookup_environment


class Kept(NamedTuple):
    """An environment in the form that the cache stores."""

    name: str
    module: str
    objects: list[Any]


def to_keep(environments: Iterable[Environment]) -> tuple[Kept, ...]:
    """Return environments in the form that the cache stores."""
    return tuple(
        Kept(each.env_name, each.globals["__name__"], each.consts) for each in environments
    )


def rebuilt(kept: Iterable[Kept]) -> tuple[Environment, ...]:
    """Return the environments from their stored form, without importing their modules."""
    return tuple(lookup_environment(each.name) or _made(each) for each in kept)


def _made(kept: Kept) -> Environment:
    """Create an environment, as `numba.core.environment._rebuild_env` does from a module."""
    environment = Environment({"__name__": kept.module})
    environment.consts[:] = kept.objects
    environment.env_name = kept.name
    Environment._memo[kept.name] = environment
    return environment
