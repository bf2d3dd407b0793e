"""The journal of a running sweep, and the lock on its output."""

from __future__ import annotations

import contextlib
import json
import shutil
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

from filelock import FileLock, Timeout
from pydantic import ValidationError

from tweezer.errors import ResultError
from tweezer.scene import Scene
from tweezer.sweeps.quantities import Values, to_text
from tweezer.version import FORMAL

#: Names in the folder of a running sweep
_JOURNAL, _NEW = "journal.jsonl", "new"


class Journal:
    """What of a sweep is done: in memory, and in OUT.part if it has an output.

    The first line of the file says what is computed; each other line is a case. Before each stands
    its checksum: from a damaged line on, cases are computed again.
    """

    def __init__(self, out: Path | None, identity: Mapping[str, Any], *, resume: bool) -> None:
        self.done: dict[int, Values] = {}
        self._out = out
        self._file: IO[str] | None = None
        if out is None:
            return
        self._part = out.with_name(out.name + ".part")
        path = self._part / _JOURNAL
        text = ""
        with telling(out):
            self._check_part()
            if path.exists():
                if not resume:
                    raise ResultError(f"{out}: is begun; resume it, or name another file")
                text = path.read_text(encoding="utf-8", errors="replace")
        kept = self._read(text, identity)
        with telling(out):
            self._part.mkdir(exist_ok=True)
            self._file = path.open("a", encoding="utf-8")
            self._file.truncate(kept)
            if not kept:
                self._write(dict(identity))

    def _check_part(self) -> None:
        """Raises `ResultError` for a folder or a link in the way that is of no sweep."""
        part = self._part
        names = {path.name for path in part.iterdir()} if part.is_dir() else set()
        if part.is_symlink() or (part.exists() and not part.is_dir()) or names - {_JOURNAL, _NEW}:
            raise ResultError(
                f"{self._out}: {part} is in the way, and of no sweep; name another file"
            )

    def _read(self, text: str, identity: Mapping[str, Any]) -> int:
        """Take the whole lines of a journal; returns how many bytes they have."""
        assert self._out is not None
        kept = 0
        for number, line in enumerate(text.splitlines(keepends=True)):
            checksum, _, written = line.partition(" ")
            if not line.endswith("\n") or checksum != _checksum(written):
                break
            found = json.loads(written)
            if number == 0:
                check_same(self._out, found, identity)
            else:
                case, values = found
                self.done[case] = values
            kept += len(line.encode())
        return kept

    def take(self, case: int, values: Values) -> None:
        """Record a case."""
        self.done[case] = values
        if self._out is not None:
            with telling(self._out):
                self._write([case, values])

    def _write(self, found: Any) -> None:
        assert self._file is not None
        line = to_text(found) + "\n"
        self._file.write(f"{_checksum(line)} {line}")
        self._file.flush()

    @property
    def new(self) -> Path:
        """Where the store is written before it takes its name."""
        return self._part / _NEW

    def close(self, *, complete: bool) -> None:
        """Close the file; of a complete sweep it is no longer needed."""
        if self._file is None:
            return
        with contextlib.suppress(OSError):  # of a full disk, which is told already
            self._file.close()
        if complete:
            remove_part(self._part)


def _checksum(line: str) -> str:
    return f"{zlib.crc32(line.encode()):08x}"


def remove_part(part: Path) -> None:
    """Remove the folder of a running sweep; a failure does no harm."""
    with contextlib.suppress(OSError):
        shutil.rmtree(part / _NEW, ignore_errors=True)
        (part / _JOURNAL).unlink(missing_ok=True)
        part.rmdir()


def check_same(out: Path, made: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
    """Raises `ResultError` unless what was made is what is asked."""
    for key, value in asked.items():
        if key in FORMAL:  # the scene has the same in numbers
            continue
        if made.get(key) != value and not (key == "scene" and _same_scene(made.get(key), value)):
            differs = {
                "of": f"is a sweep of {made.get(key)}, not of {value}",
                "over": "sweeps over other keys or values",
                "scene": "is a sweep of another scene",
            }
            what = f"is made with {key.replace('_', ' ')} {made.get(key)}, not {value}"
            raise ResultError(f"{out}: {differs.get(key, what)}; name another file")


def _same_scene(made: object, asked: str) -> bool:
    try:
        return isinstance(made, str) and (
            Scene.model_validate_json(made) == Scene.model_validate_json(asked)
        )
    except ValidationError:
        return False


@contextlib.contextmanager
def at_work(out: Path) -> Iterator[None]:
    """Hold OUT.lock, so that no other process writes there. Raises `ResultError` if one does."""
    if not out.parent.is_dir():
        raise ResultError(f"{out}: no such folder: {out.parent}")
    if out.is_symlink():
        raise ResultError(f"{out}: is a link; name what it leads to: {out.readlink()}")
    path = out.with_name(out.name + ".lock")
    with telling(out):
        lock = FileLock(path)
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise ResultError(f"{out}: another process is at work on it") from None
    try:
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()  # while it is held, so that a waiting process notices
        lock.release()


@contextlib.contextmanager
def telling(out: Path) -> Iterator[None]:
    """Turn errors of the file system into a `ResultError`."""
    try:
        yield
    except OSError as error:
        raise ResultError(
            f"{out}: cannot be written: {error.strerror or error}; what was written before is "
            "kept, and can be resumed"
        ) from None
