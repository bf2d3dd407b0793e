"""Choice of model and method for a scene that does not set them, from stiffness and tolerance."""

from __future__ import annotations

import numpy as np

from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.models import EquationsOfMotion, bind
from tweezer.dynamics.needs import DETERMINISTIC, Facts, with_inertia_of_the_fluid, without_memory
from tweezer.dynamics.problem import Problem, bound_once
from tweezer.fluid import enough_poles, left_out_of_walls
from tweezer.scene import FREE, Scene
from tweezer.values.arrays import Array

#: Relative tolerance below which a method of order 8 is the cheaper one
_TIGHT = 1e-9
#: Longest stable step of an explicit method of order 8, in relaxation times
_STABLE = 3.0
#: Number of steps above which a stiff solver is cheaper than an explicit method
_STIFF = 3_000


def chosen(scene: Scene) -> tuple[Scene, str]:
    """Return a scene with a model, a method and fluid inertia, and the reasons.

    `tweezer.simulate` makes the same choices.

    Parameters
    ----------
    scene : Scene
        Scene, which need not set them.

    Returns
    -------
    tuple of Scene and str
        The scene with all three set, and the reasons in words.

    Examples
    --------
    >>> scene, why = tweezer.chosen(tweezer.load_scene("silica-1um"))
    >>> scene.simulation.model
    'full'
    """
    problem, why = decided(bound_once(scene))
    return problem.scene, why


def decided(problem: Problem) -> tuple[Problem, str]:
    """Return a problem with a model, a method and fluid inertia, and the reasons for them.

    Values that the scene sets are kept. The relaxation time of the velocity is tau, and the fastest
    rate of the trap is k/beta_v. Without inertia a bead of radius r is displaced by about r tau
    k/beta_v, and in the first-order model by r (tau k/beta_v)^2. The exponential method integrates
    the unscaled equations at the cost of those without inertia, so the first-order model is chosen
    only for bodies that this method cannot integrate. Without fluid inertia the bead is displaced
    by its lag (`Scene.lag`), which is larger. Fluid inertia is therefore part of the model `full`
    if the exponential method integrates it.

    Raises `SceneError` if the scene sets `memory` and it cannot be integrated.
    """
    reasons = []
    if problem.scene.simulation.model is None:
        model, reason = _model(problem)
        problem = problem.decided(simulation={"model": model})
        reasons.append(reason)
    if problem.scene.medium.inertia in (None, "memory"):
        problem, reason = with_inertia_of_the_fluid(problem, _memory)
        reasons.append(reason)
    if problem.scene.simulation.method == "auto":
        method, reason = method_for(bind(problem))
        problem = problem.decided(simulation={"method": method})
        reasons.append(reason)
    return problem, "; ".join(reasons)


def _memory(problem: Problem) -> tuple[int, str]:
    """Return the number of poles of the memory whose error is within the tolerance, and
    the reason.
    """
    scene = problem.scene
    way = scene.lag * problem.fastest
    poles = scene.medium.poles or enough_poles(way, scene.simulation.position_tolerance)
    without = f"without it the bead would be off by up to {way:.1g} m"
    return poles, f"memory of {poles} poles: {without}{_without_wall(scene)}"


def _without_wall(scene: Scene) -> str:
    """Return a clause about the wall's drag, which a fluid with memory ignores; empty without a
    wall.
    """
    if scene.wall is None:
        return ""
    along, across = 100 * left_out_of_walls(scene, np.array([scene.start_position]))[0]
    return (
        f"; the wall is left out, by which the bead would be slower by {along:.2g} % along it and "
        f"{across:.2g} % across, at the start; nearer to it than {FREE:g} radii it is lost"
    )


def _model(problem: Problem) -> tuple[str, str]:
    """Return the cheapest model whose error is within the tolerance, and the reason."""
    scene, tau = problem.scene, problem.relaxation_time
    simulation, inertia = scene.simulation, scene.medium.inertia
    small = tau * float(rates_of_force(problem).max())
    start = np.array([scene.start_position])
    slow = problem.net_force(start)[0] * problem.mobility[TRANSLATION]
    off = scene.body.size * small
    off += tau * float(np.linalg.norm(np.array(scene.start.velocity) - slow))
    if scene.medium.power_law is not None and inertia in (None, "none"):
        return "overdamped", "overdamped: the elements of a power law are followed without inertia"
    if inertia in ("added-mass", "memory"):
        return "full", f"full: has the inertia of the fluid, {inertia}"
    if inertia is None and not without_memory(problem, DETERMINISTIC):
        off += scene.lag * problem.fastest
    allowed = simulation.position_tolerance
    exactly = Facts(problem).has("exact_drag")
    if off <= allowed and not problem.rotates and not exactly:
        return "overdamped", f"overdamped: inertia moves the bead by about {off:.1g} m"
    if exactly or problem.changed(model="full").takes_drag_exactly:
        return "full", f"full: without inertia the bead would be off by about {off:.1g} m"
    if problem.drag.uniform and off * small <= allowed:
        return "first-order", f"first-order: off by about {off * small:.1g} m"
    return "full", f"full: the first-order model would be off by about {off * small:.1g} m"


def method_for(equations: EquationsOfMotion) -> tuple[str, str]:
    """Return the method that suits the equations, and the reason."""
    simulation = equations.scene.simulation
    if equations.takes_drag_exactly:
        return "exponential", "exponential: takes the drag exactly"
    if not equations.inertial:
        if simulation.relative_tolerance < _TIGHT:
            return "dop853", "dop853: not stiff, tight tolerance"
        return "dormand-prince", "dormand-prince: not stiff"
    if simulation.step is not None:
        return "dop853", "dop853: of the compiled methods, for a fixed step"
    steps = simulation.duration / (_STABLE * equations.fastest_relaxation)
    if steps < _STIFF:
        return "dop853", f"dop853: about {max(steps, 1):.0f} relaxation times at most"
    return "scipy:LSODA", f"scipy:LSODA: stiff, {steps:.1g} steps for an explicit method"


def rates_of_force(problem: Problem) -> Array:
    """Return |dF/dx| times the largest mobility at positions about the foci and at the start, (n,)
    1/s.

    For forces that change in time it is evaluated at several times, and the largest result is
    returned.
    """

    def sizes(time: float) -> Array:
        """Return the rates at a time, s, (n,) 1/s."""
        places = problem.places_about(time)
        gradient = problem.field(places, gradient=True, time=time).force_gradient
        mobility = problem.mobilities(places)[:, TRANSLATION].max(axis=1)
        found: Array = np.linalg.norm(gradient, ord=2, axis=(1, 2)) * mobility
        return found

    return max(map(sizes, problem.times_looked_at()), key=lambda each: float(np.median(each)))
