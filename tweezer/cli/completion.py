"""Shell completion of scenes, of their keys with values, and of other names.

The shell runs it whenever Tab is pressed, so only the completion of keys imports the modules of
scenes.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from tweezer.values.saved import RESULTS, SAVED_TRAP

#: Same as `tweezer.scene.SHIPPED`, the import of which takes half a second
_SHIPPED = Path(__file__).parents[1] / "scenes"


def complete_scene(incomplete: str) -> list[str]:
    """Return the shipped scenes, TOML files and folders whose names begin with `incomplete`."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml",))]


def complete_shown(incomplete: str) -> list[str]:
    """Return the scenes, result files and folders whose names begin with `incomplete`."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml", *RESULTS, SAVED_TRAP))]


def _shipped(incomplete: str) -> list[str]:
    """Return the names of shipped scenes that begin with `incomplete`."""
    return sorted(path.stem for path in _SHIPPED.glob("*.toml") if path.stem.startswith(incomplete))


def _files(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Return the files with these suffixes, then the folders, that complete a path."""
    before = incomplete.rpartition("/")[0] + "/" if "/" in incomplete else ""
    try:
        here = sorted(path for path in Path(before).iterdir() if path.name[0] != ".")
    except OSError:
        return []
    files = [f"{before}{path.name}" for path in here if path.suffix in suffixes]
    folders = [
        f"{before}{path.name}/" for path in here if path.is_dir() and path.suffix not in suffixes
    ]
    return [name for name in (*files, *folders) if name.startswith(incomplete)]


def answer_bash(app: Callable[..., None]) -> None:
    """Print completions of the application for Bash; completions of KEY=VALUE without "KEY=".

    Bash splits KEY=VALUE at the cursor into KEY, = and VALUE, and replaces only VALUE.
    """
    asked, before = os.environ.get("COMP_WORDS", ""), ""
    if parted := re.search(r"(\S+)\s=(?:\s(\S*))?$", asked):
        before = f"{parted[1]}="
        os.environ["COMP_WORDS"] = f"{asked[: parted.start()]}{before}{parted[2] or ''}"
        word = int(os.environ["COMP_CWORD"]) - (1 if parted[2] is None else 2)
        os.environ["COMP_CWORD"] = f"{word}"
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.suppress(SystemExit):
        app(prog_name="tweezer")
    for line in printed.getvalue().splitlines():
        sys.stdout.write(f"{line.removeprefix(before)}\n")


def complete_setting(incomplete: str) -> list[str]:
    """Return completions of KEY=VALUE.

    These are "KEY=" for keys that begin with `incomplete`, and "KEY=VALUE" for each choice if the
    key is complete and has choices.
    """
    from tweezer.scene import settable

    keys = settable()
    key, equals, value = incomplete.partition("=")
    found = [key] if equals else [each for each in keys if each.startswith(key)]
    if len(found) == 1 and (choices := keys.get(found[0])):
        return [f"{found[0]}={each}" for each in choices if each.startswith(value)]
    return [] if equals else [f"{each}=" for each in found]


def complete_key(incomplete: str) -> list[str]:
    """Return the keys of a scene that begin with `incomplete`."""
    from tweezer.scene import settable

    return [each for each in settable() if each.startswith(incomplete)]


def among(names: Iterable[str]) -> Callable[[str], list[str]]:
    """Return a completion function for these names; spaces become hyphens, since shells split at
    spaces.
    """
    offered = [name.replace(" ", "-") for name in names]

    def complete(incomplete: str) -> list[str]:
        """Return the names that begin with `incomplete`."""
        return [name for name in offered if name.startswith(incomplete)]

    return complete
