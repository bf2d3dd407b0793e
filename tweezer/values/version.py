"""Versions of tweezer and of the libraries that its numbers depend on; what made a result."""

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


#: Attributes that say of what form a result is and what made it, and nothing of its numbers
FORMAL = ("Conventions", "history", "title")


def made_by(what: str, *, dated: bool) -> dict[str, str]:
    """`Conventions` and `history` of a dataset (CF Conventions 1.11, 2.6.1 and 2.6.2).

    what: the function that made it. dated: with the time of day; results that must have the same
    bytes whenever they are computed go without.
    """
    history = f"tweezer {__version__}: {what}"
    if dated:
        now = dt.datetime.now(dt.UTC).isoformat(timespec="seconds")
        history = f"{now}: {history}"
    return {"Conventions": "CF-1.11", "history": history}
