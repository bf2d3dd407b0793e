"""Versions of tweezer and of the libraries that its numbers depend on."""

import functools
import importlib.metadata

__version__ = importlib.metadata.version("tweezer")


@functools.cache
def versions() -> dict[str, str]:
    """The versions that are installed, as attributes of a result."""
    libraries = {
        f"{name}_version": importlib.metadata.version(name) for name in ("numpy", "scipy", "numba")
    }
    return {"tweezer_version": __version__, **libraries}
