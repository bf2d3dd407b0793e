"""Forces of the user's own that break their contract: refused in one line, or the run fails."""

import linecache
import math
import sys

import numba
import numpy as np
import pytest

import tweezer
from tests.mutated_kernels import mutated_kernels
from tweezer import forces
from tweezer.forces import (
    Course,
    Moved,
    UserForce,
    kernel,
    matrix,
    number,
    tensor,
    trial,
    vector,
)
from tweezer.values.errors import ForceError, SceneError

DARK = tweezer.load_scene("silica-1um").replace(
    forces={"optical": False, "gravity": False, "buoyancy": False},
    simulation={"model": "overdamped", "method": "dop853", "duration": "1 ms", "samples": 11},
    medium={"inertia": "none"},
)
THERMAL = DARK.replace(forces={"brownian": True}, simulation={"method": "auto"})
ENTRIES = (2e-5, [0.0, 1e-7, 0.0], np.eye(3))


def made(lines, entries=ENTRIES, **how):
    """Return the force of a function of these lines."""
    text = "def own(pose, data, wrench):\n    " + lines.replace("\n", "\n    ") + "\n"
    linecache.cache["own.py"] = len(text), None, text.splitlines(keepends=True), "own.py"
    names = {
        "np": np, "math": math, "number": number, "vector": vector, "matrix": matrix,
        "tensor": tensor, "forces": forces,
    }  # fmt: skip
    exec(compile(text, "own.py", "exec"), names)
    return UserForce(kernel(names["own"]), entries, **how)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("wrench.force[0, 0] += number(data, 3)", "the force has 3 entries; allowed: 0 to 2"),
        ("wrench.force[0, 0] += number(data, -1)", "allowed: 0 to 2"),
        ("wrench.force[0, 0] += forces.number(data, 4)", "allowed: 0 to 2"),
        ("wrench.force[0, 0] += number(data, 1.0)", "is a whole number"),
        ("wrench.force[0] += vector(data, 0)", "entry 0 is a number; read it by number(data, 0)"),
        ("wrench.force[0, 0] += number(data, 1)", "read it by vector(data, 1)"),
        ("wrench.force[0] += tensor(data, 2)[0, 0]", "read it by matrix(data, 2)"),
        ("wrench.force[0, 5] += 1e-12", "index 5 is out of bounds for axis 1 with size 3"),
        ("wrench.force[len(pose.time)] += 1e-12", "raises IndexError: index"),
        ("wrench.force_gradient[0, 0, 0] -= 1e-6", "it is empty unless gradients are computed"),
        ("wrench.force[0, 0] += pose.orientation[0, 0]", "it is empty without turns=True"),
        ("wrench.force[:] += vector(data, 1)[:2]", "raises ValueError: operands could not be br"),
        ("pose.position[0, 0] += 1e-8", "writes to the pose or to an entry"),
        ("pose.time[:] = 0.0", "writes to the pose or to an entry"),
        ("vector(data, 1)[0] = 1.0", "writes to the pose or to an entry"),
        ("matrix(data, 2)[0] *= 2.0", "writes to the pose or to an entry"),
        ("wrench.force[:, 0] = 1e-12", "sets the wrench, which contains the other forces"),
        ("wrench.error[:] = 1e-18", "sets the wrench, which contains the other forces"),
        ("wrench.force[:] *= 0.5", "sets the wrench, which contains the other forces"),
        ("wrench.force[:, 0] += undefined", "name 'undefined' is not defined"),
    ],
)
def test_function_that_is_wrong_everywhere_is_refused_with_its_line(line, message):
    """Before anything is compiled."""
    with pytest.raises(ForceError) as refused:
        made(f"k = 1.0\n{line}")
    said = str(refused.value)
    assert said.startswith(f"forces: own, line 3, `{line}`: ")
    assert message in said
    assert len(said.splitlines()) == 1


@numba.njit
def waits(values):
    """Return a helper that never returns."""
    i = 0
    while i < len(values):
        values[0] += 1e-15
    return 0.0


@pytest.mark.parametrize(
    "lines",
    [
        "while True:\n    wrench.force[0, 0] += 1e-15",
        "while pose.time[0] < 1.0: pass",
        "while True: pass",
        "for i in range(10**12):\n    pass",
        "while True:\n    try:\n        k = 1 / 0\n    except Exception:\n        pass",
        "wrench.force[0, 0] += forces.waits(np.zeros(3))",
    ],
)
def test_function_that_does_not_end_is_refused_with_its_line(lines, monkeypatch):
    monkeypatch.setattr(trial, "_MOST_LINES", 1000)
    monkeypatch.setattr(forces, "waits", waits, raising=False)
    with pytest.raises(ForceError) as refused:
        made(lines)
    said = str(refused.value)
    assert said.startswith("forces: own, line ")
    assert int(said.split()[3].rstrip(",")) in range(2, 3 + lines.count("\n"))
    assert "does not end within 1,000 lines of plain Python; allowed: loops that end" in said
    assert len(said.splitlines()) == 1


