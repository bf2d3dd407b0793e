"""Users' files: read only if they are regular files, and written atomically."""

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
except ImportError:  # not on Unix: unfinished files are not removed there
    fcntl = None  # type: ignore[assignment]

#: Name that stands for standard output instead of a file
STANDARD_OUTPUT = Path("-")
#: Largest size of a text that can be read, bytes
_MOST_TEXT = 2**26
#: Pattern of the name of a file being written: eight random digits and their checksum
_SAVING = re.compile(r"\.saving-([0-9a-f]{8})([0-9a-f]{8})")


def check_regular(path: Path) -> None:
    """Raise `OSError` unless `path` is a regular file or a link to one, as a pipe may never end."""
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "is a pipe or a device; must be a regular file", str(path))


def read_text(path: Path) -> str:
    """Return the text of a regular UTF-8 file, without a byte order mark.

    Raises `OSError`, including for a file of more than 64 MiB, and `UnicodeDecodeError`.
    """
    check_regular(path)
    with path.open("rb") as file:
        content = file.read(_MOST_TEXT + 1)
    if len(content) > _MOST_TEXT:
        reason = f"is too long for a text; must have at most {_MOST_TEXT >> 20} MiB"
        raise OSError(errno.EFBIG, reason, str(path))
    return content.decode("utf-8-sig")


def digest(value: object, beside: str = "") -> str:
    """Return the SHA-256 of a JSON value and a text, ignoring white space and the order of keys."""
    return hashlib.sha256(f"{json.dumps(value, sort_keys=True)}{beside}".encode()).hexdigest()


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[BytesIO]:
    """Provide memory to write to, whose content replaces the file at `path` at the end.

    For `STANDARD_OUTPUT` the content is printed. Raises `ResultError` if the file cannot be
    written; it is then unchanged.
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
    """Replace the file at `path` atomically; raises `OSError`, including for a link or a pipe."""
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
    """Return whether a file of that name is an unfinished file of `write_whole`."""
    match = _SAVING.fullmatch(name)
    return match is not None and match[2] == _checksum(match[1])


def _checksum(digits: str) -> str:
    """Return the eight digits in the name of an unfinished file that confirm the random ones."""
    return f"{zlib.crc32(f'tweezer {digits}'.encode()):08x}"


def _begun(folder: Path) -> tuple[Path, IO[bytes]]:
    """Create a file to be written, and return its path and the open file.

    The file is locked until it is closed.
    """
    while True:
        digits = secrets.token_hex(4)
        path = folder / f".saving-{digits}{_checksum(digits)}"
        file = path.open("xb")
        if fcntl is None:
            return path, file
        with contextlib.suppress(OSError):  # file systems without locks
            fcntl.flock(file, fcntl.LOCK_EX)
        if os.fstat(file.fileno()).st_nlink:  # not removed before it was locked
            return path, file
        file.close()


def remove_left_over(folder: Path) -> None:
    """Remove unfinished files of killed processes; files of running processes are locked."""
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
    """Delay SIGTERM and SIGHUP until after the block, which takes only moments."""
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
