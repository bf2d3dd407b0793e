"""From what is given to what its page shows."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from tweezer.errors import ResultError
from tweezer.saved import SHOWN, kind_of, refusal

if TYPE_CHECKING:
    from tweezer.viewing.content import Content


def content_of(given: Any, name: str) -> Content:
    """What the page of a dataset or a `Trap` shows.

    name: of what is given. Raises `ResultError` for what has no page.
    """
    kind = kind_of(given)
    page = kind.page if kind else ""
    if not hasattr(given, "attrs") and hasattr(given, "equilibrium"):
        page = "trap"
    if not page:
        raise ResultError(f"{name}: {refusal(kind, 'view', SHOWN)}")
    content: Content = importlib.import_module(f"tweezer.viewing.of_{page}").content(given)
    return content
