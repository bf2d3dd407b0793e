"""Output of commands: terminal, warnings, progress, and checks of the files to be written.

A command begins with `begin`, which takes its options --details and --quiet. What it prints as a
result has the signs µ, ± and · if the terminal has them (`say`, `tweezer.cli.tables`).
"""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import logging
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.console import Console

from tweezer.values.errors import ResultError
from tweezer.values.files import STANDARD_OUTPUT, check_regular
from tweezer.values.saved import check_ending
from tweezer.values.signs import for_stream

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.live import Live

    from tweezer.compiled import Compilation


@dataclasses.dataclass
class _Asked:
    """Choice of details by the user, and the notice that a command is loading."""

    details: bool | None = None
    """whether everything is printed; None for a command without the option"""
    notice: Live | None = None
    """notice that the command is loading, on a terminal"""


_asked = _Asked()
#: Longest warning that is printed whole without --details, in characters, and how others end
_LONG, MORE = 100, "--details: more"


class _Console(Console):
    """A console that ends the notice before it prints."""

    def print(self, *things: Any, **how: Any) -> None:
        """Print things; see `rich.console.Console.print`."""
        end_notice()
        super().print(*things, **how)


def begin(*, details: bool | None = None, quiet: bool = False) -> None:
    """Begin the output of a command, with its options; show on a terminal that it is loading.

    details: None for a command without the option --details.
    """
    _asked.details = details
    OUT.quiet = ERR.quiet = quiet
    logging.getLogger("tweezer").setLevel(logging.ERROR if quiet else logging.NOTSET)
    if ERR.is_terminal and not quiet:
        from rich.live import Live
        from rich.spinner import Spinner

        end_notice()
        _asked.notice = Live(
            Spinner("dots", "loading"), console=ERR, transient=True,
            redirect_stdout=False, redirect_stderr=False,
        )  # fmt: skip
        _asked.notice.start(refresh=True)


def end_notice() -> None:
    """Remove the notice that a command is loading, if it is shown."""
    notice, _asked.notice = _asked.notice, None
    if notice:
        notice.stop()


def detailed() -> bool:
    """Return whether details are printed: with --details, and by commands without that option."""
    return _asked.details is not False


def say(text: str) -> None:
    """Print a line of a result with the signs that the terminal has."""
    OUT.print(for_stream(text, OUT.file), highlight=False, soft_wrap=True)


def _console(*, stderr: bool) -> Console:
    """Return a console without markup, because names may contain brackets or colons."""
    console = _Console(stderr=stderr, markup=False, emoji=False)
    if console.width < 1:  # COLUMNS=0
        console.width = 80
    return console


OUT, ERR = _console(stderr=False), _console(stderr=True)
FIGURE_FORMATS = ("pdf", "png", "svg")
#: Suffix of an option for a Zarr store, a folder of many files
STORES = ("zarr",)
BAD_INPUT, FAILED, INTERRUPTED = 2, 1, 130


#: Files and folders that a command is about to write, with their earlier states
_awaited: dict[Path, dict[Path, int]] = {}


def _state(path: Path) -> dict[Path, int]:
    """Return the time of the last change of a file, or of each file in a folder, ns."""
    files = path.iterdir() if path.is_dir() else [path]
    return {each: each.stat().st_mtime_ns for each in files if each.is_file()}


def awaited(path: Path) -> Path:
    """Register `path` so that the interrupt message reports whether it was written; return it."""
    _awaited[path] = _state(path)
    return path


