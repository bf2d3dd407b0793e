"""The one table of what a page can show, and how it is found in what is given."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

from tweezer.errors import ResultError

if TYPE_CHECKING:
    from tweezer.viewing.content import Content


class Kind(NamedTuple):
    """A kind of page."""

    name: str
    """its Python is `of_NAME.py`, its script `static/NAME.js`"""
    shows: str
    is_one: Callable[[Any], bool]
    """whether an object, a dataset or a `Trap`, is of this kind"""


def _has(*attributes: str) -> Callable[[Any], bool]:
    return lambda given: all(name in getattr(given, "attrs", {}) for name in attributes)


#: The first that fits is taken
KINDS = (
    Kind("sweep", "a sweep", _has("scene", "over")),
    Kind("ensemble", "an ensemble", _has("scene", "trajectories")),
    Kind("run", "a run", _has("scene", "status")),
    Kind("trap", "a trap", lambda given: hasattr(given, "equilibrium")),
)


def content_of(given: Any) -> Content:
    """What the page of a dataset or a `Trap` shows. Raises `ResultError` for what has none."""
    for kind in KINDS:
        if kind.is_one(given):
            module = importlib.import_module(f"tweezer.viewing.of_{kind.name}")
            content: Content = module.content(given)
            return content
    every = ", ".join(kind.shows for kind in KINDS)
    raise ResultError(f"{type(given).__name__}: no page shows it; there are pages of {every}")
