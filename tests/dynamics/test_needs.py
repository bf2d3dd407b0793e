"""The table of needs: a scene reaches every row, and the stated remedy mends that scene."""

import dataclasses
import re

import pytest

import tweezer
from tests.advice.test_binding import (
    BODY,
    DARK,
    LEVITATED,
    NEAR,
    REFUSED,
    ROD,
    SHAPED,
    THERMAL,
    TURNING,
    follow,
    refused,
    with_method,
)  # fmt: skip
from tests.fluid.test_drag import growing
from tweezer.dynamics import bound_once, needs
from tweezer.dynamics.needs import DETERMINISTIC, LINEAR, MEMORY
from tweezer.values.errors import SceneError

TABLES = ("OF_MODEL", "NEEDS", "WATCHED", "OF_EQUATIONS", "OF_METHOD")
ROWS = [(table, i) for table in TABLES for i in range(len(getattr(needs, table)))]


def message_of(data, name):
    """What a scene of `REFUSED` is refused with; "" if it is bound."""
    how, _, _, forces = REFUSED[name]
    try:
        how(bound_once(tweezer.load_scene(data), forces))
    except SceneError as error:
        return str(error)
    return ""


@pytest.fixture(scope="module")
def messages():
    return {name: message_of(refused(name), name) for name in REFUSED}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("table", "i"), ROWS)
def test_remedy_of_every_row_mends_a_scene(messages, table, i):
    row = getattr(needs, table)[i]
    words = ".*".join(map(re.escape, re.split(r"{\w+}", row.problem)))
    reached = re.compile(rf"{re.escape(row.key)}( = \S+)?: {words}; ")
    names = [name for name, message in messages.items() if reached.match(message)]
    assert names, "no scene reaches this row"
    for name in names:
        data = refused(name)
        follow(messages[name], data)
        assert not reached.match(message_of(data, name))


def spring(problem):
    """A trap whose axes are coupled, as by light that pushes the bead round the axis."""
    trap = problem.equilibrium
    stiffness = trap.stiffness.copy()
    stiffness[0, 1] = 0.1 * stiffness[0, 0]
    problem.__dict__["equilibrium"] = dataclasses.replace(trap, stiffness=stiffness)
    return problem


def by_place(problem):
    return dataclasses.replace(problem, drag=growing())


def as_it_is(problem):
    return problem


THIN = {
    "medium": {"name": "air", "pressure": "1 mbar"}, "lens": {"numerical_aperture": 0.8},
}  # fmt: skip
CHAINS = {
    "medium": {"power_law": {
        "exponent": 0.5, "modulus": "0.05 Pa", "at": "0.159 Hz", "band": ["1 Hz", "1 MHz"],
    }},
    "simulation": {"model": "full"},
}  # fmt: skip
OVERDAMPED = with_method("heun", model="overdamped")
#: changes of silica-1um, forces, a change of the problem; motion and row that it reaches
FORGOTTEN = [
    (({"simulation": {"model": "scaled", "scaling_factor": 0.5}},), [], as_it_is, DETERMINISTIC, 0),
    (({"simulation": {"model": "scaled", "scaling_factor": 0.5}},), [], as_it_is, LINEAR, 0),
    ((with_method("dop853", model="full"),), [], as_it_is, DETERMINISTIC, 1),
    ((with_method("dop853", model="full"),), [], as_it_is, LINEAR, 1),
    ((NEAR,), [], as_it_is, DETERMINISTIC, 2),
    ((), [], by_place, DETERMINISTIC, 2),
    ((BODY,), [], as_it_is, DETERMINISTIC, 3),
    ((SHAPED,), [TURNING], as_it_is, DETERMINISTIC, 3),
    ((THERMAL, with_method("baoab", model="full")), [], as_it_is, needs.THERMAL, 4),
    ((THERMAL, OVERDAMPED), [], as_it_is, needs.THERMAL, 4),
    ((THERMAL, with_method("heun", model="full")), [], by_place, needs.THERMAL, 5),
    ((NEAR,), [], as_it_is, LINEAR, 5),
    ((THERMAL, with_method("harmonic", model="full")), [], spring, needs.THERMAL, 6),
    ((THERMAL, with_method("heun", model="scaled", scaling_factor=0.5)), [], as_it_is,
     needs.THERMAL, 7),
    ((ROD,), [], as_it_is, DETERMINISTIC, 8),
    ((THERMAL, ROD), [], as_it_is, LINEAR, 8),
    ((THIN,), [], as_it_is, DETERMINISTIC, 9),
    ((THIN,), [], as_it_is, LINEAR, 9),
    ((THIN, THERMAL, with_method("heun", model="full")), [], as_it_is, needs.THERMAL, 9),
    ((CHAINS,), [], as_it_is, DETERMINISTIC, 10),
    ((CHAINS, THERMAL, with_method("heun", model="full")), [], as_it_is, needs.THERMAL, 10),
]  # fmt: skip


def scene_of(changes):
    scene = tweezer.load_scene("silica-1um")
    for each in changes:
        scene = scene.replace(**each)
    return scene


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("changes", "forces", "changed", "motion", "i"), FORGOTTEN)
def test_motion_without_memory_says_why(changes, forces, changed, motion, i):
    problem = changed(bound_once(scene_of(changes), forces))
    reason = needs.without_memory(problem, motion)
    assert reason == needs.Facts(problem).says(MEMORY[i].why)
    assert "{" not in reason


def test_every_row_of_memory_is_reached():
    reached = {(motion, i) for *_, motion, i in FORGOTTEN}
    assert reached == {(motion, i) for i, row in enumerate(MEMORY) for motion in row.motions}


@pytest.mark.parametrize("changes", [(), (THERMAL, with_method("heun", model="full"))])
def test_sphere_in_bulk_may_have_memory(changes):
    problem = bound_once(scene_of(changes))
    thermal = needs.THERMAL if changes else DETERMINISTIC
    assert not needs.without_memory(problem, thermal)
    assert not needs.without_memory(problem, LINEAR)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("changes", "changed", "model", "method"),
    [
        ((THERMAL, CHAINS), as_it_is, 0, 7),
        ((THERMAL,), as_it_is, 1, 7),
        ((THERMAL, LEVITATED), as_it_is, 1, 6),
        ((DARK, ROD), as_it_is, 1, 5),
        ((DARK,), by_place, 2, 4),
        ((THERMAL, NEAR), as_it_is, 2, 3),
    ],
)
def test_choice_of_every_row(changes, changed, model, method):
    problem = changed(bound_once(scene_of(changes)))
    for key, i in (("model", model), ("method", method)):
        row = needs.CHOICES[i]
        problem, why = needs.choice(problem, key)
        assert getattr(problem.scene.simulation, key) == row.value
        assert why == f"{row.value}: {row.why}"