def writable(path: Path, formats: tuple[str, ...]) -> Path:
    """Return `path`, or raise `ResultError` before any computation if it cannot be written.

    `formats` are the allowed suffixes. For `STANDARD_OUTPUT` all other output is suppressed.
    """
    check_ending(path, formats)
    if path == STANDARD_OUTPUT:
        OUT.quiet = True
        return path
    if not path.parent.is_dir():
        raise ResultError(f"{path}: no such folder: {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise ResultError(f"{path}: cannot be written: no permission to write in {path.parent}")
    try:
        if path.is_symlink():
            raise ResultError(f"{path}: is a link; give its target instead: {path.readlink()}")
        if path.is_dir() and formats != STORES:
            raise ResultError(f"{path}: is a folder")
        if path.exists() and not path.is_dir():
            check_regular(path)
    except OSError as error:
        raise ResultError(f"{path}: cannot be written: {error.strerror}") from None
    return awaited(path)


def writable_result(
    path: Path,
    formats: tuple[str, ...],
    *,
    overwrite: bool,
    obstacle: Callable[[Path], str] = lambda _: "already exists",
    option: str = "--out",
) -> Path:
    """Return the path of a result, report or scene; refuse to replace a file that must be kept.

    Parameters
    ----------
    path : Path
        File to write.
    formats : tuple of str
        Allowed endings.
    overwrite : bool
        Whether an existing file may be replaced.
    obstacle : callable, optional
        Function that returns the reason why an existing file must not be replaced without
        --overwrite, or "" if it may be.
    option : str, optional
        Option with which the user can choose another file.
    """
    path = writable(path, formats)
    if path != STANDARD_OUTPUT and path.exists() and not overwrite and (reason := obstacle(path)):
        raise ResultError(f"{path}: {reason}; choose another {option} or pass --overwrite")
    return path


def writable_figure(path: Path | None, *, overwrite: bool = False) -> Path | None:
    """Return the path of a figure; refuse to replace a file that tweezer did not draw."""
    return path and writable_result(
        path, FIGURE_FORMATS, overwrite=overwrite, obstacle=_no_figure, option="--plot"
    )


#: Text by which tweezer's own figures are recognised, by suffix
_SIGNS = {
    ".png": b"Software\0tweezer ", ".svg": b"<dc:title>tweezer ", ".pdf": b"/Creator (tweezer ",
}  # fmt: skip


def _no_figure(path: Path) -> str:
    """Return why a figure must not replace the file at `path`; "" if that is tweezer's figure."""
    with contextlib.suppress(OSError):
        check_regular(path)
        if _SIGNS[path.suffix.lower()] in path.read_bytes():
            return ""
    return "already exists and is not a figure of tweezer"


@contextlib.contextmanager
def importing() -> Iterator[None]:
    """Return a context for imports, which disables garbage collection to save time.

    Later collections ignore the objects created in it.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


@contextlib.contextmanager
def telling_interrupt() -> Iterator[None]:
    """Return a context for a command, which turns an interrupt into a message on written files."""
    _awaited.clear()
    _asked.details, OUT.quiet, ERR.quiet = None, False, False
    try:
        yield
    except KeyboardInterrupt:
        tell_interrupted()
        raise typer.Exit(INTERRUPTED) from None
    finally:
        end_notice()


def tell_interrupted() -> None:
    """Print in one line which files an interrupted command wrote, and whether compiled code is
    kept.
    """
    written = [str(path) for path, before in _awaited.items() if _state(path) != before]
    told = f"wrote {' and '.join(written)}" if written else "nothing was written"
    compiling = sys.modules.get("tweezer.compiled.compiling")  # None before a command imports it
    if compiling and compiling.kept():
        told += "; what was compiled so far is kept"
    complain(f"interrupted: {told}")


@contextlib.contextmanager
def showing_progress(
    description: str, total: float = 1.0, afterwards: str = ""
) -> Iterator[Callable[[float], None]]:
    """Return a context with a progress bar and notices of compilation; it yields a callback.

    The callback is given the progress reached, from 0 to `total`. Before it is called, the bar
    moves without a percentage. `afterwards` names the work that remains when `total` is reached.
    """
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn("{task.percentage:>3.0f} %"),
        TimeRemainingColumn(),
    )
    disabled = not ERR.is_terminal or ERR.quiet
    end_notice()
    with Progress(*columns, console=ERR, transient=True, disable=disabled) as progress:
        task = progress.add_task(description, total=None)

        from tweezer.compiled import compilation

        doing = description

        def say(compiling: Compilation) -> None:
            """Show a notice that functions are being compiled."""
            spent = f"compiling, once: {compiling.seconds:.0f} s so far"
            progress.update(task, description=f"{doing} ({spent})", refresh=True)

        def reach(reached: float) -> None:
            """Update the progress bar."""
            nonlocal doing
            if afterwards and reached >= total:
                doing = f"{description}: {afterwards}"
            known = total if reached > 0 else None
            progress.update(task, description=doing, completed=reached, total=known)

        with compilation(say):
            yield reach


def tell_written(*paths: Path | None) -> None:
    """Print the paths of the files that were written; None is skipped."""
    written = " and ".join(str(path) for path in paths if path)
    if written:
        OUT.print(f"wrote {written}", highlight=False, soft_wrap=True)


def write_result(result: Mapping[str, Any], path: Path) -> None:
    """Write a result as JSON with a digest."""
    end_notice()
    from tweezer.results.io import write_result  # here, because it imports xarray

    write_result(result, path)


def write_figure(figure: Figure, path: Path) -> None:
    """Write a figure atomically, so that an interrupt leaves no partial file."""
    from tweezer.plots.style import save
    from tweezer.values.files import replacing

    with replacing(path) as whole:
        save(figure, whole, path.suffix[1:].lower())


def complain(text: str) -> None:
    """Print an error in red, with --quiet too."""
    ERR.quiet = False
    ERR.print(text, style="red", highlight=False, soft_wrap=True)


def show_warning(message: Warning | str, *_: object) -> None:
    """Print a warning in yellow, in one line unless --details asks for all of it."""
    text = str(message) if detailed() else _in_one_line(str(message))
    told = for_stream(f"warning: {text}", ERR.file)
    ERR.print(told, style="yellow", highlight=False, soft_wrap=True)


def _in_one_line(text: str) -> str:
    """Return as many clauses of a warning as fit in a line, and where the others are."""
    first, *others = text.split("; ")
    while others and len(first) + len(others[0]) < _LONG:
        first += f"; {others.pop(0)}"
    return f"{first} ({MORE})" if others else first
