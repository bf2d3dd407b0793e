"""The page of a run: the bead moving in the light, with forces and energies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from tweezer.dynamics import Problem, bound_once
from tweezer.dynamics.layout import TRANSLATION
from tweezer.forces.force import Force
from tweezer.optics import drawn_cones, ray_optics_caveat
from tweezer.results.io import scene_of
from tweezer.results.run import Run
from tweezer.runs.resolved import resolved
from tweezer.runs.summary import Summary, summary_of
from tweezer.scene import Scene
from tweezer.scene.heading import heading, of_changes
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import ResultError
from tweezer.values.prefixes import per
from tweezer.viewing.arrays import Packed, float32
from tweezer.viewing.content import Content, Row
from tweezer.viewing.rows import NOT_KNOWN, computed_by, of_number, si
from tweezer.viewing.setting import of_the_picture, scene_facts
from tweezer.viewing.surroundings import of_the_medium

if TYPE_CHECKING:
    import xarray as xr


#: Fraction of the largest force below which the sum of other forces is rounding error
_NOTHING = 1e-9
#: Fewest samples from which an acceleration and its error follow
_FEWEST = 6
#: Variables of a run that its page shows unchanged, with their units
_AS_THEY_ARE = {
    "time": "s", "position": "m", "orientation": "1", "speed": "m/s", "terminal_speed": "m/s",
    "distance": "m", "gap": "m", "angular_velocity": "rad/s",
}  # fmt: skip


def content(dataset: xr.Dataset) -> Content:
    """Return the content of the page of a run. Raises `ResultError` if its scene is not valid."""
    run, scene = Run.of(dataset), scene_of(dataset)
    if not np.isfinite(run["position"]).all():
        raise ResultError("contains samples without a position, which cannot be shown")
    problem = bound_once(scene)
    thermal, close = scene.forces.brownian, resolved(run)
    forces, about_forces = _forces(run, problem)
    energies, about_energies = _energies(run, forces, problem, close=close)
    arrays = {name: float32(run[name], unit) for name, unit in _AS_THEY_ARE.items() if name in run}
    arrays |= {f"force_{name}": float32(values, "N") for name, values in forces.items()}
    arrays |= {f"energy_{name}": float32(values, "kT") for name, values in energies.items()}
    arrays |= moving_light(scene, run["time"])
    status, message = run.attributes["status"], run.attributes["message"]
    summary = summary_of(run)
    return Content(
        kind="run",
        title=heading(scene, run.attributes["title"]),
        facts={
            **scene_facts(scene),
            "thermal": thermal,
            "resolved": close,
            "terminal_speed": not thermal,
            "status": status,
            "subtitle": f"{summary.outcome} after {si(summary.outcome_time, 's')}",
        },
        arrays=arrays,
        summary=_rows(run, problem, summary),
        notes=[
            *of_changes(scene), *_of_the_summary(summary),
            *_of_the_path(run, scene, close=close), *about_forces,
            *about_energies, *of_the_picture(scene), *_origin(run, scene),
        ],
        warning=f"This run {ENDED[status]}: {message}." if status in ENDED else "",
    )  # fmt: skip


#: Words for the states of a run that ended before its duration, by the attribute `status`
ENDED = {"interrupted": "was stopped early", "failed": "failed"}


def moving_light(scene: Scene, times: Array) -> dict[str, Packed]:
    """Return foci, (times, beams, 3) m, and factors of power, (times, beams), for the page.

    The dictionary is empty if light and power do not change with time.
    """
    cones = drawn_cones(scene)
    if all(each.place.steady and each.strength.steady for each in cones):
        return {}
    foci = [[each.at(time) for each in cones] for time in times]
    factors = [[each.strength.at(time)[0] for each in cones] for time in times]
    return {"foci": float32(foci, "m"), "factors": float32(factors, "1")}


def _forces(run: Run, problem: Problem) -> tuple[dict[str, Array], list[str]]:
    """Return the forces on the bead at the samples, (n, 3) N by name, and a note on them.

    Only the steady drag -v/mobility (2.13) is included, with the mobility at each position.
    """
    light, net = run["optical_force"], run["net_force"]
    scene, weight = problem.scene, np.array(problem.bead.weight)
    forces = {"light": light, "weight": np.tile(weight, (len(light), 1))}
    rest = net - light - weight
    largest = max(np.abs(net).max(initial=0.0), np.abs(light).max(initial=0.0))
    if np.abs(rest).max(initial=0.0) > _NOTHING * largest:
        forces["wall" if scene.wall and not run.attributes.get("other_forces") else "others"] = rest
    if scene.forces.brownian:
        forces["sum"] = net
        return forces, [
            "The sum of forces excludes drag and the thermal force of the medium. The thermal "
            "force fluctuates within any sampling interval, so it cannot be drawn."
        ]
    if run.attributes["model"] == "overdamped":
        forces |= {"drag": -net, "sum": np.zeros_like(net)}
        return forces, [
            "This model has no inertia. Drag balances all other forces, so the sum is zero."
        ]
    drag, by = _steady_drag(run, problem)
    forces |= {"drag": drag, "sum": net + drag}
    elastic = scene.medium.viscoelastic
    if (elastic or run.attributes["fluid_inertia"] != "none") and len(run["time"]) >= _FEWEST:
        change = problem.bead.mass * _slope(run["velocity"], run["time"])
        name, what = ("medium", "rest") if elastic else ("fluid", "inertia")
        of_solvent, elements = (" in the solvent", "its elements, ") if elastic else ("", "")
        forces |= {name: change - net - drag, "sum": change}
        error = _error_of_slope(change, run["velocity"], run["time"], problem.bead.mass)
        return forces, [
            f"Drag is the steady drag{of_solvent}, {by}. The {what} of the {name} is its "
            f"remaining force: {elements}added mass and, with memory, the Basset force. The sum is "
            "mass times acceleration of the bead. The acceleration follows from the velocity "
            "differences between samples. If only every second sample is used, mass times "
            "acceleration changes "
            f"by at most {si(error, 'N')}."
        ]
    if run.attributes["model"] == "scaled":
        means = (
            f"mass times acceleration over a2 = {scene.simulation.scaling_factor:g}: the scaled "
            "model divides the mass by it"
        )
    elif run.attributes["model"] == "first-order":
        means = "mass times acceleration of the bead, to the first order of its relaxation time"
    else:
        means = "mass times acceleration of the bead"
    return forces, [f"Drag is the steady drag, {by}. The sum is {means}."]


def _steady_drag(run: Run, problem: Problem) -> tuple[Array, str]:
    """Return the steady drag at the samples, (n, 3) N, and in words how it is computed."""
    velocity = run["velocity"]
    if problem.body is None:
        mobility = problem.mobilities(run["position"], run["time"])[:, TRANSLATION]
        return -velocity / mobility, "minus velocity over mobility"
    turned = Rotation.from_quat(run["orientation"], scalar_first=True)
    twist = np.hstack([turned.apply(velocity, inverse=True), run["angular_velocity"]])
    drag: Array = -turned.apply(twist @ problem.body.resistance[TRANSLATION].T)
    return drag, "minus the resistance of the body times its velocity and angular velocity"


def _slope(values: Array, times: Array) -> Array:
    """Return the derivative over time, (n, 3) in SI, of values (n, 3) at the times (n,), s."""
    return np.asarray(np.gradient(values, times, axis=0, edge_order=2), np.float64)


def _error_of_slope(change: Array, velocity: Array, times: Array, mass: float) -> float:
    """Return the largest difference, N, of mass times acceleration from every second sample.

    change: mass times acceleration by every sample, (n, 3) N.
    """
    coarse = mass * _slope(velocity[::2], times[::2])
    return float(np.abs(coarse - change[::2]).max(initial=0.0))


def _energies(
    run: Run, forces: dict[str, Array], problem: Problem, *, close: bool
) -> tuple[dict[str, Array], list[str]]:
    """Return the energies of the bead, (n,) by name in kT, and notes on them.

    The work of a force is summed by the trapezoidal rule from sample to sample. With every second
    sample its error is four times as large, so a third of the difference estimates it.

    `forces` contains (n, 3) N by name. If not `close`, samples are too far apart to sum the work.
    For a body that is not a sphere, the work of the torques is included.
    """
    scene = problem.scene
    unit = Boltzmann * scene.noise_temperature
    energies = {}
    if "kinetic_energy" in run:
        energies["kinetic"] = run["kinetic_energy"] / unit
    notes = [
        f"Energies are in units of kT = {1e21 * unit:.4g} zJ, at {scene.noise_temperature:.5g} K."
    ]
    if not close:
        notes.append("The work of the light is not shown because the samples are too far apart.")
        return energies, notes
    light = _with_torque(forces["light"], run, problem, problem.light)
    work = _work(light, run, problem) / unit
    halved = _work(light, run, problem, every=2) / unit
    error = float(np.abs(work[::2] - halved).max(initial=0.0)) / 3
    energies["work"] = work
    turning = "" if problem.body is None else "and of its torque over the rotation "
    notes.append(
        f"Work of the light is the integral of its force along the path {turning}since the "
        "release, by the trapezoidal rule from sample to sample. Its error, estimated with half "
        "the samples, is "
        f"{error:.1g} kT. The force of light has no potential in general, so no potential energy "
        "is shown."
    )
    if not scene.forces.brownian and "kinetic" in energies:
        net = sum(values for name, values in forces.items() if name not in ("drag", "sum"))
        every = _work(_with_torque(np.asarray(net), run, problem, problem.force), run, problem)
        if problem.body is None:
            moving = 0.5 * problem.bead.mass * (run["velocity"] ** 2).sum(axis=1)
        else:
            moving = run["kinetic_energy"]
        energies["lost"] = (every - (moving - moving[0])) / unit
        of_motion, torques = (
            ("translational kinetic energy", "")
            if problem.body is None
            else ("kinetic energy", "and torques ")
        )
        notes.append(
            f"The energy given to the medium is the work of all forces {torques}except drag, minus "
            f"the gain of the bead's {of_motion}. It becomes heat and motion of the medium."
        )
    return energies, notes


def _with_torque(force: Array, run: Run, problem: Problem, acting: Force) -> Array:
    """Return a force at the samples, (n, 3) N, for a body with the torque of `acting`, (n, 6)."""
    if problem.body is None:
        return force
    found = acting.field(run["position"], time=run["time"], orientations=run["orientation"])
    return np.hstack([force, found.moment])


def _work(wrench: Array, run: Run, problem: Problem, *, every: int = 1) -> Array:
    """Return the work, J, of a force, or a force and torque, since the first sample.

    `wrench` is (n, 3) N, or (n, 6) in N and N m. Only every so many samples are used.
    """
    wrench = wrench[::every]
    moved = np.diff(run["position"][::every], axis=0)
    if problem.body is not None:
        turned = Rotation.from_quat(run["orientation"][::every], scalar_first=True)
        about = (turned[1:] * turned[:-1].inv()).as_rotvec()
        moved = np.hstack([moved, about.reshape(-1, 3)])
    steps = 0.5 * ((wrench[1:] + wrench[:-1]) * moved).sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _of_the_summary(summary: Summary) -> list[str]:
    """Return a list with a note if the summary was derived from samples alone; else empty."""
    if not summary.by_samples:
        return []
    return [
        "The summary uses the samples only. Its numbers and errors do not include the motion "
        "between samples."
    ]


def _of_the_path(run: Run, scene: Scene, *, close: bool) -> list[str]:
    """Return a list with a note on the sampling interval and on the path drawn between samples.

    If not `close`, samples are too far apart to resolve the motion.
    """
    times = run["time"]
    if len(times) < 2:
        return ["The run has a single sample."]
    apart = si(float(times[1] - times[0]), "s")
    if not close:
        return [
            f"The sampling interval, {apart}, exceeds the relaxation time of the trap. The samples "
            "are drawn as points, and the bead jumps from one to the next, because the path "
            "between them is unknown."
        ]
    if scene.forces.brownian:
        return [
            f"The sampling interval is {apart}. The page connects samples by straight lines; the "
            "actual path of a bead in thermal motion is rougher."
        ]
    return [f"The sampling interval is {apart}. The page connects samples by straight lines."]


def _origin(run: Run, scene: Scene) -> list[str]:
    """Return a list with a note on the versions, and the seed, with which the run was computed."""
    attributes = run.attributes
    drawn = f" Seed {attributes['seed']}." if scene.draws and "seed" in attributes else ""
    return [f"{computed_by(attributes)}{drawn}"]


def _rows(run: Run, problem: Problem, summary: Summary) -> list[Row]:
    """Return the lines of the summary of a run: outcome, errors, models and settings."""
    attributes, scene = run.attributes, problem.scene
    thermal, ended = scene.forces.brownian, attributes["status"] not in ENDED
    seen = thermal or not summary.by_samples
    rows = [
        _row("outcome", f"{summary.outcome}{summary.untold}", trusted=ended and seen),
        _found("at the time", summary.outcome_time, summary.outcome_time_error, "s", seen=seen),
        _row("end (x, y, z)", ", ".join(f"{per('um') * x:z.4f}" for x in summary.end) + " µm"),
    ]
    if summary.smallest_gap is not None:
        error = summary.smallest_gap_error
        rows.append(_found("smallest gap to the wall", summary.smallest_gap, error, "m", seen=seen))
    if not thermal:
        rows += _approach(summary, seen=seen)
    model = attributes["model"]
    if model == "scaled":
        model += f", a₂ = {scene.simulation.scaling_factor:g}"
    share = summary.force_error / summary.largest_force if summary.largest_force > 0 else math.nan
    rows += [
        _row("model, method", f"{model}; {attributes['method']}"),
        _row("inertia of the fluid", attributes["fluid_inertia"]),
        _row("light", f"{scene.theory} ({scene.theory_reason})" if scene.lit else "none"),
        _row("force by", attributes["force_evaluator"], trusted=not ray_optics_caveat(scene)),
        of_number("largest force of the light", summary.largest_force, summary.force_error, "N"),
        _up_to(
            "error of the force", summary.force_error, "N",
            "" if math.isnan(share) else f", {100 * share:.1g} % of the largest",
        ),
    ]  # fmt: skip
    if thermal:
        rows.append(_row("step", si(attributes["step"], "s")))
    else:
        for name, key in (
            ("error of the integration", "integration_error"),
            ("deviation from full inertia", "model_error"),
        ):
            error = attributes[key]
            if error != 0 or key == "integration_error":
                rows.append(_up_to(name, error, "m"))
    if scene.draws:
        rows.append(_row("seed", str(attributes["seed"])))
    rows += [
        *of_the_medium(scene),
        _size(scene),
        _row("weight less buoyancy", si(-problem.bead.weight[2], "N")),
        _row("samples", f"{len(run['time'])}"),
    ]
    return rows


def _size(scene: Scene) -> Row:
    """Return the line of the summary for the size of the bead."""
    if scene.bead.shape == "sphere":
        return _row("radius of the bead", si(scene.bead.radius, "m", 4))
    return _row("body", scene.bead.size_in_words)


def _approach(summary: Summary, *, seen: bool) -> list[Row]:
    """Return the lines on the approach to the focus of a bead without thermal motion.

    If not `seen`, the numbers were derived from samples alone and are marked as not valid.
    """
    rows = []
    if not math.isnan(summary.overshoot):
        overshoot = summary.overshoot, summary.overshoot_error
        rows.append(_found("overshoot past the axis", *overshoot, "m", seen=seen))
    if summary.closest_approach is not None and summary.closest_approach_time is not None:
        rows += [
            _found(
                "first closest approach to the focus",
                summary.closest_approach, summary.closest_approach_error, "m", seen=seen,
            ),
            _found(
                "its time", summary.closest_approach_time, summary.closest_approach_time_error,
                "s", seen=seen,
            ),
        ]  # fmt: skip
    number, error = summary.largest_reynolds_number, summary.largest_reynolds_number_error
    if number is not None:
        rows.append(_found("largest Reynolds number", number, error, seen=seen))
    return rows


def _found(name: str, value: float, error: float | None, unit: str = "", *, seen: bool) -> Row:
    """Return a line of the summary for a number.

    The error has the same unit, and is None if it is not known. `seen` is whether the number is
    valid.
    """
    return of_number(name, value, math.nan if error is None else error, unit, trusted=seen)


def _up_to(name: str, error: float, unit: str, more: str = "") -> Row:
    """Return a line of the summary for an error bound; "not known" if it is not finite.

    `more` is text that follows the bound.
    """
    if not math.isfinite(error):
        return _row(name, NOT_KNOWN, trusted=False)
    return _row(name, f"up to {si(error, unit, 1)}{more}")


def _row(name: str, value: str, *, trusted: bool = True) -> Row:
    """Return a line of the summary for a value without an error."""
    return Row(name, value, "", trusted)