def test_function_with_many_lines_is_taken():
    """A sum over a thousand entries, for each of three beads."""
    before = sys.gettrace()
    made(
        "for i in range(len(pose.time)):\n"
        "    for k in range(1000):\n"
        "        wrench.force[i, 0] += 1e-18 * k"
    )
    assert sys.gettrace() is before


@pytest.mark.parametrize(
    "line", ["wrench.force[0, 0] += 1e-12", "wrench.force[:, 0] += 1e-12 * np.random.random()"]
)
def test_force_that_depends_on_the_other_beads_is_refused(line):
    with pytest.raises(ForceError, match="depends on how many beads there are"):
        made(line)


def test_faults_of_floating_point_are_those_of_compiled_code():
    """`math.exp` overflows to infinity there, so that this force is 0."""
    force = made(
        "for i in range(len(pose.time)):\n"
        "    wrench.force[i, 0] += 1e-12 / (1.0 + math.exp(1e3 + 1e3 * pose.time[i]))"
    )
    assert not force._doubt


@numba.njit
def beyond(values, index):
    """Return a helper that reads beyond an array."""
    return values[index]


@kernel
def faulty(pose, data, wrench):
    """A constant push along x that goes wrong in a way of its own, beyond a plane."""
    how, beyond_x = number(data, 0), number(data, 1)
    for i in range(len(pose.time)):
        wrench.force[i, 0] += 1e-13
        if how == 20 and len(wrench.force_gradient) > 0:
            wrench.force_gradient[i, 0, 0] -= 1e-5
        if how == 21:
            wrench.moment[i, 0] += 1e-20
        if how == 22:
            wrench.force[i, 0] += 1e-10 * pose.time[i]
        if pose.position[i, 0] > beyond_x:
            if how == 1:
                raise ValueError("too far")
            if how == 2:
                wrench.force[i, 1] += np.nan
            if how == 3:
                wrench.error[i] -= 1e-15
            if how == 4:
                wrench.error[i] += np.nan
            if how == 5:
                wrench.force[i, int(number(data, 2))] += 1e-12
            if how == 6:
                wrench.force[i, 0] += number(data, 3)
            if how == 7:
                wrench.force[i, 0] += vector(data, 0)[0]
            if how == 8:
                wrench.force[i, 0] += beyond(pose.position[i], 10**6)
            if how == 9:
                wrench.force[i, 0] = 1e-13  # of its own wrench: the other forces stay
            if how == 10:
                wrench.force[i, 0] += 1e-15 * (1 // (int(number(data, 2)) - 3))


FAULTS = {
    1: 'raise ValueError("too far")`: raises ValueError: too far',
    2: "wrench.force[i, 1] += np.nan`: the force is not finite",
    3: "wrench.error[i] -= 1e-15`: the error of the force must be finite and not negative",
    4: "wrench.error[i] += np.nan`: the error of the force must be finite and not negative",
    5: "index 3 is out of bounds for axis 1 with size 3",
    6: "number(data, 3): the force has 3 entries; allowed: 0 to 2",
    7: "vector(data, 0): entry 0 is a number; read it by number(data, 0)",
    8: "return values[index]`: raises IndexError: index 1000000 is out of bounds",
    10: "raises ZeroDivisionError: ",
}
PLANE = 5.002e-6
FAR = {"start": {"position": [5e-6, 0.0, 0.0]}}


def force_of(how, **of_force):
    return UserForce(faulty, (how, PLANE, 3), **of_force)


@pytest.mark.parametrize("scene", [DARK, THERMAL], ids=["by steps", "thermal"])
@pytest.mark.parametrize("how", FAULTS)
def test_run_in_which_a_force_goes_wrong_fails_with_its_line(scene, how):
    """Where it was not tried; what the run reached before is kept."""
    with pytest.warns(tweezer.PhysicsWarning, match="failed"):
        run = tweezer.simulate(scene.replace(**FAR), forces=[force_of(how)])
    assert run.status == "failed"
    assert "forces: faulty, line" in run.message
    assert FAULTS[how] in run.message
    assert "the place (5.0" in run.message
    assert np.isfinite(run["net_force"]).all()


@pytest.mark.parametrize("how", FAULTS)
def test_force_that_goes_wrong_where_the_bead_starts_is_refused(how):
    scene = DARK.replace(start={"position": [6e-6, 0.0, 0.0]})
    with pytest.raises(SceneError, match="forces: faulty, line") as refused:
        tweezer.simulate(scene, forces=[force_of(how)])
    assert FAULTS[how] in str(refused.value)


def test_moved_force_that_goes_wrong_fails_as_well():
    moved = Moved(force_of(1), Course.constant(0.0, 0.0, 0.0), Course.constant(1.0))
    with pytest.warns(tweezer.PhysicsWarning, match="too far"):
        assert tweezer.simulate(DARK.replace(**FAR), forces=[moved]).status == "failed"


def test_only_the_bead_on_which_a_force_fails_has_none():
    """The bead is one of many, in the first, a middle or the last part of a call."""
    places = np.zeros((200, 3))
    wrong = [0, 70, 71, 199]
    places[wrong, 0] = 6e-6
    for how in FAULTS:
        found = force_of(how).field(places)
        failed = np.isnan(found.force).all(axis=1)
        assert np.flatnonzero(failed).tolist() == wrong
        np.testing.assert_array_equal(found.force[~failed], [[1e-13, 0.0, 0.0]] * 196)


def test_function_that_sets_its_force_beyond_its_trial_leaves_the_others():
    scene = tweezer.load_scene("silica-1um").replace(
        simulation={"duration": "0.1 ms", "samples": 3, "model": "overdamped"},
        medium={"inertia": "none"}, **FAR,
    )  # fmt: skip
    run, right = (tweezer.simulate(scene, forces=[force_of(how)]) for how in (9, 0))
    np.testing.assert_array_equal(run["net_force"], right["net_force"])


@pytest.mark.parametrize(
    ("how", "of_force", "message"),
    [
        (20, {"gradient": True}, "wrench.force_gradient is not the derivative of wrench.force"),
        (21, {}, "adds to wrench.moment; give turns=True"),
        (22, {}, "depends on the time; give by_time=True"),
    ],
)
def test_force_that_contradicts_its_declaration_is_refused(how, of_force, message):
    with pytest.raises(ForceError) as refused:
        tweezer.simulate(DARK, forces=[force_of(how, **of_force)])
    assert str(refused.value).startswith(f"forces: faulty: {message}")


def test_error_of_a_user_s_force_is_in_that_of_the_net_force():
    @kernel
    def uncertain(pose, data, wrench):
        for i in range(len(pose.time)):
            wrench.error[i] += 3e-15

    run = tweezer.simulate(DARK, forces=[UserForce(uncertain)])
    np.testing.assert_allclose(run["net_force_error"], 3e-15, rtol=1e-12)
    assert run["net_force"].attrs["ancillary_variables"] == "net_force_error"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (faulty, "did you mean [UserForce(faulty)]?"),
        ([faulty], "did you mean [UserForce(faulty)]?"),
        (made, "did you mean [UserForce(kernel(made))]?"),
        (force_of(0), "put the UserForce in brackets"),
        (None, "not None"),
        ([1.0], "not of 1.0"),
    ],
)
def test_argument_that_is_no_list_of_forces_is_refused(given, message):
    with pytest.raises(SceneError) as refused:
        tweezer.simulate(DARK, forces=given)
    assert str(refused.value).startswith("forces: must be a list of UserForce")
    assert message in str(refused.value)


