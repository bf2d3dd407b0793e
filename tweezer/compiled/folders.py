"""Files of compiled functions that tweezer has stored, in every folder that Numba may have chosen.

The command `tweezer cache` lists and deletes them.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterator
from pathlib import Path

import numba
from numba.core import caching

#: Names of the files of compiled functions: module, function, line and Python version; the file
#: ending in .nbi is Numba's own index
_FUNCTION = r"\w+\.[\w.<>]+-\d+\.py\d+[a-z]*"
_KEPT = re.compile(rf"{_FUNCTION}\.(nbi|\d+\.nbc|[0-9a-f]{{16}}\.nbc)")
#: Name of such a file during writing
UNFINISHED = re.compile(rf"{_FUNCTION}\.[0-9a-f]{{16}}\.nbc\.[0-9a-f]{{16}}")


def kept() -> list[Path]:
    """Return every file of tweezer's compiled functions.

    Files are beside the sources, in the user's cache folder, and in NUMBA_CACHE_DIR if it is set.
    """
    return [each for folder in folders() for each in _of_functions(folder)]


def folders() -> list[Path]:
    """Return the existing folders for compiled functions; a folder of sources may have several."""
    where: list[type] = [caching.InTreeCacheLocator, caching.UserWideCacheLocator]
    if numba.config.CACHE_DIR:
        where.insert(0, caching.UserProvidedCacheLocator)
    sources = [min(folder.glob("*.py"), default=None) for folder in _of_sources()]
    paths = (Path(at(kept, str(file)).get_cache_path()) for file in sources if file for at in where)
    return [each for each in dict.fromkeys(paths) if is_own(each)]


def is_own(folder: Path) -> bool:
    """Return whether a folder exists, and neither it nor its parent is a symbolic link."""
    return folder.is_dir() and not folder.is_symlink() and not folder.parent.is_symlink()


def _of_sources() -> Iterator[Path]:
    """Yield the folders of tweezer's modules, and those of the emitted modules."""
    package = Path(__file__).parents[1]
    emitted = importlib.import_module("tweezer.generated").__path__
    for top in (package, *map(Path, emitted)):
        yield top
        yield from (each for each in sorted(top.rglob("*")) if each.is_dir())


def _of_functions(folder: Path) -> list[Path]:
    """Return the files of compiled functions in a folder, sorted, including unfinished ones."""
    return sorted(
        each
        for each in folder.iterdir()
        if (_KEPT.fullmatch(each.name) or UNFINISHED.fullmatch(each.name))
        and each.is_file()
        and not each.is_symlink()
    )
