"""What a page shows, before it is a page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from tweezer.viewing.arrays import Packed


class Row(NamedTuple):
    """A line of the summary."""

    name: str
    value: str
    error: str = ""
    """as text: "± 2 nm", or "not known"; "" of what has none"""
    trusted: bool = True


@dataclass(frozen=True)
class Content:
    """What a page shows."""

    kind: str
    """of `tweezer.values.saved.KINDS`, its page: which module of the page draws it"""
    title: str
    facts: dict[str, Any]
    """numbers and words that the page's module reads, as JSON"""
    arrays: dict[str, Packed]
    summary: list[Row]
    notes: list[str]
    """what a reader must know to trust the page, a short whole sentence or two each"""
    warning: str = ""
    """why the page does not show what was asked for: a run that was interrupted, or failed"""