def test_function_that_numba_cannot_compile_is_refused_with_its_line():
    force = made("k = 1.0\nwrench.force[:, 0] += k * sum({1e-12: 'as Python adds it'})")
    with pytest.raises(ForceError, match=r"forces: own, line 3.*Numba cannot compile") as refused:
        tweezer.simulate(DARK, forces=[force])
    assert len(str(refused.value).splitlines()) == 1


def test_ensemble_with_a_force_is_that_of_its_runs():
    """Trajectory 0 is the run of the seed; a force that fails ends the ensemble with its line."""
    run = tweezer.simulate(THERMAL, forces=[force_of(0)], seed=3)
    found = tweezer.ensemble(THERMAL, 3, forces=[force_of(0)], seed=3, workers=1)
    np.testing.assert_array_equal(found["position"].values[0], run["position"].values)
    assert found.attrs["other_forces"] == 1
    with pytest.raises(tweezer.IntegrationError, match="trajectory 0: forces: faulty, line"):
        tweezer.ensemble(THERMAL.replace(**FAR), 1, forces=[force_of(1)], workers=1)
    with pytest.raises(SceneError, match=r"forces: cannot be combined with out"):
        tweezer.ensemble(THERMAL, 3, forces=[force_of(0)], out="a.zarr")


def test_forces_of_mutated_functions_are_right_or_refused():
    """`make stress` has 200."""
    assert sum(mutated_kernels(5).values()) == 5
