"""What the shell completes: scenes, keys of scenes with their values, and names.

A shell asks at each press of a key, so that only the keys of scenes load what scenes need.
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
    """Shipped scenes, TOML files here, and folders, which may have some."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml",))]


def complete_shown(incomplete: str) -> list[str]:
    """Scenes, and files of results."""
    return [*_shipped(incomplete), *_files(incomplete, (".toml", *RESULTS, SAVED_TRAP))]


def _shipped(incomplete: str) -> list[str]:
    return sorted(path.stem for path in _SHIPPED.glob("*.toml") if path.stem.startswith(incomplete))


def _files(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Files of these types in the folder that is typed, and then its folders."""
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
    """Let the application print its completions; those of KEY=VALUE without the KEY=.

    Bash parts the word at the cursor into KEY = VALUE, and replaces what is behind the = alone.
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
    """KEY= of the keys of a scene; KEY=VALUE where the key is told and has a few values."""
    from tweezer.scene import settable

    keys = settable()
    key, equals, value = incomplete.partition("=")
    found = [key] if equals else [each for each in keys if each.startswith(key)]
    if len(found) == 1 and (choices := keys.get(found[0])):
        return [f"{found[0]}={each}" for each in choices if each.startswith(value)]
    return [] if equals else [f"{each}=" for each in found]


def complete_key(incomplete: str) -> list[str]:
    """Keys of a scene."""
    from tweezer.scene import settable

    return [each for each in settable() if each.startswith(incomplete)]


def among(names: Iterable[str]) -> Callable[[str], list[str]]:
    """The completion by some names; spaces within them become hyphens, which shells do not part."""
    offered = [name.replace(" ", "-") for name in names]

    def complete(incomplete: str) -> list[str]:
        return [name for name in offered if name.startswith(incomplete)]

    return complete
