"""A fault at the n-th write of a sweep or an ensemble, for every n: nothing is lost or left over.

A write is any call that changes a folder: a file that is made, written to, renamed or removed, a
folder that is made or removed. `tests/values/test_beside.py` does a part of it, `make stress` all.
"""

from __future__ import annotations

import _thread
import contextlib
import errno
import io
import os
import signal
import tempfile
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

import tweezer
from tweezer.sweeps import quantities

#: What a write ends with
ERRORS: dict[str, Callable[[], BaseException]] = {
    "full disk": lambda: OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
    "failing disk": lambda: OSError(errno.EIO, os.strerror(errno.EIO)),
    "Ctrl-C": KeyboardInterrupt,
}
_SCENE = tweezer.load_scene("silica-1um")
_THERMAL = _SCENE.replace(
    forces={"brownian": True, "optical": False, "gravity": False, "buoyancy": False},
    simulation={"model": "overdamped", "duration": 1e-3, "samples": 5},
)
_OVER = {"bead.diameter": [0.5e-6, 0.75e-6, 1e-6]}


class Writes:
    """Writes within a folder, counted; the one of the number `at` fails, half done."""

    def __init__(self, folder: Path, at: int, error: str) -> None:
        self.folder, self.at, self.error, self.count = str(folder), at, error, 0
        self._lock = threading.Lock()

    def _hit(self) -> None:
        with self._lock:
            self.count += 1
            hit = self.count == self.at
        if not hit:
            return
        error = ERRORS[self.error]()
        if isinstance(error, KeyboardInterrupt) and (
            threading.current_thread() is not threading.main_thread()
        ):
            _thread.interrupt_main()  # where Ctrl-C comes
            return
        raise error

    def _within(self, path: Any) -> bool:
        return isinstance(path, str | os.PathLike) and os.fspath(path).startswith(self.folder)

    @contextlib.contextmanager
    def counted(self) -> Iterator[Writes]:
        """A context in which writes are counted."""
        writes, sound_open, sound_low = self, io.open, os.open

        class Written:
            """A file opened for writing."""

            def __init__(self, file: Any) -> None:
                self._file = file

            def write(self, content: Any) -> int:
                try:
                    writes._hit()
                except BaseException:
                    self._file.write(content[: len(content) // 2])
                    raise
                return self._file.write(content)

            def __enter__(self) -> Any:
                return self

            def __exit__(self, *_: object) -> None:
                self._file.close()

            def __getattr__(self, name: str) -> Any:
                return getattr(self._file, name)

        def opened(path: Any, mode: str = "r", *arguments: Any, **options: Any) -> Any:
            if not set(mode) & set("wxa+") or not self._within(path):
                return sound_open(path, mode, *arguments, **options)
            self._hit()
            return Written(sound_open(path, mode, *arguments, **options))

        def opened_low(path: Any, flags: int, *arguments: Any, **options: Any) -> int:
            if flags & os.O_CREAT and self._within(path):
                self._hit()
            return sound_low(path, flags, *arguments, **options)

        def counting(sound: Callable[..., Any]) -> Callable[..., Any]:
            def changed(path: Any, *arguments: Any, **options: Any) -> Any:
                if self._within(path):
                    self._hit()
                return sound(path, *arguments, **options)

            return changed

        # a process in the background of a shell ignores Ctrl-C
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        with contextlib.ExitStack() as stack:
            stack.callback(signal.signal, signal.SIGINT, before)
            patch = stack.enter_context(pytest.MonkeyPatch.context())
            patch.setattr(io, "open", opened)
            patch.setattr(os, "open", opened_low)
            for name in ("replace", "rename", "unlink", "remove", "mkdir", "rmdir"):
                patch.setattr(os, name, counting(getattr(os, name)))
            yield self


def _sweep(out: Path, computed: list[int], *, resume: bool) -> str:
    """Return a sweep whose cases cost nothing; `computed` counts them."""

    def compute(asked: quantities.Asked, settings: Any) -> quantities.Values:
        computed.append(1)
        number = float(settings["bead.diameter"])
        return {"outcome": "lost", "force_error": number, "caveat": ""}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(quantities.Asked, "compute", compute)
        found = tweezer.sweep(_SCENE, _OVER, out=out, workers=1, resume=resume)
    return str(found.attrs["status"])


def _ensemble(out: Path, _: list[int], *, resume: bool) -> str:
    found = tweezer.ensemble(
        _THERMAL, 70, out=out, statistics=out.suffix == ".nc", workers=1, resume=resume
    )
    return str(found.attrs["status"])


#: By the name of the output
KINDS: dict[str, Callable[..., str]] = {
    "sweep.zarr": _sweep, "ensemble.zarr": _ensemble, "ensemble.nc": _ensemble,
}  # fmt: skip


def content(folder: Path) -> dict[str, bytes]:
    """Return the files in a folder by their names."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*") if path.is_file() and not path.is_symlink()
    }  # fmt: skip


def at_each_write(
    name: str, errors: Iterable[str], numbers: Callable[[int], Iterable[int]]
) -> Counter[str]:
    """Let a write fail and go on, for each number of a write that `numbers` names of all.

    Afterwards the bytes are those without a fault, no file is left over, a file of the user's is as
    it was, and no case that was recorded is computed again. Raises AssertionError.
    """
    make, ended = KINDS[name], Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        whole.mkdir()
        computed: list[int] = []
        with Writes(whole, 0, "full disk").counted() as writes:
            assert make(whole / name, computed, resume=False) == "complete"
        expected, cases = content(whole), len(computed)
        for error in errors:
            for number in numbers(writes.count):
                place = Path(folder) / f"{error} {number}"
                place.mkdir()
                (place / "thesis.tex").write_text("precious")
                fault, computed = f"{name}: {error} at write {number}", []
                try:
                    with Writes(place, number, error).counted():
                        status = make(place / name, computed, resume=False)
                except tweezer.ResultError as error_told:
                    if "\n" in str(error_told):
                        raise AssertionError(f"{fault}: several lines") from error_told
                    status = "refused"
                except KeyboardInterrupt:
                    status = "interrupted"
                reached = len(computed)
                assert make(place / name, computed, resume=True) == "complete", fault
                there = content(place)
                assert there.pop("thesis.tex") == b"precious", fault
                assert there == expected, f"{fault}: other bytes, or files left over"
                # the case whose line was torn is computed twice
                assert reached + len(computed[reached:]) <= cases + 1, f"{fault}: work is lost"
                ended[f"{error}: {status}, then the same bytes"] += 1
    return ended
