"""What a page shows, before it is a page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from tweezer.viewing.arrays import Packed


class Row(NamedTuple):
    """One line of the summary beside a page's picture: a quantity with its value."""

    name: str
    value: str
    """with its unit, as text"""
    error: str = ""
    """as text: "± 2 nm", or "not known"; "" for a value without an error"""
    trusted: bool = True
    """whether the value is valid; one that is not is marked on the page"""


@dataclass(frozen=True)
class Content:
    """Everything that an interactive page shows, before it is written as HTML."""

    kind: str
    """name of the JavaScript module that draws the page, `page` of `tweezer.values.saved.KINDS`"""
    title: str
    facts: dict[str, Any]
    """single numbers and words for that module, by names that it knows, as JSON"""
    arrays: dict[str, Packed]
    """arrays of numbers for that module, by names that it knows"""
    summary: list[Row]
    notes: list[str]
    """facts that a reader must know to trust the page, one or two short sentences each"""
    warning: str = ""
    """reason why the page is incomplete: the run was interrupted, or failed; "" for none"""
