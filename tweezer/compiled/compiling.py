"""Folder of compiled functions, notice while compiling, and count and time of compilations.

Compiled functions are stored beside their sources. If that folder cannot be written, they are
stored in the user's cache folder; NUMBA_CACHE_DIR selects another folder. Importing this module
chooses the folder, because Numba needs it before the first function is defined. Plain Numba (module
`plain`) uses a folder of its own within that of NUMBA_CACHE_DIR or the user's.
"""

from __future__ import annotations

import atexit
import functools
import gc
import hashlib
import importlib
import logging
import os
import shutil
import tempfile
import time
import weakref
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import numba
from numba.core import event
from numba.core.dispatcher import Dispatcher

from tweezer.values.errors import warn

_log = logging.getLogger("tweezer")

#: Whether plain Numba replaces tweezer's own cache
PLAIN = os.environ.get("TWEEZER_PLAIN_NUMBA", "0") not in ("", "0")
#: Compile time before the notice is shown, s
_PATIENCE = 1.0
#: Functions of this process that a cache stores
stored: weakref.WeakSet[Dispatcher] = weakref.WeakSet()


class Compilation(event.Listener):
    """Count and duration of the compilations of tweezer's functions, as an event listener."""

    def __init__(self, say: Callable[[Compilation], None]) -> None:
        """Call `say` with this object whenever the compilation of a function begins."""
        self._say = say
        self._within = 0  # compilations in progress; calling a function compiles it within another
        self._spent = self._began = 0.0
        self.functions = self.compiled = 0
        """numbers of stored functions whose compilation began, and whose compilation succeeded"""
        self.latest = ""
        """name of the function begun last"""

    @property
    def seconds(self) -> float:
        """Compile time so far, s."""
        return self._spent + (time.perf_counter() - self._began if self._within else 0.0)

    def on_start(self, begun: event.Event) -> None:
        """Count a function whose compilation begins; Numba calls this method."""
        dispatcher = begun.data["dispatcher"]
        if not _ours(dispatcher):
            return
        if not self._within:
            self._began = time.perf_counter()
        self._within += 1
        self.functions += _is_stored(dispatcher)
        function = dispatcher.py_func
        self.latest = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
        self._say(self)

    def on_end(self, ended: event.Event) -> None:
        """Count a function whose compilation succeeded or failed; Numba calls this method."""
        dispatcher = ended.data["dispatcher"]
        if not _ours(dispatcher):
            return
        self._spent, self._began = self.seconds, time.perf_counter()
        self._within -= 1
        self.compiled += _is_stored(dispatcher) and not ended.is_failed


class _Uncollected(event.Listener):
    """Event listener that pauses garbage collection while Numba compiles.

    A compilation creates many objects in reference cycles, all of them in use, and collecting
    takes a quarter of its time. Numba compiles in one thread at a time.
    """

    def __init__(self) -> None:
        self._within = 0
        self._enabled = False

    def on_start(self, begun: event.Event) -> None:  # noqa: ARG002
        """Pause garbage collection when a compilation begins; Numba calls this method."""
        if not self._within:
            self._enabled = gc.isenabled()
            gc.disable()
        self._within += 1

    def on_end(self, ended: event.Event) -> None:  # noqa: ARG002
        """Resume garbage collection when the outermost compilation ends; Numba calls it."""
        self._within -= 1
        if not self._within and self._enabled:
            gc.enable()


def compilation(say: Callable[[Compilation], None]) -> AbstractContextManager[Compilation]:
    """Observe compilation within the context; `say` is called when the compilation of a function
    begins.
    """
    installed: AbstractContextManager[Compilation] = event.install_listener(
        "numba:compile", Compilation(say)
    )
    return installed


def found() -> int:
    """Return the number of tweezer's functions that this process loaded from the cache."""
    return sum(sum(each.stats.cache_hits.values()) for each in stored if _ours(each))


def kept() -> bool:
    """Return whether this process stored compiled functions that later processes can load."""
    return _notice.compiled > 0 and not not_kept.cache_info().currsize


@functools.cache
def not_kept(why: str) -> None:
    """Warn once in a process that compiled functions are not stored, with the reason `why`."""
    warn(f"compiled functions cannot be stored: {why}", UserWarning)


def _ours(dispatcher: Dispatcher) -> bool:
    """Return whether a compiled function belongs to tweezer."""
    return str(dispatcher.py_func.__module__).partition(".")[0] == "tweezer"


def _is_stored(dispatcher: Dispatcher) -> bool:
    """Return whether a cache stores the code of a compiled function."""
    return dispatcher.stats.cache_path is not None


def _folder_of_these_sources() -> str:
    """Return a cache folder for plain Numba that depends on the content of tweezer's sources."""
    from platformdirs import user_cache_path

    digest = hashlib.sha256()
    for package in ("tweezer", "tweezer.generated"):
        (folder,) = importlib.import_module(package).__path__
        for path in sorted(Path(folder).rglob("*.py")):
            digest.update(path.read_bytes())
    parent = numba.config.CACHE_DIR or user_cache_path("tweezer") / "compiled"
    return str(Path(parent) / f"plain-{digest.hexdigest()[:16]}")


def _find_place() -> None:
    """Choose a folder for Numba's cache, without which Numba refuses to define cached functions.

    If no usual folder can be written, a temporary one is used until the process ends.
    """
    try:
        numba.njit(cache=True)(_find_place)
    except RuntimeError:
        folder = tempfile.mkdtemp(prefix="tweezer-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        numba.config.CACHE_DIR = folder
        not_kept(
            "neither the folder of tweezer nor the user's cache folder can be written; set "
            "NUMBA_CACHE_DIR to one that can"
        )


def _tell(compiling: Compilation) -> None:
    """Log a notice that functions are being compiled, if compiling has taken more than 1 s."""
    if compiling.seconds > _PATIENCE:
        _tell_once()


@functools.cache
def _tell_once() -> None:
    """Log the notice that functions are being compiled, once in a process."""
    _log.warning("compiling, once: the next runs load it (`tweezer warmup` does it in advance)")


if PLAIN:
    numba.config.CACHE_DIR = _folder_of_these_sources()
_find_place()
_notice = Compilation(_tell)
event.register("numba:compile", _notice)
event.register("numba:compile", _Uncollected())
