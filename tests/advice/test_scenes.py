"""The advice of every refused scene, followed to the letter until the scene is accepted.

A message that names a value, a unit or a key is followed by program: the words are taken from the
message itself. Each step must lead to another message or to a scene; a message whose advice changes
nothing fails here, and so does advice that never leads to a scene.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable
from typing import Any

import pytest

from tests.scene.test_bad_scenes import BAD_SCENES, as_toml
from tweezer.scene import Scene, load_scene
from tweezer.values.errors import SceneError

Data = dict[str, Any]
#: largest number of pieces of advice that lead from a bad scene to a good one
_MOST = 6
#: what cannot be followed by program: nothing in the message is a value, and people decide
DECIDED_BY_PEOPLE = re.compile(
    r"must be finite|must be a whole number|must be text$|must be a list|must have \d|must not|"
    r"must be a section|must begin with|: missing|one is required|give only one$|"
    r"must be a (complex )?number|no body has a moment|must start|must be nearer|"
    r"must be perpendicular to|must be larger|must be 0$|"
    r"cannot be combined with layers|has \d+ entries|must be given if drawn|"
    r"must be at z = 0|must reach|requires ray optics, and|"
    r"must be true or false$|must be convertible to K|has the wrong unit; must be a number|"
    r"must have a finite length above 0$"
)


def place(data: Data, key: str) -> tuple[Any, Any]:
    """Return the container of a dotted key, and the last part of the key."""
    *outer, last = key.split(".")
    within: Any = data
    for part in outer:
        within = within[int(part)] if isinstance(within, list) else within.setdefault(part, {})
    return within, int(last) if isinstance(within, list) else last


def put(data: Data, key: str, value: Any) -> None:
    within, last = place(data, key)
    within[last] = value


def renamed(data: Data, key: str, new: str) -> None:
    within, last = place(data, key)
    if new in within:
        del within[last]
    else:
        within[new] = within.pop(last)


def removed(data: Data, line: str) -> None:
    """Remove the key at the beginning of a line; of several alternatives, the existing one."""
    section, _, names = line.partition(":")[0].partition(".")
    for name in names.split(" or "):
        data[section].pop(name, None)


def value_of(text: str) -> Any:
    """Return a value as a message writes it."""
    text = text.strip().strip("'\"")
    try:
        number = float(text)
    except ValueError:
        return {"true": True, "false": False}.get(text, text)
    return int(number) if number.is_integer() else number


def between(low: float, high: float) -> float:
    return math.sqrt(low * high) if low > 0 else (low + high) / 2


def names(text: str) -> list[str]:
    """Return the names of a list such as 'a', 'b' or 'c'."""
    return [each.strip(" '") for each in re.split(r",| or ", text) if each.strip(" '")]


NEAR = {"wall": {"position": "-0.8 um"}, "start": {"position": [0, 0, 0]}}
THERMAL = {"forces": {"brownian": True}}
MEMORY = {"medium": {"inertia": "memory"}}
#: what does not go together, as changes of a shipped scene
CONFLICTS: dict[str, tuple[Data, ...]] = {
    "number of poles without memory": ({"medium": {"inertia": "none", "poles": 16}},),
    "memory by an explicit method": (MEMORY, {"simulation": {"method": "dop853"}}),
    "memory without inertia": (MEMORY, {"simulation": {"model": "overdamped"}}),
    "memory beside a wall": (MEMORY, NEAR),
    "memory by another scheme": (MEMORY, THERMAL, {"simulation": {"method": "baoab"}}),
    "scheme without inertia": (THERMAL, {"simulation": {"method": "baoab", "model": "overdamped"}}),
    "camera by distributions": (
        THERMAL, {"simulation": {"method": "one-call"}, "camera": {
            "rate": "1 kHz", "exposure": "0.5 ms", "noise": "1 nm"}},
    ),
    "exposure of several frames": (
        {"camera": {"rate": "1 kHz", "exposure": "3 ms", "noise": "1 nm"}},
    ),
    "exposure of a third": (
        {"camera": {"rate": "3 kHz", "exposure": "0.4 ms", "noise": "1 nm"}},
    ),
    "thermal rotation of a body": (
        THERMAL,
        {"simulation": {"model": "full"}, "bead": {"moments_of_inertia": [1e-28, 1e-28, 1.5e-28]},
         "start": {"angular_velocity": [0, 0, 1.0]}},
    ),
    "layers of walls": ({"wall": {"position": "-3 um", "opposite": "2 um"}},),
}  # fmt: skip


def follow(line: str, data: Data) -> bool:
    """Do what one line of a refusal says; return whether it says something to do."""
    key = re.match(r"[\w.\[\]]+( b)?", line)[0].replace(" b", "\nb")  # one key has a line break
    rules: tuple[tuple[str, Callable[[re.Match[str]], None]], ...] = (
        (r'for .* write "(.*)"', lambda m: put(data, key, m[1])),
        (r"unknown key; did you mean (\w+)\?", lambda m: renamed(data, key, m[1])),
        (r"did you mean (true|false)\?", lambda m: put(data, key, m[1] == "true")),
        (r"= '([\d.]+)\s*\S*': .*did you mean (\S+)\?",
         lambda m: put(data, key, f"{m[1]} {m[2]}")),
        (r"unknown key; allowed: ", lambda m: place(data, key)[0].pop(place(data, key)[1], None)),
        (r"allowed with ([\w.]+): (.*)$", lambda m: put(data, m[1], names(m[2])[0])),
        (r"allowed with ([\w.]+): ", lambda m: put(data, m[1], True)),
        (r"allowed: (\w+(?:\.\w+)+) = '(\w+)', and a bead that does not absorb",
         lambda m: (put(data, m[1], m[2]), put(data, "bead.refractive_index", 1.57))),
        (r"; remove it", lambda m: removed(data, line)),
        (r"; set (\w+\.\w+) to ([\w-]+)", lambda m: put(data, m[1], m[2])),
        (r"allowed: (.*)$", lambda m: put(data, key, names(m[1])[0])),
        (r"the imaginary part must be", lambda m: put(data, key, "1.5")),
        (r"has no unit; .* such as \"(.*)\"", lambda m: put(data, key, m[1])),
        (r"must be from (\S+) to (\S+)",
         lambda m: put(data, key, between(float(m[1]), float(m[2])))),
        (r"must be at (?:least|most) ([\d.e+-]+)", lambda m: put(data, key, value_of(m[1]))),
        (r"must be less than [\w.]+ = ([\d.]+)", lambda m: put(data, key, 0.95 * float(m[1]))),
        (r"convertible to \w+(?: s|/\S+)?, such as (\w+)", lambda m: put(data, key, f"0.5 {m[1]}")),
        (r'or (?:text with a unit such as )?"([^"]+)"', lambda m: put(data, key, m[1])),
        (r"(?:needs|requires|is for) ([\w.]+) = true", lambda m: put(data, m[1], True)),
        (r"requires (lens\.focal_length)", lambda m: put(data, m[1], "2 mm")),
        (r"give only one$", lambda m: place(data, key)[0].pop(place(data, key)[1])),
        (r"missing; the (\w+) (?:map|model) requires it",
         lambda m: put(data, key, {"numerical_aperture": 1.2, "focal_length": "2 mm"}.get(
             key.split(".")[1], 0.1))),
    )  # fmt: skip
    for pattern, do in rules:
        if found := re.search(pattern, line):
            do(found)
            return True
    return False


def refusal(data: Data) -> str:
    """Return what a scene is refused with, "" if it is accepted."""
    try:
        assert isinstance(load_scene(data), Scene)
    except SceneError as error:
        return str(error)
    return ""


def advised(data: Data) -> None:
    """Follow the advice of a refused scene until it is accepted, or people have to decide."""
    said = refusal(data)
    assert said
    seen = []
    while said and len(seen) < _MOST:
        line = said.splitlines()[0]
        assert line not in seen, f"the advice changes nothing: {line}"
        seen.append(line)
        if not follow(line, data):
            assert DECIDED_BY_PEOPLE.search(line), f"no rule follows: {line}"
            return
        said = refusal(data)
    assert not said, "\n".join([*seen, said])


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "changes", [changes for changes, _ in BAD_SCENES.values()], ids=list(BAD_SCENES)
)
def test_the_advice_of_a_refusal_leads_to_a_scene(changes):
    data = tomllib.loads(as_toml(changes))
    advised(data)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("changes", CONFLICTS.values(), ids=list(CONFLICTS))
def test_the_advice_about_keys_that_conflict_leads_to_a_scene(changes):
    data = load_scene("silica-1um").model_dump(mode="json", exclude_none=True)
    for each in changes:
        for section, keys in each.items():
            data.setdefault(section, {}).update(keys)
    advised(data)
