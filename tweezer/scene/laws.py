"""Table of the laws of force between beads: tethers, and forces between surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tweezer.scene.choices import CHAINS
from tweezer.scene.courses import refusal


@dataclass(frozen=True)
class Law:
    """A law of force over the distance of two surfaces, with the keys that it takes."""

    name: str
    about: str
    """description in a few words"""
    needs: tuple[str, ...]
    """keys that it requires"""
    may: tuple[str, ...] = ()
    """keys that it accepts in addition"""


_CHAIN = "contour_length", "persistence_length"
#: Laws of chains that begin at no extension, as a tether does
_FROM_SLACK = "marko-siggia", "bouchiat", "fjc", "efjc"

#: Laws of tethers
TETHERS = {
    "spring": Law("spring", "a linear spring", ("stiffness",), ("length",)),
    **{
        name: Law(name, CHAINS[name].about, (*_CHAIN, *CHAINS[name].needs), CHAINS[name].may)
        for name in _FROM_SLACK
    },
}
#: Laws of forces between the surfaces of all beads
BETWEEN = {
    each.name: each
    for each in (
        Law(
            "dlvo", "double layer B exp(-gap/l_D) and van der Waals",
            ("strength", "debye_length"), ("hamaker_constant",),
        ),
        Law("wca", "repulsion (Weeks, Chandler, Andersen)", ("strength", "range")),
        Law("hertz", "contact of soft layers", ("modulus", "range")),
        Law("spring", "a linear spring", ("stiffness",), ("gap",)),
    )
}  # fmt: skip


def check_keys(law: Law, chosen_by: str, keys: Mapping[str, Any]) -> None:
    """Refuse missing keys, and keys that do not apply to a law.

    Parameters
    ----------
    law : Law
        The law.
    chosen_by : str
        Key that names the law.
    keys : mapping
        Values by key, None for those that are not given.
    """
    for key, value in keys.items():
        if key in law.needs and value is None:
            raise refusal(f"{key}: missing; {chosen_by} = {law.name!r} requires it")
        if value is not None and key not in law.needs + law.may:
            raise refusal(f"{key} = {value!r}: does not apply to {chosen_by} = {law.name!r}")
