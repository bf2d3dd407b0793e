"""Journal of a running sweep, from which it can be resumed."""

from __future__ import annotations

import contextlib
import json
import re
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

from pydantic import ValidationError

from tweezer.scene import Scene
from tweezer.sweeps.quantities import Values, to_text
from tweezer.values.beside import NEW, Part, remove, telling
from tweezer.values.errors import ResultError
from tweezer.values.version import FORMAL

_JOURNAL = "journal.jsonl"
#: Names of the files of a running sweep in its folder
_OWN = re.compile(rf"{re.escape(_JOURNAL)}|{NEW}")
#: Beginning of a journal (a checksum and a mapping), or the part of it that fits on a full disk
_BEGINNING = re.compile(r"[0-9a-f]{1,8}($| ($|\{))")


class Journal:
    """The finished cases of a sweep, in memory and, if it has an output, in the folder OUT.part.

    The first line of the file identifies the sweep; each further line is a case with its values.
    Each line begins with its checksum. Cases after a damaged line are computed again.
    """

    def __init__(self, out: Path | None, identity: Mapping[str, Any], *, resume: bool) -> None:
        """Begin a journal or read an existing one, and open it to append cases.

        `out` is the output of the sweep, None to keep the cases in memory. `identity` contains the
        attributes that identify the sweep. Raises `ResultError` if there is a journal that must not
        be resumed.
        """
        self.done: dict[int, Values] = {}
        self._out = out
        self._file: IO[str] | None = None
        if out is None:
            return
        self._part = part_of(out)
        path = self._part.folder / _JOURNAL
        with telling(out):
            self._part.make()
            begun = path.is_symlink() or path.exists()
            if begun and not resume:
                raise ResultError(f"{out}: is unfinished; resume it or choose another file")
            text = _text(out, path) if begun else ""
        kept = self._read(text, identity)
        with telling(out):
            for left in self._part.files():
                if left != path:  # an unfinished store
                    remove(left)
            self._file = path.open("a" if begun else "x", encoding="utf-8")
            self._file.truncate(kept)
            if not kept:
                self._write(dict(identity))

    def _read(self, text: str, identity: Mapping[str, Any]) -> int:
        """Read the cases of a journal up to a damaged line; return the number of bytes before it.

        Raises `ResultError` if the journal belongs to a sweep with other attributes than
        `identity`.
        """
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
        """Record the values of a finished case, by its index."""
        self.done[case] = values
        if self._out is not None:
            with telling(self._out):
                self._write([case, values])

    def _write(self, found: Any) -> None:
        """Append a line to the file: a checksum, and `found` as JSON."""
        assert self._file is not None
        line = to_text(found) + "\n"
        self._file.write(f"{_checksum(line)} {line}")
        self._file.flush()

    @property
    def new(self) -> Path:
        """Return a temporary name for the store while it is written."""
        return self._part.new()

    def close(self) -> None:
        """Close the file of the journal; after an interruption the sweep can be resumed from it."""
        if self._file is not None:
            with contextlib.suppress(OSError):  # a full disk, which was reported before
                self._file.close()

    def remove(self) -> None:
        """Remove the journal and its folder, once the store of the sweep is complete."""
        if self._out is not None:
            self._part.remove()


def part_of(out: Path) -> Part:
    """Return the folder for the journal of a sweep that writes `out`."""
    return Part(out, "sweep", _OWN)


def _text(out: Path, path: Path) -> str:
    """Return the text of a journal; raises `ResultError` for a link or any other file."""
    if not path.is_symlink() and path.is_file() and path.stat().st_nlink == 1:
        text = path.read_text(encoding="utf-8", errors="replace")
        if not text or _BEGINNING.match(text):
            return text
    raise ResultError(f"{out}: {path} already exists and is not a journal; choose another file")


def _checksum(line: str) -> str:
    """Return the CRC-32 of a line, as eight hexadecimal digits."""
    return f"{zlib.crc32(line.encode()):08x}"


def check_same(out: Path, made: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
    """Raise `ResultError` unless an existing sweep has the attributes of the present one.

    `out` is its file, for the message; `made` are its attributes and `asked` the present ones.
    """
    for key, value in asked.items():
        if key in FORMAL:  # the scene contains the same as numbers
            continue
        if made.get(key) != value and not (key == "scene" and _same_scene(made.get(key), value)):
            differs = {
                "of": f"is a sweep of {made.get(key)}, not of {value}",
                "over": "sweeps over other keys or values",
                "scene": "is a sweep of another scene",
            }
            what = f"is made with {key.replace('_', ' ')} {made.get(key)}, not {value}"
            raise ResultError(f"{out}: {differs.get(key, what)}; choose another file")


def _same_scene(made: object, asked: str) -> bool:
    """Return whether two scenes, as JSON, are equal; False if `made` is not a scene."""
    try:
        return isinstance(made, str) and (
            Scene.model_validate_json(made) == Scene.model_validate_json(asked)
        )
    except ValidationError:
        return False
