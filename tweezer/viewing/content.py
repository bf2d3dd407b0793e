"""Content of a page, independent of HTML."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from tweezer.viewing.arrays import Packed


class Row(NamedTuple):
    """One line of the summary beside the picture of a page: a quantity with its value."""

    name: str
    value: str
    """text of the value with its unit"""
    error: str = ""
    """text of the error, such as "± 2 nm" or "not known"; "" for a value without an error"""
    trusted: bool = True
    """whether the value is valid; the page marks one that is not"""


@dataclass(frozen=True)
class Content:
    """Everything that an interactive page shows, before it is written as HTML."""

    kind: str
    """name of the JavaScript module that draws the page, `page` of `tweezer.values.saved.KINDS`"""
    title: str
    facts: dict[str, Any]
    """numbers and words for the JavaScript module, as JSON, by the names that it expects"""
    arrays: dict[str, Packed]
    """arrays of numbers for the JavaScript module, by the names that it expects"""
    summary: list[Row]
    notes: list[str]
    """information that a reader needs to trust the page, one or two short sentences each"""
    warning: str = ""
    """reason why the page is incomplete, such as an interrupted run; "" if it is complete"""
