"""Random changes of a user's own force: no function crashes or gives a silent wrong result.

A mutation changes an index, an entry, a reader, a bound of a loop or an assignment, or inserts a
line: an exception, NaN, an invalid error, or a write to a read-only array. The oracle is the same
text, run by Python with NumPy arrays.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import json
import linecache
import os
import sys
import warnings
from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

import tweezer
from tweezer import forces
from tweezer.forces import Pose, UserForce, Wrench, kernel

SPRING = """
def own(pose, data, wrench):
    stiffness, centre = number(data, 0), vector(data, 1)
    for i in range(len(pose.position)):
        for k in range(3):
            wrench.force[i, k] -= stiffness * (pose.position[i, k] - centre[k])
        wrench.error[i] += 1e-18
"""
GRADIENT = """
def own(pose, data, wrench):
    stiffness, centre = matrix(data, 2), vector(data, 1)
    for i in range(len(pose.time)):
        for k in range(3):
            for l in range(3):
                wrench.force[i, k] -= stiffness[k, l] * (pose.position[i, l] - centre[l])
                if len(wrench.force_gradient) > 0:
                    wrench.force_gradient[i, k, l] -= stiffness[k, l]
"""
IN_TIME = """
def own(pose, data, wrench):
    push, centre = number(data, 0) * 1e-7, vector(data, 1)
    for i in range(len(pose.time)):
        wrench.force[i] += push * np.cos(4000.0 * pose.time[i]) * (pose.position[i] - centre) * 1e6
        wrench.error[i] += 1e-3 * push
"""
SWIMMER = """
def own(pose, data, wrench):
    push, axis = number(data, 0) * 1e-8, vector(data, 1)
    for i in range(len(pose.position)):
        e0, e1, e2, e3 = pose.orientation[i]
        wrench.force[i, 0] += push * (e0**2 + e1**2 - e2**2 - e3**2)
        wrench.force[i, 1] += push * 2 * (e1 * e2 + e0 * e3)
        wrench.moment[i, 2] += push * 1e-8 * axis[0] * 1e7
"""
KERNELS: dict[str, tuple[str, dict[str, bool]]] = {
    "spring": (SPRING, {}),
    "gradient": (GRADIENT, {"gradient": True}),
    "in time": (IN_TIME, {"by_time": True}),
    "swimmer": (SWIMMER, {"turns": True}),
}
ENTRIES = (2e-5, [1e-7, 0.0, 5e-8], 1e-5 * np.eye(3))
#: Lines that are put in, and conditions under which
LINES = (
    "raise ValueError('boom')", "raise RuntimeError", "wrench.force[i, 0] += np.nan",
    "wrench.force[i, 0] += np.inf - np.inf", "wrench.error[i] += np.nan", "wrench.error[i] -= 1.0",
    "pose.position[i, 0] += 1e-8", "pose.time[i] = 0.0", "centre[0] = 1.0", "centre[1] += 1e-6",
    "wrench.force[i] += undefined", "wrench.force[i, 7] += 1e-12",
    "wrench.force[len(pose.time), 0] += 1e-12",
    "wrench.force_gradient[i, 0, 0] += 1e-6", "wrench.moment[i, 3] += 1e-20",
    "wrench.force[i] += centre[:2]", "wrench.force[i, 0] += number(data, 3)",
    "wrench.force[i, 0] += vector(data, 0)[0]", "wrench.force[i, 0] += tensor(data, 2)[0, 0, 0]",
    "wrench.force[i, 0] += data.numbers[10**7]", "wrench.force[-4, 0] += 1e-12",
    "wrench.force[i, 0] = 1e-12", "wrench.force[i] *= 0.5", "wrench.force[0, 0] += 1e-12",
    "wrench.moment[i, 0] += 1e-20", "wrench.force[i, 0] += pose.orientation[i, 0]",
    "wrench.force[i, 0] += 1e-13 * math.sqrt(-1.0 - abs(pose.time[i]))",
    "wrench.force[i, 0] += 1e-13 * np.random.random()",
    "wrench.force[i, 0] += 1e-10 * pose.time[i]", "assert pose.time[i] < 0.0",
)  # fmt: skip
CONDITIONS = ("True", "True", "pose.time[i] > 3e-4", "pose.position[i, 0] > -0.1e-6")
_READERS = ("number", "vector", "matrix", "tensor")


def mutated(rng: np.random.Generator) -> tuple[str, dict[str, bool]]:
    """Text of a function, changed at one place, and how it is made a force."""
    text, how = KERNELS[rng.choice(list(KERNELS))]
    if rng.random() < 0.4:
        lines = text.rstrip().splitlines()
        first = next(n for n, line in enumerate(lines) if " in range(len" in line)
        condition, line = rng.choice(CONDITIONS), rng.choice(LINES)
        at = rng.choice([first + 1, len(lines)])
        lines.insert(at, f"        if {condition}:\n            {line}")
        return "\n".join(lines) + "\n", how
    tree = ast.parse(text)
    places = [node for node in ast.walk(tree) if _changes(node)]
    node = places[rng.integers(len(places))]
    rng.choice(np.array(_changes(node), dtype=object))(node, rng)
    return ast.unparse(tree) + "\n", how


def _changes(node: ast.AST) -> list[Any]:
    """Return the possible changes of a node."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int):
        return [_another_number]
    if isinstance(node, ast.Name) and node.id in _READERS:
        return [_another_reader]
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        return [_another_name]
    if isinstance(node, ast.AugAssign):
        return [_another_operator]
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "range":
        return [_longer]
    return []


