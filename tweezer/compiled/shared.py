"""Compilation shared by two processes, so that neither compiles a function that the other compiles.

A process that compiles a function for Python locks a file in a shared folder. The other process
waits for the lock and loads the function from the cache. A process has one lock at a time and
requests none while it compiles, so there is no deadlock. A lock is released when its process ends.
"""

from __future__ import annotations

import hashlib
import os
from pathlib import Path
from typing import Any

from numba.core import event

from tweezer.compiled.compiling import PLAIN

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

#: Whether this system has file locks and tweezer's own compilation is used
POSSIBLE = fcntl is not None and not PLAIN


class _Lock:
    """State of this process: the folder of lock files and the file descriptor of its lock."""

    folder: Path | None = None
    held: int | None = None


_lock = _Lock()


def share(folder: Path | None) -> None:
    """Share compilation with the process that uses the same folder; stop sharing if None."""
    release()
    _lock.folder = folder


def claim(name: str, dispatcher: Any) -> bool:
    """Wait until no other process compiles a function, and lock it for this process.

    `name` identifies the variant of the function and `dispatcher` is its Numba object. The wait
    counts as compile time. Returns whether compilation is shared.
    """
    if _lock.folder is None:
        return False
    release()
    path = _lock.folder / hashlib.sha256(name.encode()).hexdigest()
    try:
        _lock.held = os.open(path, os.O_CREAT | os.O_RDWR, 0o600)
        try:
            fcntl.flock(_lock.held, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            with event.trigger_event("numba:compile", data={"dispatcher": dispatcher}):
                fcntl.flock(_lock.held, fcntl.LOCK_EX)
    except OSError:  # the other process has removed the folder, or the file system has no locks
        release()
        return False
    return True


def release() -> None:
    """Release the lock, so that the other process can load the function that was compiled last."""
    if _lock.held is not None:
        os.close(_lock.held)
        _lock.held = None
