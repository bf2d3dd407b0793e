"""Licences of everything that an environment has installed: `python tests/licences.py`.

It uses the standard library alone, so that it runs in any environment.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from importlib import metadata

#: licences that an MIT-licensed package may depend on: permissive ones, and MPL, whose terms stay
#: with its own files
PERMISSIVE = re.compile(
    r"\b(MIT|BSD|0BSD|ISC|Apache|Apache-2\.0|PSF|PSFL|PSF-2\.0|Zlib|CC0-1\.0|Unlicense|HPND|MPL)\b"
    r"|Python Software Foundation|Mozilla Public License|Matplotlib",
    re.IGNORECASE,
)
#: licences whose terms pass on to what depends on them
COPYLEFT = re.compile(r"\b(A?GPL|LGPL)|GNU|EUPL|CeCILL|SSPL", re.IGNORECASE)
#: licences of distributions whose metadata names none, as their LICENSE files have it
KNOWN = {"scipy": "BSD-3-Clause", "matplotlib": "PSF-like (matplotlib)"}


def licence(distribution: metadata.Distribution) -> str:
    """Return the licence that a distribution states: its expression, classifiers or text."""
    said = distribution.metadata
    name = said["Name"].lower()
    if expression := said.get("License-Expression"):
        return expression
    classified = [
        each.rpartition("::")[2].strip()
        for each in said.get_all("Classifier") or []
        if each.startswith("License ::")
    ]
    text = " ".join((said.get("License") or "").split())[:80]
    return "; ".join(classified) or KNOWN.get(name) or text or "not stated"


def accepted(text: str) -> bool:
    """Return whether an MIT-licensed package can depend on a package of this licence."""
    alternatives = re.split(r"\bOR\b", text)
    return any(PERMISSIVE.search(each) and not COPYLEFT.search(each) for each in alternatives)


def required(name: str) -> set[str]:
    """Return the names of what `name` requires without extras, and of `name` itself."""
    from packaging.requirements import Requirement
    from packaging.utils import canonicalize_name

    found: set[tuple[str, frozenset[str]]] = set()
    waiting: list[tuple[str, frozenset[str]]] = [(name, frozenset())]
    while waiting:
        at, extras = waiting.pop()
        if (at, extras) in found:
            continue
        found.add((at, extras))
        for text in metadata.requires(at) or ():
            wanted = Requirement(text)
            environments = [{"extra": extra} for extra in extras] or [{"extra": ""}]
            if wanted.marker is None or any(map(wanted.marker.evaluate, environments)):
                waiting.append((canonicalize_name(wanted.name), frozenset(wanted.extras)))
    return {at for at, _ in found}


def refused(names: Iterable[str]) -> list[str]:
    """Return a line for each distribution that an MIT-licensed package cannot depend on."""
    stated = {name: licence(metadata.distribution(name)) for name in names}
    return [f"{name}: {text}" for name, text in sorted(stated.items()) if not accepted(text)]


def main() -> int:
    """Print every distribution and its licence; return 1 if one of them is refused."""
    names = sorted({each.metadata["Name"] for each in metadata.distributions()}, key=str.lower)
    for name in names:
        print(f"{name:30} {licence(metadata.distribution(name))}")
    lines = refused(names)
    print("\n".join(["cannot be depended on:", *lines]) if lines else f"{len(names)} permissive")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
