"""Quantities derived from a trajectory: forces, speeds, Reynolds number and energies."""

from __future__ import annotations

import numpy as np

from tweezer.dynamics import Motion, Problem
from tweezer.dynamics.layout import TRANSLATION
from tweezer.forces.acting import name_of
from tweezer.forces.force import Wrench
from tweezer.forces.own import fault_of
from tweezer.results.run import Variable, variable, with_error
from tweezer.values.arrays import Array


def in_the_light(motion: Motion) -> Array:
    """Return the positions of a bead relative to light that a controller displaces, (n, 3) m."""
    if motion.feedback_position is None:
        return motion.position
    return motion.position - motion.feedback_position


def light_on(problem: Problem, times: Array, motion: Motion) -> Wrench:
    """Return force and torque of the light on a bead in motion at times (n,), s.

    They include a displacement of the light, and a change of its power, by a controller.
    """
    light = problem.light_along(in_the_light(motion), times, motion.orientation)
    if motion.feedback_power is None:
        return light
    strength = np.maximum(1 + motion.feedback_power.sum(axis=1), 0.0)
    return Wrench(*(
        each * strength.reshape(-1, *[1] * (each.ndim - 1)) if len(each) else each for each in light
    ))  # fmt: skip


def derived_quantities(
    problem: Problem, times: Array, motion: Motion, light: Wrench
) -> dict[str, Variable]:
    """Return the variables that follow from a motion, with its optical force.

    * optical_force: force of the light (3.26), N
    * force_error: error of the optical force, N. It is NaN until `force_errors` sets it.
    * net_force: sum of all forces except drag, the thesis's net motion force Gamma_others (4.2), N
    * net_force_error: error of the net force, N, with the user's own forces. `force_errors` sets it
      too.
    * speed: speed of the bead, m/s
    * terminal_speed: |net_force|/beta_v (5.2), with the drag at the position, m/s
    * reynolds_number: 2 rho_m v r/mu_m (5.1)
    * distance: distance from the focus, m
    * kinetic_energy: energy of translation and, if the bead rotates, of rotation, J
    * potential_energy: energy of gravity and buoyancy, zero at the focus, J
    * total_energy: sum of both, J. The force of the light has no potential.
    * gap: distance of the bead's surface from the nearer wall, m, if there is a wall

    Without a velocity there is no speed, Reynolds number, kinetic or total energy.

    Parameters
    ----------
    problem : Problem
        Bead, medium and forces.
    times : ndarray, shape (n,)
        Times, s.
    motion : Motion
        The motion at these times.
    light : Wrench
        Optical force at these times.
    """
    scene, bead, places = problem.scene, problem.bead, motion.position
    weight = np.array(bead.weight)
    net_force = light.force + weight
    for each in problem.beside_the_light:
        pushed = each.field(places, time=times, orientations=motion.orientation)
        net_force += pushed.force
    if motion.feedback_force is not None:
        net_force += motion.feedback_force
    terminal = net_force * problem.mobilities(places, times)[:, TRANSLATION]
    if problem.body is not None and motion.orientation is not None:
        from scipy.spatial.transform import Rotation  # a sphere does without

        turned = Rotation.from_quat(motion.orientation, scalar_first=True)
        own = (
            turned.apply(net_force, inverse=True) @ problem.body.mobility[TRANSLATION, TRANSLATION]
        )
        terminal = turned.apply(own)
    potential = -places @ weight
    unknown = np.full(len(times), np.nan)
    variables = {
        "optical_force": with_error(_vector(light.force, "N", "force of the light"), "force_error"),
        "force_error": _of_force(unknown),
        "net_force": _vector(net_force, "N", "net motion force, all forces but drag"),
        "terminal_speed": _number(_length(terminal), "m/s", "terminal speed"),
        "distance": _number(_length(places), "m", "distance to the focus"),
        "potential_energy": _number(
            potential, "J", "energy of gravity and buoyancy, zero at the focus"
        ),
    }
    if problem.others:
        variables["net_force_error"] = _of_net_force(unknown)
        variables["net_force"] = with_error(variables["net_force"], "net_force_error")
    if scene.wall is not None:
        gap = scene.room(places[:, 2])
        variables["gap"] = _number(gap, "m", "distance of the bead's surface from the wall")
    if motion.velocity is not None:
        speed = _length(motion.velocity)
        kinetic = 0.5 * bead.mass * speed**2
        if motion.angular_velocity is not None:
            if problem.body is None:
                kinetic += 0.5 * motion.angular_velocity**2 @ np.array(bead.moments_of_inertia)
            else:
                momentum = motion.angular_velocity @ np.array(scene.body.inertia)
                kinetic += 0.5 * (momentum * motion.angular_velocity).sum(axis=1)
        medium = scene.medium
        number = 2 * medium.density * scene.body.size / medium.viscosity * speed
        variables |= {
            "speed": _number(speed, "m/s", "speed"),
            "reynolds_number": _number(number, "1", "Reynolds number"),
            "kinetic_energy": _number(kinetic, "J", "kinetic energy"),
            "total_energy": _number(
                kinetic + potential, "J", "energy of motion and weight, without the light"
            ),
        }
    return variables


def fault_at(problem: Problem, times: Array, motion: Motion) -> str:
    """Return the error of the user's own forces at the samples of a motion; "" without an error.

    `times` (n,) are in s.
    """
    for each in problem.others:
        pushed = each.field(motion.position, time=times, orientations=motion.orientation)
        failed = np.flatnonzero(~np.isfinite(pushed.force).all(axis=1))
        if len(failed):
            said = fault_of(each) or f"{name_of(each)}: the force is not finite"
            return f"failed at the sample of {times[failed[0]]:.6g} s: {said}"
    return ""


def force_errors(
    problem: Problem, times: Array, motion: Motion, light: Wrench
) -> dict[str, Variable]:
    """Return the errors of the forces in a motion.

    * force_error: error of the optical force, N. It is estimated, or certified by the force map.
      For the thesis's grid it is the deviation from the quadrature.
    * net_force_error: error of all forces, N, with the user's own forces

    Parameters
    ----------
    problem : Problem
        Bead, medium and forces.
    times : ndarray, shape (n,)
        Times, s.
    motion : Motion
        The motion at these times.
    light : Wrench
        Optical force at these times.
    """
    places = motion.position
    of_light = problem.light.error_of(in_the_light(motion), light, times)
    errors = {"force_error": _of_force(of_light)}
    if problem.others:
        of_all = of_light.copy()
        for each in problem.beside_the_light:
            pushed = each.field(places, time=times, orientations=motion.orientation)
            of_all += each.error_of(places, pushed, times)
        errors["net_force_error"] = _of_net_force(of_all)
    return errors


def _of_force(errors: Array) -> Variable:
    """Return errors of the optical force, (n,) N, as a variable of a run."""
    return _number(errors, "N", "error of the force of the light")


def _of_net_force(errors: Array) -> Variable:
    """Return errors of the net force, (n,) N, as a variable of a run."""
    return _number(errors, "N", "error of the net motion force")


def _vector(values: Array, units: str, long_name: str) -> Variable:
    """Return vectors at the samples, (n, 3), as a variable of a run."""
    return variable(("time", "axis"), values, units, long_name)


def _number(values: Array, units: str, long_name: str) -> Variable:
    """Return numbers at the samples, (n,), as a variable of a run."""
    return variable(("time",), values, units, long_name)


def _length(vectors: Array) -> Array:
    """Return the lengths (n,) of vectors (n, 3)."""
    return np.sqrt((vectors**2).sum(axis=1))
