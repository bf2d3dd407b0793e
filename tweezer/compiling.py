"""What Numba compiles: where it is kept, and that it is told.

Compiled functions are kept beside their sources, or in the user's cache folder where these cannot
be written, or in NUMBA_CACHE_DIR. Importing this module sees to it that there is such a place,
which Numba wants to know before the first function is defined.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import gc
import itertools
import logging
import secrets
import shutil
import tempfile
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import Any

import numba
from filelock import FileLock
from numba.core import caching, event
from numba.core.bytecode import FunctionIdentity
from numba.core.dispatcher import Dispatcher

_log = logging.getLogger("tweezer")

#: s of compiling after which it is told to who uses the library
_PATIENCE = 1.0
#: s that another process is waited for, which keeps a function in milliseconds
_LOCKED = 10.0


class Compilation(event.Listener):
    """What is compiled of tweezer, and the time that takes."""

    def __init__(self, say: Callable[[Compilation], None]) -> None:
        """say: called with this as each function is begun."""
        self._say = say
        self._within = 0  # functions compiled because another calls them
        self._spent = self._began = 0.0
        self.functions = 0
        """begun so far that are kept"""
        self.latest = ""
        """name of the one begun last"""

    @property
    def seconds(self) -> float:
        """s, spent so far."""
        return self._spent + (time.perf_counter() - self._began if self._within else 0.0)

    def on_start(self, begun: event.Event) -> None:
        """Numba begins to compile."""
        if not _ours(begun.data["dispatcher"]):
            return
        if not self._within:
            self._began = time.perf_counter()
        self._within += 1
        function = begun.data["dispatcher"].py_func
        self.functions += begun.data["dispatcher"].stats.cache_path is not None
        self.latest = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"
        self._say(self)

    def on_end(self, ended: event.Event) -> None:
        """It has compiled, or failed to."""
        if not _ours(ended.data["dispatcher"]):
            return
        self._spent, self._began = self.seconds, time.perf_counter()
        self._within -= 1


def compilation(say: Callable[[Compilation], None]) -> AbstractContextManager[Compilation]:
    """Watch what is compiled within the context; `say` is called as each function is begun."""
    installed: AbstractContextManager[Compilation] = event.install_listener(
        "numba:compile", Compilation(say)
    )
    return installed


def found() -> int:
    """Functions of tweezer that this process found kept."""
    return sum(
        sum(each.stats.cache_hits.values())
        for each in gc.get_objects()
        if isinstance(each, Dispatcher) and _ours(each)
    )


def _ours(dispatcher: Dispatcher) -> bool:
    return dispatcher.py_func.__module__.partition(".")[0] == "tweezer"


def _find_place() -> None:
    """Numba refuses to define a function that it is to keep and has no place for."""
    try:
        numba.njit(cache=True)(_find_place)
    except RuntimeError:
        folder = tempfile.mkdtemp(prefix="tweezer-")
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        numba.config.CACHE_DIR = folder
        warnings.warn(
            "what is compiled is not kept: neither the folder of tweezer nor the user's cache "
            "folder can be written; set NUMBA_CACHE_DIR to one that can",
            stacklevel=2,
        )


def _tell(compiling: Compilation) -> None:
    if compiling.seconds > _PATIENCE:  # nothing is said of a moment's work
        _tell_once()


@functools.cache
def _tell_once() -> None:
    _log.warning("compiling, once: the next runs load it (`tweezer warmup` does it ahead)")


@contextlib.contextmanager
def _locked(folder: str) -> Iterator[bool]:
    """Whether what is compiled in a folder is this process's alone: not where locks do not work."""
    lock = FileLock(f"{folder}/.lock", timeout=_LOCKED, mode=0o666, is_singleton=True)
    try:
        lock.acquire(poll_interval=5e-3)
    except (OSError, NotImplementedError):
        yield False
        return
    try:
        yield True
    finally:
        lock.release()


class _Alone(caching.IndexDataCacheFile):
    """Files of a compiled function, read and written by one process at a time.

    Numba reads an index, numbers a file by it, writes the index and then the file: of two processes
    that keep variants at once either may later be given the other's code, and so may who comes
    after one that was stopped in between. Nothing is kept or found where files cannot be locked.

    An index names the types of its variants, also those of a program's own module, for a field of
    force that it brought. One that cannot be read without that module is begun anew: programs that
    bring fields of their own do better with a NUMBA_CACHE_DIR of their own.
    """

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except OSError:
            raise
        except Exception as error:  # reading it imports whatever it names
            _log.debug("%s cannot be read: %s", self._index_path, error)
            return {}

    def load(self, key: Any) -> Any:
        with _locked(self._cache_path) as alone:
            return super().load(key) if alone else None

    def save(self, key: Any, data: Any) -> None:
        with _locked(self._cache_path) as alone:
            if not alone:
                return
            index = self._load_index()
            numbered = map(self._data_name, itertools.count(1))
            name = index.get(key) or next(each for each in numbered if each not in index.values())
            self._save_data(name, data)
            self._save_index({**index, key: name})


_find_place()
caching.IndexDataCacheFile = _Alone
# Numba counts the functions that a process compiles, and variants of one function differ by that
# number alone in the name of their machine code: of two compiled by two processes and kept, one
# would be called in place of the other (numba issue 10486). Numbers that no two processes share:
FunctionIdentity._unique_ids = iter(functools.partial(secrets.randbits, 64), None)
event.register("numba:compile", Compilation(_tell))