def _another_number(node: Any, rng: np.random.Generator) -> None:
    node.value = int(rng.choice([-4, -1, 0, 1, 2, 3, 4, 5, 1000, 10**9]))


def _another_reader(node: Any, rng: np.random.Generator) -> None:
    node.id = str(rng.choice([each for each in _READERS if each != node.id]))


def _another_name(node: Any, rng: np.random.Generator) -> None:
    node.id = str(rng.choice(["pose", "data", "wrench", "centre", "nothing", "np"]))


def _another_operator(node: Any, rng: np.random.Generator) -> None:
    node.op = rng.choice(np.array([ast.Mult(), ast.Div(), ast.Sub(), ast.Add()], dtype=object))


def _longer(node: Any, rng: np.random.Generator) -> None:
    node.args = [ast.BinOp(node.args[0], ast.Add(), ast.Constant(int(rng.choice([1, 2, 40]))))]


def made(text: str, number: int, **how: bool) -> UserForce:
    """Return the force of a function of that text."""
    name = f"<kernel {number}>"
    linecache.cache[name] = len(text), None, text.splitlines(keepends=True), name
    names: dict[str, Any] = {each: getattr(forces, each) for each in _READERS}
    names |= {"np": np, "math": __import__("math")}
    exec(compile(text, name, "exec"), names)
    return UserForce(kernel(names["own"]), ENTRIES, **how)


def by_python(
    text: str, time: float, position: NDArray[np.float64], orientation: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """Force of the text on one bead, (3,) N, by Python alone. Raises what it raises."""

    def reader(axes: int) -> Any:
        def read(data: Any, entry: int) -> Any:
            if entry < 0 or np.ndim(data[entry]) != axes:
                raise IndexError
            return np.array(data[entry], dtype=np.float64)[()]

        return read

    names: dict[str, Any] = {name: reader(axes) for axes, name in enumerate(_READERS)}
    names |= {"np": np, "math": __import__("math")}
    exec(text, names)
    turned = np.zeros((0, 4)) if orientation is None else orientation[None]
    pose = Pose(np.array([time]), position[None].copy(), turned, np.zeros((0, 3)))
    before = copy.deepcopy(pose)
    none = np.zeros((0, 3, 3))
    wrench = Wrench(np.zeros((1, 3)), np.zeros((1, 3)), none, none, np.zeros(1))
    with np.errstate(all="ignore"):
        names["own"](pose, ENTRIES, wrench)
    assert all(np.array_equal(a, b) for a, b in zip(pose, before, strict=True)), "the pose"
    assert np.isfinite(wrench.force).all(), "the force"
    assert 0 <= wrench.error[0] < np.inf, "the error"
    return wrench.force[0]


def scenes() -> list[tweezer.Scene]:
    """Scenes in which the functions act: followed by steps, and with thermal motion."""
    scene = tweezer.load_scene("silica-1um").replace(
        simulation={
            "model": "overdamped", "method": "dop853", "duration": "1 ms", "samples": 11,
        },
        medium={"inertia": "none"},
    )  # fmt: skip
    return [scene, scene.replace(forces={"brownian": True}, simulation={"method": "auto"})]


def outcome(text: str, how: dict[str, bool], number: int, scene: tweezer.Scene) -> str:
    """Return the outcome of a run with the function. Raises AssertionError for silent errors."""
    try:
        force = made(text, number, **how)
        run = tweezer.simulate(scene, forces=[force])
    except tweezer.TweezerError as error:
        if len(str(error).splitlines()) > 1:
            raise AssertionError(f"several lines: {error}") from None
        return "refused"
    if run.status != "complete":
        assert run.status == "failed", run.status
        assert "own" in run.message, run.message
        return "failed"
    turned = run["orientation"].values if how.get("turns") else [None] * run.sizes["time"]
    own = [
        by_python(text, *each)
        for each in zip(run["time"].values, run["position"].values, turned, strict=True)
    ]
    weight = np.array(tweezer.bead_properties(scene).weight)
    expected = run["optical_force"].values + weight + np.array(own)
    np.testing.assert_allclose(run["net_force"].values, expected, rtol=1e-9, atol=1e-24)
    return "complete, with the force of its text"


def mutated_kernels(count: int, first: int = 0) -> Counter[str]:
    """Run `count` mutated functions, beginning with number `first`, each in its own process."""
    ended: Counter[str] = Counter()
    where = scenes()
    for scene in where:  # loops are compiled before processes are made of this one
        assert outcome(*KERNELS["spring"], 0, scene).startswith("complete")
    for number in range(first, first + count):
        text, how = mutated(np.random.default_rng([6, number]))
        ended[_in_its_own_process(text, how, number, where[number % len(where)])] += 1
    return ended


def _in_its_own_process(text: str, how: dict[str, bool], number: int, scene: tweezer.Scene) -> str:
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        with contextlib.suppress(BaseException):
            os.close(reading)
            warnings.simplefilter("ignore")
            try:
                said = outcome(text, how, number, scene)
            except BaseException as error:
                said = f"WRONG {type(error).__name__}: {error}"
            os.write(writing, json.dumps(said).encode())
            sys.stdout.flush()
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        said = pipe.read()
    _, status = os.waitpid(child, 0)
    assert status == 0, f"kernel {number} ended its process, {status}:\n{text}"
    ended = str(json.loads(said))
    assert not ended.startswith("WRONG"), f"kernel {number}, {how}: {ended}\n{text}"
    return ended
