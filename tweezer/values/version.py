"""Versions of tweezer and its numerical libraries, and provenance of results."""

import datetime as dt
import functools
import importlib.metadata

__version__ = importlib.metadata.version("tweezer")


@functools.cache
def versions() -> dict[str, str]:
    """Return the versions of tweezer and of the libraries in use, as attributes of a result."""
    import numba
    import numpy as np
    import scipy

    libraries = {f"{each.__name__}_version": each.__version__ for each in (np, scipy, numba)}
    return {"tweezer_version": __version__, **libraries}


#: Attributes on the form and origin of a result, which its numbers do not depend on
FORMAL = ("Conventions", "history", "title")


def made_by(what: str, *, dated: bool) -> dict[str, str]:
    """Return the attributes `Conventions` and `history` of a dataset (CF Conventions 1.11, 2.6).

    `what` is the function that computed it. If `dated`, the time of day is included; results that
    must have the same bytes in every computation omit it.
    """
    history = f"tweezer {__version__}: {what}"
    if dated:
        now = dt.datetime.now(dt.UTC).isoformat(timespec="seconds")
        history = f"{now}: {history}"
    return {"Conventions": "CF-1.11", "history": history}
