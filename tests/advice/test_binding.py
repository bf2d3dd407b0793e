"""The advice of scenes that are refused when they are bound, followed to the letter.

These scenes are valid in themselves. What cannot be computed shows when model, method, drag and
forces come together. Each message ends with one change: `set KEY to VALUE`, or `remove KEY`.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import tweezer
from tests.advice import test_scenes
from tests.advice.test_scenes import put, value_of
from tests.fluid.test_drag import growing
from tweezer.dynamics import bind, bound_once, decided, integrate
from tweezer.dynamics.needs import WATCHED, check
from tweezer.dynamics.problem import Problem
from tweezer.dynamics.walk import walk
from tweezer.forces import UserForce, kernel
from tweezer.values.errors import SceneError

Data = dict[str, Any]
#: largest number of pieces of advice that lead to a scene that can be bound
_MOST = 4
NEAR = {"wall": {"position": "-0.8 um"}, "start": {"position": [0, 0, 0]}}
THERMAL = {"forces": {"brownian": True}, "optics": {"evaluator": "quadrature"}}
BODY = {
    "bead": {"moments_of_inertia": [1e-28, 1e-28, 1.5e-28]},
    "start": {"angular_velocity": [0, 0, 1.0]},
}
SHAPED = {"bead": {"moments_of_inertia": [1e-28, 1e-28, 1.5e-28]}}
DARK = {"forces": {"brownian": True, "optical": False}}
UNLIT = {"forces": {"optical": False}}
#: A bead that oscillates in thin gas
LEVITATED = {
    "bead": {"radius": "75 nm"}, "lens": {"numerical_aperture": 0.8},
    "beam": {"polarisation": "linear"}, "medium": {"name": "air", "pressure": "1 mbar"},
}  # fmt: skip
ROD = {"bead": {"shape": "spheroid", "length": "2 um"}, "medium": {"inertia": "none"}}
FILMED = {"camera": {"rate": "1 kHz", "exposure": "0.5 ms"}}
BLINKING = {"beam": {"modulation": {"kind": "on-off", "frequency": "500 Hz"}}}


@kernel
def turning(pose, data, wrench):
    for i in range(len(pose.position)):
        wrench.moment[i, 2] += 1e-21


TURNING = UserForce(turning, (), turns=True)


def with_method(name: str, **more: Any) -> Data:
    return {"simulation": {"method": name, **more}}


def thermal(problem: Problem) -> None:
    bound = walk(problem, 0)
    bound.start(np.array([0]))


def deterministic(problem: Problem) -> None:
    problem, _ = decided(problem)
    bind(problem)


def integrated(problem: Problem) -> None:
    problem, _ = decided(problem)
    integrate(bind(problem), np.array([0.0, 1e-9]))


def watched(problem: Problem) -> None:
    check(walk(problem, 0).problem, WATCHED)


def thermal_by_place(problem: Problem) -> None:
    moved = thermal if problem.scene.forces.brownian else deterministic
    moved(dataclasses.replace(problem, drag=growing()))


def rates(problem: Problem) -> None:
    equations = bind(problem)
    equations.rhs(0.0, equations.initial_state)


#: id: (how it is bound, changes of silica-1um, part of its first message, forces)
REFUSED: dict[str, tuple[Callable[[Problem], None], tuple[Data, ...], str, list[Any]]] = {
    "model of order one beside a wall": (
        thermal, (THERMAL, NEAR, {"simulation": {"model": "scaled", "scaling_factor": 0.5}}),
        "cannot follow thermal motion beside a wall", [],
    ),
    "spring of a trap that blinks": (
        thermal, (THERMAL, BLINKING, with_method("harmonic")), "follows a trap at rest", [],
    ),
    "viscoelastic medium in a trap that couples the axes": (
        thermal, (THERMAL, with_method("harmonic"), {
            "beam": {"polarisation": "circular"},
            "medium": {"relaxing": [{"viscosity": "4 mPa s", "time": "5 ms"}]},
        }), "cannot follow a viscoelastic medium in a trap that couples", [],
    ),
    "noise of the laser in water": (
        thermal, (THERMAL, {"beam": {"noise": {"power": 1e-12}}}), "a bead that oscillates", [],
    ),
    "noise of the laser beside another force": (
        thermal, (THERMAL, LEVITATED, {"beam": {"noise": {"power": 1e-12}}}),
        "under light and weight alone", [TURNING],
    ),
    "recoil in the dark": (
        thermal, (DARK, {"forces": {"recoil": True}}), "for a sphere in steady light", [],
    ),
    "scheme beside a wall": (
        thermal, (THERMAL, NEAR, with_method("baoab", model="full")),
        "cannot keep a bead on its side of a wall", [],
    ),
    "one call with inertia beside a wall": (
        thermal, (THERMAL, NEAR, with_method("one-call", model="full")),
        "cannot keep a bead on its side of a wall", [],
    ),
    "rotation with inertia beside a wall": (
        thermal, ({"forces": {"brownian": True, "brownian_torque": True}}, NEAR,
                  with_method("heun", model="full")),
        "cannot follow thermal rotation beside a wall", [],
    ),
    "spring that turns": (
        thermal, (THERMAL, with_method("harmonic")), "follows no force that turns", [TURNING],
    ),
    "model of order one that turns": (
        thermal, (THERMAL, with_method("heun", model="first-order")),
        "follows no force that turns", [TURNING],
    ),
    "body with inertia": (
        thermal, (THERMAL, BODY, with_method("heun", model="full")),
        "thermal rotation with inertia is computed for spheres", [TURNING],
    ),
    "rod by a method for spheres": (
        thermal, (DARK, ROD, with_method("baoab", model="full")),
        "cannot follow a body that is not a sphere", [],
    ),
    "rod with one call and inertia": (
        thermal, (DARK, ROD, with_method("one-call", model="full")),
        "cannot follow a body that is not a sphere", [],
    ),
    "rod of order one": (
        thermal, (DARK, ROD, with_method("heun", model="first-order")),
        "cannot follow thermal motion of a body that is not a sphere", [],
    ),
    "rod beside a wall": (
        thermal, (DARK, ROD, {"wall": {"position": "-8 um"}}), "beside a wall requires a sphere",
        [],
    ),
    "rod at an equilibrium": (
        thermal, (DARK, ROD, {"start": {"drawn": "equilibrium"}}),
        "start.drawn = 'equilibrium': requires a stable equilibrium", [],
    ),
    "rod at its pose under a force of the user": (
        thermal, (THERMAL, ROD, {"start": {"drawn": "equilibrium"}}),
        "without forces of your own", [TURNING],
    ),
    "rod with inertia in frames": (
        thermal, (DARK, ROD, FILMED, with_method("heun", model="full")),
        "is not available for a body that is not a sphere and a camera", [],
    ),
    "rod in a thin gas": (
        thermal, (DARK, ROD, {"medium": {"viscosity": 1e-6}}, with_method("heun", model="full")),
        "leaves out the gyroscopic force", [],
    ),
    "spring without a trap": (
        thermal, (DARK, with_method("harmonic")), "simulation.method = 'harmonic': requires", [],
    ),
    "start in no trap": (
        thermal, (DARK, {"start": {"drawn": "boltzmann"}}), "start.drawn = 'boltzmann': requires",
        [],
    ),
    "scheme of a uniform drag by place": (
        thermal_by_place, (DARK, with_method("heun", model="overdamped")),
        "requires a drag that is the same everywhere", [],
    ),
    "rotation under a drag by place": (
        thermal_by_place, (DARK, {"simulation": {"model": "overdamped"}}),
        "thermal rotation requires a drag", [TURNING],
    ),
    "events in the frames of a camera": (
        watched, (DARK, {"camera": {"rate": "1 kHz", "exposure": "0.5 ms"}}),
        "events: cannot be combined", [],
    ),
    "events by distributions": (
        watched, (THERMAL, with_method("one-call")), "events would be wrong", [],
    ),
    "too many steps": (
        thermal, (THERMAL, {"simulation": {"duration": 1000.0, "samples": 3}}),
        "from sample to sample", [],
    ),
    "too many steps for any samples": (
        thermal, (DARK, {"simulation": {"duration": 1e6, "samples": 3, "step": 1e-12}}),
        "set simulation.duration to", [],
    ),
    "memory of a body": (
        deterministic, ({"medium": {"inertia": "memory"}}, BODY), "medium.inertia = 'memory'", [],
    ),
    "poles of a body": (
        deterministic, ({"medium": {"poles": 16}}, BODY), "medium.poles = 16: requires", [],
    ),
    "exponential of a body": (
        integrated, (BODY, {"medium": {"inertia": "none"}},
                     with_method("exponential", model="full")),
        "simulation.method = 'exponential': requires", [],
    ),
    "model of order one, and a wall": (
        deterministic, (NEAR, with_method("auto", model="first-order")),
        "requires a drag that is the same everywhere", [],
    ),
    "rod in the scaled model": (
        deterministic, (UNLIT, ROD, {"simulation": {"model": "scaled", "scaling_factor": 0.5}}),
        "simulation.model = 'scaled': applies to spheres", [],
    ),
    "rod close to a wall": (
        deterministic,
        (UNLIT, ROD, {"wall": {"position": "-4 um"}, "start": {"position": [0, 0, 0]}}),
        "wall: the drag beside a wall is known for spheres", [],
    ),
    "rates with memory": (
        rates, ({"medium": {"inertia": "memory", "poles": 16}}, with_method("auto", model="full")),
        "cannot follow the memory", [],
    ),
}  # fmt: skip


def follow(message: str, data: Data) -> None:
    """Make the one change at the end of a message; or what a refused scene advises."""
    if found := re.search(r"; set ([\w.]+) to (\S+)$", message):
        put(data, found[1], value_of(found[2]))
    elif found := re.search(r"; remove (\w+)\.(\w+)$", message):
        del data[found[1]][found[2]]
    elif found := re.search(r"; remove (\w+)$", message):
        del data[found[1]]
    elif message.startswith("events:"):
        assert message.endswith("; omit one of them")
        del data["camera"]
    else:
        assert test_scenes.follow(message, data), f"no advice at the end: {message}"


def refused(name: str) -> Data:
    """Return the scene of a name."""
    data = tweezer.load_scene("silica-1um").model_dump(mode="json", exclude_none=True)
    for each in REFUSED[name][1]:
        for section, keys in each.items():
            data.setdefault(section, {}).update(keys)
    return data


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", REFUSED)
def test_advice_at_binding_leads_to_a_bound_scene(name):
    bound, _, told, forces = REFUSED[name]
    data = refused(name)
    seen: list[str] = []
    while len(seen) < _MOST:
        try:
            bound(bound_once(tweezer.load_scene(data), forces))
        except SceneError as error:
            message = str(error)
            assert "\n" not in message
            assert message not in seen, f"the advice changes nothing: {message}"
            seen.append(message)
            follow(message, data)
        else:
            break
    else:
        raise AssertionError("\n".join(seen))
    assert told in seen[0]
