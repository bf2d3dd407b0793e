"""Selection of the module that creates the page of a result."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from tweezer.results.schema import rising
from tweezer.values.errors import ResultError, TweezerError
from tweezer.values.saved import SHOWN, kind_of, refusal

if TYPE_CHECKING:
    from tweezer.viewing.content import Content


def content_of(given: Any, name: str) -> Content:
    """Return the content of the page of a dataset or a `Trap`.

    `name` is the name of the result in messages. Raises `ResultError` for a result without a page.
    """
    kind = kind_of(given)
    if kind is None or not kind.page:
        raise ResultError(f"{name}: {refusal(kind, 'view', SHOWN)}")
    try:
        for reason in rising(given, "time") if "time" in getattr(given, "sizes", ()) else ():
            raise ResultError(reason)
        content: Content = importlib.import_module(f"tweezer.viewing.of_{kind.page}").content(given)
    except TweezerError as error:  # also errors of the scene, such as a bead too far from the focus
        raise ResultError(f"{error}" if name in str(error) else f"{name}: {error}") from None
    return content
