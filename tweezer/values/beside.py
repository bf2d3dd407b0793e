"""Names beside an output: OUT.lock, locked by the running process, and OUT.part with checkpoints.

A file, folder or link of such a name that tweezer did not create is refused and left unchanged.
"""

from __future__ import annotations

import contextlib
import re
import secrets
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from tweezer.values.errors import ResultError

#: Name of a store that is being written, within OUT.part
NEW = r"new-[0-9a-f]{16}"


@contextlib.contextmanager
def telling(out: Path | None) -> Iterator[None]:
    """Convert file system errors in a block to a `ResultError` about the output `out`."""
    try:
        yield
    except OSError as error:
        raise ResultError(
            f"{out}: cannot be written: {error.strerror or error}; the results written "
            "before remain and can be resumed"
        ) from None


@contextlib.contextmanager
def held(out: Path) -> Iterator[None]:
    """Lock OUT.lock, so that no other process writes the same output.

    Raises `ResultError` if another process has locked it, and for an existing file with content.
    """
    if not out.parent.is_dir():
        raise ResultError(f"{out}: no such folder: {out.parent}")
    if out.is_symlink():
        raise ResultError(f"{out}: is a link; give its target instead: {out.readlink()}")
    path = out.with_name(out.name + ".lock")
    with telling(out):
        if path.is_symlink() or (path.exists() and not (path.is_file() and not _size(path))):
            raise ResultError(
                f"{out}: {path} already exists and is not a lock of tweezer; choose another file"
            )
        lock = FileLock(path)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise ResultError(f"{out}: another process is writing it") from None
    try:
        yield
    finally:
        try:
            with contextlib.suppress(OSError):
                path.unlink()  # while it is locked, so that a waiting process notices
        finally:
            lock.release()


def _size(path: Path) -> int:
    """Return the size of a file, bytes; 0 if another process has just removed it."""
    try:
        return path.stat().st_size
    except FileNotFoundError:  # removed by the process that had locked it
        return 0


@dataclass(frozen=True)
class Part:
    """The folder OUT.part beside an output, from which an interrupted sweep or ensemble continues.

    A marker file in it names the kind, so that folders of other origin are recognised and left
    unchanged.
    """

    out: Path
    """the output"""
    of: str
    """"sweep" or "ensemble" """
    own: re.Pattern[str]
    """pattern of the names of files that tweezer creates in the folder"""

    @property
    def folder(self) -> Path:
        """Path of the folder."""
        return self.out.with_name(self.out.name + ".part")

    @property
    def _marker(self) -> Path:
        """Path of the marker file."""
        return self.folder / f"of-{'an' if self.of[0] in 'aeiou' else 'a'}-{self.of}"

    @property
    def _sentence(self) -> str:
        """Beginning of the marker's content."""
        return f"what the {self.of} "

    def make(self) -> None:
        """Create the folder unless it exists.

        Raises `ResultError` for a link of this name, and for a folder with files but no marker.
        """
        folder = self.folder
        marked = self._marked()
        foreign = folder.exists() and not marked and (not folder.is_dir() or any(folder.iterdir()))
        if folder.is_symlink() or foreign:
            raise ResultError(
                f"{self.out}: {folder} already exists and belongs to no {self.of}; choose another "
                "file"
            )
        folder.mkdir(exist_ok=True)
        if not marked:
            with self._marker.open("x", encoding="utf-8") as file:
                file.write(f"{self._sentence}{self.out} goes on from\n")

    def _marked(self) -> bool:
        """Return whether the folder is no link and has its marker, which a full disk may empty."""
        if self.folder.is_symlink() or self._marker.is_symlink() or not self._marker.is_file():
            return False
        with self._marker.open("rb") as file:
            said = file.read(len(self._sentence))
        return said in (b"", self._sentence.encode())

    def files(self) -> list[Path]:
        """Return the files that tweezer created in the folder; none if it has no marker."""
        if not self._marked():
            return []
        return [each for each in sorted(self.folder.iterdir()) if self.own.fullmatch(each.name)]

    def remove(self) -> None:
        """Remove the files that tweezer created, and the folder if it is then empty.

        Errors are ignored.
        """
        with contextlib.suppress(OSError):
            for path in self.files():
                remove(path)
        self.remove_if_empty()

    def remove_if_empty(self) -> None:
        """Remove the folder if it contains only its marker."""
        with contextlib.suppress(OSError):
            if self._marked() and not self.files():
                self._marker.unlink()
                self.folder.rmdir()

    def new(self) -> Path:
        """Return an unused name for a store, which is renamed to `out` once it is written."""
        return self.folder / f"new-{secrets.token_hex(8)}"


def remove(path: Path) -> None:
    """Remove a file, a link, or a folder with its content."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
