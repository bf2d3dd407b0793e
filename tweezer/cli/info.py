"""The commands `tweezer info` and `tweezer cache`: system information and cached files."""

from __future__ import annotations

import getpass
import json
import os
import platform
import re
import sys
import time
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer

from tweezer.cli.app import app
from tweezer.cli.console import ERR, FAILED, OUT, complain
from tweezer.cli.tables import table_of
from tweezer.values.errors import ResultError, TweezerError

#: Packages whose versions are useful in a bug report
_PACKAGES = (
    "numpy", "scipy", "numba", "llvmlite", "xarray", "zarr", "h5netcdf", "pydantic", "pint",
    "matplotlib", "typer", "rich",
)  # fmt: skip
#: Optional dependencies for the development of tweezer itself
_OF_DEVELOPERS = ("bench", "dev", "docs", "fatcuda", "test")
#: Age above which an unfinished file is considered abandoned, s
_LEFT_OVER = 86400.0


class _Cache(NamedTuple):
    """Cached files of one kind."""

    name: str
    folders: list[Path]
    """folders that contain the files"""
    files: list[Path]

    @property
    def size(self) -> int:
        """Total size of the files that exist, bytes."""
        return sum(_size(each) for each in self.files)


@app.command()
def info(
    json_: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Show versions, machine and caches.

    Include the output in bug reports. It does not contain the user's name: ~ is the home folder.
    """
    facts = _facts()
    if json_:
        OUT.print(json.dumps(facts, indent=2), highlight=False, soft_wrap=True)
        return
    table = table_of("tweezer", str(facts.pop("tweezer")))
    for name, value in facts.items():
        table.add_row(name, _in_words(value))
    OUT.print(table)


@app.command()
def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Delete the cached files.")] = False,
    yes: Annotated[
        bool,
        typer.Option("--yes", help="Do not ask for confirmation; required without a terminal."),
    ] = False,
) -> None:
    """List cached files, or delete them.

    The files are compiled functions and force maps, which are created again when needed. Deleting
    them with --clear does not affect other running commands. Without a terminal, --clear requires
    --yes.
    """
    found = _caches()
    if not clear:
        table = table_of("kept", "files", "size", "where")
        for each in found:
            folders = [_without_user(folder) for folder in each.folders]
            table.add_row(each.name, f"{len(each.files)}", _megabytes(each.size), _common(folders))
        OUT.print(table)
        return
    files = [path for each in found for path in each.files]
    size = sum(each.size for each in found)
    if not yes:
        if not sys.stdin.isatty():
            raise TweezerError("--clear: requires --yes without a terminal")
        typer.confirm(f"Remove {len(files)} files, {_megabytes(size)}?", abort=True)
    removed = freed = 0
    refused: dict[str, int] = {}
    for path in files:
        one = _size(path)
        try:
            path.unlink()
        except FileNotFoundError:  # deleted by another process
            continue
        except OSError as error:
            reason = error.strerror or str(error)
            refused[reason] = refused.get(reason, 0) + 1
            continue
        removed, freed = removed + 1, freed + one
    OUT.print(f"removed {removed} files, {_megabytes(freed)}", highlight=False)
    for reason, number in refused.items():
        complain(f"{number} files cannot be removed: {reason}")
    if refused:
        raise typer.Exit(FAILED)


def _caches() -> list[_Cache]:
    """Return the cached files by kind, except locks and files that other processes are writing."""
    with ERR.status("looking"):
        from tweezer.compiled.folders import UNFINISHED, is_own, kept
        from tweezer.optics.table import tables_folder

    compiled = [each for each in kept() if _finished(each, UNFINISHED)]
    tables = tables_folder()
    table = re.compile(r"[0-9a-f]{64}\.table")
    saving = re.compile(r"\.saving-[0-9a-f]{16}")
    files = sorted(tables.iterdir()) if is_own(tables) else []
    maps = [
        each
        for each in files
        if each.is_file()
        and not each.is_symlink()
        and (
            table.fullmatch(each.name) or (saving.fullmatch(each.name) and _finished(each, saving))
        )
    ]
    return [
        _Cache(
            "compiled functions", list(dict.fromkeys(each.parent for each in compiled)), compiled
        ),
        _Cache("maps of forces", [tables] if maps else [], maps),
    ]


def _finished(path: Path, unfinished: re.Pattern[str]) -> bool:
    """Return whether no process can still be writing a file.

    `unfinished` is the pattern of the names of files being written.
    """
    if not unfinished.fullmatch(path.name):
        return True
    try:
        return time.time() - path.stat().st_mtime > _LEFT_OVER
    except OSError:
        return False


def _size(path: Path) -> int:
    """Return the size of a file, bytes; 0 if it cannot be read."""
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _facts() -> dict[str, Any]:
    """Return the facts for a bug report by name, in the order in which they are shown."""
    from tweezer.values.version import __version__

    caches = {
        each.name: {
            "files": len(each.files),
            "bytes": each.size,
            "in": [_without_user(folder) for folder in each.folders],
        }
        for each in _caches()
    }
    return {
        "tweezer": __version__,
        "installed in": _without_user(Path(__file__).parents[1]),
        "Python": f"{platform.python_version()}, {platform.python_implementation()}",
        "packages": {name: _version(name) or "missing" for name in _PACKAGES},
        "extras": _extras(),
        "system": f"{platform.platform()}, {platform.machine()}",
        "cores": {"of the machine": os.cpu_count(), "for tweezer": _cores()},
        "memory, GB": _memory(),
        "settings": {
            name: _without_user(Path(value))
            for name, value in sorted(os.environ.items())
            if name.startswith("NUMBA_") or name in ("OMP_NUM_THREADS", "XDG_CACHE_HOME")
        },
        "pages open in": _browser() or "no browser with a window found",
        "films": _films(),
        **caches,
    }


def _version(package: str) -> str | None:
    """Return the installed version of a package; None if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _extras() -> dict[str, bool]:
    """Return, for each extra of tweezer, whether all of its packages are installed."""
    try:
        of_tweezer = metadata.metadata("tweezer")
    except metadata.PackageNotFoundError:  # tweezer is used from a folder without installation
        return {}
    needed: dict[str, list[str]] = {}
    for line in of_tweezer.get_all("Requires-Dist") or ():
        extra = re.search(r"extra == ['\"](.*?)['\"]", line)
        package = re.match(r"[\w.-]+", line)
        if extra and package and package[0] != "tweezer":
            needed.setdefault(extra[1], []).append(package[0])
    return {
        extra: all(map(_version, packages))
        for extra, packages in sorted(needed.items())
        if extra not in _OF_DEVELOPERS
    }


def _cores() -> int | None:
    """Return the number of cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # exists only on Linux
        return os.cpu_count()


def _memory() -> float | None:
    """Return the memory of the machine, GB; None if the system does not report it."""
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (AttributeError, ValueError, OSError):
        return None


def _browser() -> str | None:
    """Return the name of the browser that opens pages; None without a browser."""
    import webbrowser

    try:
        found = webbrowser.get()
    except webbrowser.Error:
        return None
    return Path(getattr(found, "name", type(found).__name__)).name


def _films() -> str:
    """Return "yes" if `tweezer view --movie` can work, otherwise what is missing."""
    from tweezer.viewing.movie import programs

    try:
        programs()
    except ResultError as error:
        return str(error)
    return "yes"


def _without_user(path: Path) -> str:
    """Return a path without the names of user and home folder, so that reports can be public."""
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):  # the user's number has no name
        user = ""
    home = Path.home()
    if path.is_relative_to(home) and home != Path(home.anchor):
        return str(Path("~", path.relative_to(home)))
    parts = ["USER" if part == user and user != "root" else part for part in path.parts]
    return str(Path(*parts)) if parts else str(path)


def _megabytes(size: int) -> str:
    """Return a size in bytes as text in MB."""
    return f"{size / 1e6:.2g} MB" if size else "0 MB"


def _common(folders: list[str]) -> str:
    """Return the only folder, or the number of folders and the folder that contains them all."""
    if not folders:
        return "none yet"
    if len(folders) == 1:
        return folders[0]
    try:
        return f"{len(folders)} folders in {os.path.commonpath(folders)}"
    except ValueError:  # on different drives
        return ", ".join(folders)


def _in_words(value: Any) -> str:
    """Return a value of `_facts` as text."""
    if value is None:
        return "not known"
    if isinstance(value, bool):
        return "found" if value else "not found"
    if not isinstance(value, dict):
        return str(value)
    if "bytes" in value:
        return f"{value['files']} files, {_megabytes(value['bytes'])}; {_common(value['in'])}"
    if value and all(isinstance(each, bool) for each in value.values()):
        return ", ".join(f"{name}: {'yes' if there else 'no'}" for name, there in value.items())
    return ", ".join(f"{name} {each}" for name, each in value.items()) or "none"
