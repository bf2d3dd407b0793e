"""Files of users: read if they are regular files, written whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import re
import secrets
import signal
import stat
import sys
import threading
import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO, Any

from tweezer.values.errors import ResultError

try:
    import fcntl
except ImportError:  # systems other than Unix: unfinished files remain there
    fcntl = None  # type: ignore[assignment]

#: In place of a file that is written: standard output
STANDARD_OUTPUT = Path("-")
#: Largest size of a text that is read, bytes
_MOST_TEXT = 2**26
#: Name of a file that is being written: eight random digits, and their checksum
_SAVING = re.compile(r"\.saving-([0-9a-f]{8})([0-9a-f]{8})")


def check_regular(path: Path) -> None:
    """Raise OSError unless `path` is a regular file, or a link to one: a pipe may never end."""
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "is a pipe or a device; must be a regular file", str(path))


def read_text(path: Path) -> str:
    """Return the text of a regular file in UTF-8, without a byte order mark.

    Raises OSError, also for a file of more than 64 MiB, and UnicodeDecodeError.
    """
    check_regular(path)
    with path.open("rb") as file:
        content = file.read(_MOST_TEXT + 1)
    if len(content) > _MOST_TEXT:
        reason = f"is too long for a text; must have at most {_MOST_TEXT >> 20} MiB"
        raise OSError(errno.EFBIG, reason, str(path))
    return content.decode("utf-8-sig")


def digest(value: object, beside: str = "") -> str:
    """Return the SHA-256 of a JSON value and a text; spaces and the order of keys do not count."""
    return hashlib.sha256(f"{json.dumps(value, sort_keys=True)}{beside}".encode()).hexdigest()


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BytesIO]:
    """Lend memory to write to; its content replaces the file at `path` at the end.

    With `STANDARD_OUTPUT` the content is printed. Raises `ResultError` if it cannot be written; the
    file at `path` is then unchanged.
    """
    content = BytesIO()
    yield content
    if path == STANDARD_OUTPUT:
        sys.stdout.write(content.getvalue().decode())
        return
    try:
        remove_left_over(path.parent)
        write_whole(path, content)
    except OSError as error:
        raise ResultError(f"{path}: cannot be written: {error.strerror or error}") from None


def write_whole(path: Path, content: BytesIO) -> None:
    """Replace the file at `path` as a whole. Raises OSError, also for a link or a pipe."""
    if path.is_symlink():
        raise OSError(f"is a link, to {path.readlink()}")
    if path.exists():
        check_regular(path)
    with _termination_later():
        unfinished, file = _begun(path.parent)
        try:
            with file:
                file.write(content.getbuffer())
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)


def is_saving(name: str) -> bool:
    """Return whether a file of that name is one that `write_whole` has begun."""
    match = _SAVING.fullmatch(name)
    return match is not None and match[2] == _checksum(match[1])


def _checksum(digits: str) -> str:
    """Return the eight digits in the name of an unfinished file that confirm the random eight."""
    return f"{zlib.crc32(f'tweezer {digits}'.encode()):08x}"


def _begun(folder: Path) -> tuple[Path, IO[bytes]]:
    """Create a file to be written, and return its path and the file, which is locked until it is
    closed.
    """
    while True:
        digits = secrets.token_hex(4)
        path = folder / f".saving-{digits}{_checksum(digits)}"
        file = path.open("xb")
        if fcntl is None:
            return path, file
        with contextlib.suppress(OSError):  # of file systems without locks
            fcntl.flock(file, fcntl.LOCK_EX)
        if os.fstat(file.fileno()).st_nlink:  # not removed before it was locked
            return path, file
        file.close()


def remove_left_over(folder: Path) -> None:
    """Remove unfinished files of processes that were killed; those of others at work are locked."""
    if fcntl is None:
        return
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for each in entries:
            if is_saving(each.name) and each.is_file(follow_symlinks=False):
                with contextlib.suppress(OSError), Path(each.path).open("rb") as file:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    Path(each.path).unlink()


@contextlib.contextmanager
def _termination_later() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end this process only after the block, which takes moments."""
    received: list[int] = []
    before: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        for name in ("SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is signal.SIG_DFL:
                before[number] = signal.signal(number, lambda number, _: received.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in received:
            signal.raise_signal(number)
