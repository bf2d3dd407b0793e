"""Completions by the shell: scenes, keys of scenes with their values, and other names.

A shell asks at each press of a key, so only completions of keys import what scenes need.
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

#: `tweezer.scene.SHIPPED`, which takes half a second to load
_SHIPPED = Path(__file__).parents[1] / "scenes"


def complete_scene(incomplete: str) -> list[str]:
    """Return the shipped scenes, TOML files and folders that begin with a text."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml",))]


def complete_shown(incomplete: str) -> list[str]:
    """Return the scenes, files of results and folders that begin with a text."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml", *RESULTS, SAVED_TRAP))]


def _shipped(incomplete: str) -> list[str]:
    """Return the names of shipped scenes that begin with a text."""
    return sorted(path.stem for path in _SHIPPED.glob("*.toml") if path.stem.startswith(incomplete))


def _files(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Return files with these endings, then folders, in the folder that the text names."""
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
    """Print the completions of the application for Bash; those of KEY=VALUE without "KEY=".

    Bash splits the word at the cursor into KEY, = and VALUE, and replaces only the part after "=".
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
    """Return "KEY=" for keys that begin with a text; "KEY=VALUE" if the key is complete and has
    choices.
    """
    from tweezer.scene import settable

    keys = settable()
    key, equals, value = incomplete.partition("=")
    found = [key] if equals else [each for each in keys if each.startswith(key)]
    if len(found) == 1 and (choices := keys.get(found[0])):
        return [f"{found[0]}={each}" for each in choices if each.startswith(value)]
    return [] if equals else [f"{each}=" for each in found]


def complete_key(incomplete: str) -> list[str]:
    """Return the keys of a scene that begin with a text."""
    from tweezer.scene import settable

    return [each for each in settable() if each.startswith(incomplete)]


def among(names: Iterable[str]) -> Callable[[str], list[str]]:
    """Return a completion by these names, with hyphens for spaces, at which shells split words."""
    offered = [name.replace(" ", "-") for name in names]

    def complete(incomplete: str) -> list[str]:
        """Return the names that begin with a text."""
        return [name for name in offered if name.startswith(incomplete)]

    return complete
