"""Compiling shared by two processes: neither compiles what the other is compiling.

A process that compiles a function for Python locks a file in a shared folder. The other process
waits for the lock and loads the function from the cache. A process has one lock at a time and
requests none while it compiles, so no process waits for ever. Its end releases its lock.
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

#: Whether this machine has such locks, and functions are compiled by what asks for them
POSSIBLE = fcntl is not None and not PLAIN


class _Lock:
    """The lock that this process holds, if any, and the folder of all."""

    folder: Path | None = None
    held: int | None = None


_lock = _Lock()


def share(folder: Path | None) -> None:
    """Share compiling with the process that is given the same folder; None: no longer."""
    release()
    _lock.folder = folder


def claim(name: str, dispatcher: Any) -> bool:
    """Wait until no other process compiles the variant of that name; return whether compiling is
    shared.

    dispatcher: its function. The wait counts as compiling.
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
    except OSError:  # the folder is gone with the other process, or has no locks
        release()
        return False
    return True


def release() -> None:
    """Release the lock, so that the other process can load the function that this one compiled
    last.
    """
    if _lock.held is not None:
        os.close(_lock.held)
        _lock.held = None
