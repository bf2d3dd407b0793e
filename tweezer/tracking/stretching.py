"""Stretching of a molecule between two beads: an experiment, simulated or recorded.

One trap holds a bead, and the other one pulls the second bead away. The molecule between them
stretches. Its tension is the force of the light on the bead that is held, along the line between
the beads. Its extension is the distance of the surfaces. Both are averaged over windows of time.

The extension changes within a window, by the ramp and by fluctuations. The mean of a curved law
F(x) exceeds F(<x>) by F'' <dx^2>/2, which is subtracted. F'' is the curvature of the law that fits
the means.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tweezer.beads.motion import run_of
from tweezer.forces.chains import Chain, chain
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.arguments import check_thermal
from tweezer.tracking.chain_fit import ChainFit, fit_chain
from tweezer.tracking.curve_file import read_curve
from tweezer.values.arrays import Array
from tweezer.values.errors import ResultError, SceneError

if TYPE_CHECKING:
    from tweezer.results.run import Run
    from tweezer.scene.sections import Tether

#: Number of windows, and smallest number of samples of each
WINDOWS, _FEWEST = 40, 20
#: Lags over which the correlation of a window is summed, in parts of the window
_LAGS = 0.2
#: Rounds of fit and correction
_ROUNDS = 2


@dataclass(frozen=True, eq=False)
class Stretched:
    """Force-extension curve of a molecule between two beads, with the fit of its law."""

    extension: Array
    """(windows,) mean distance of the surfaces, m"""
    extension_error: Array
    """standard errors of `extension`, m"""
    force: Array
    """(windows,) mean tension, corrected for the curvature of the law, N"""
    force_error: Array
    """standard errors of `force`, N"""
    width: Array
    """(windows,) standard deviation of the distance about its course, m"""
    fit: ChainFit
    """contour length and persistence length with intervals"""
    run: Run | None
    """the simulated motion; None for a recording"""


def stretch(
    scene: SceneLike,
    seed: int = 0,
    windows: int = WINDOWS,
    *,
    recording: str | Path | None = None,
) -> Stretched:
    """Simulate the stretching of a molecule between two beads, and fit its law to the result.

    With a recording, its extensions and forces take the place of the simulated ones.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene of two beads with thermal motion, a chain between them, and a moving beam.
    seed : int, optional
        Seed of the thermal motion.
    windows : int, optional
        Number of windows of time over which force and extension are averaged.
    recording : str or Path, optional
        Text file with the columns "extension" and "force" of an experiment, with units in their
        headings, at equal intervals of time and without gaps. The extension is the distance
        between the ends of the molecule. The scene then gives the law, its stretch modulus and
        the temperature.

    Returns
    -------
    Stretched
        The force-extension curve with errors, and the fit.

    Raises
    ------
    SceneError
        For a scene without two beads, a chain between them and a moving beam, and for windows with
        too few samples.
    ResultError
        If the run does not determine the parameters of the chain, or did not reach its end.

    Notes
    -----
    Windows without tension, in which the molecule is slack, are left out.
    """
    scene = checked_scene(scene, several=True)
    tether = _molecule(scene)
    if recording is not None:
        extension, force = read_curve(recording)
        _check_windows(windows, len(extension))
        return _evaluated(scene, tether, extension, force, windows, None)
    if not scene.light_moves:
        raise SceneError("beam.motion: stretching requires a beam that moves, such as a ramp")
    check_thermal(scene, seed)
    _check_windows(windows, scene.simulation.samples)
    run = run_of(scene, seed)
    if run.attributes["status"] != "complete":
        raise ResultError(f"{scene.name}: {run.attributes['message']}")
    return _evaluated(scene, tether, run["gap"][:, 0], _tension(scene, run), windows, run)


def _check_windows(windows: int, samples: int) -> None:
    """Raise `SceneError` if there are too few windows, or too few samples in each of them."""
    if not 5 <= windows <= samples // _FEWEST:
        raise SceneError(
            f"windows = {windows}: allowed: from 5 to {samples // _FEWEST}, so that each has "
            f"{_FEWEST} samples"
        )


def _evaluated(
    scene: Scene, tether: Tether, extension: Array, force: Array, windows: int, run: Run | None
) -> Stretched:
    """Return the averages of extension and force over windows, with the fit of the law."""
    means = np.array([
        _window(extension[part], force[part])
        for part in np.array_split(np.arange(len(extension)), windows)
    ])  # fmt: skip
    taut = means[:, 2] > 3 * means[:, 3]
    if taut.sum() < 5:
        raise SceneError(
            f"{scene.name}: the molecule has tension in only {taut.sum()} of {windows} windows; "
            "move the beam farther"
        )
    x, x_error, f, f_error, width, spread, correlation = means[taut].T
    given = {
        "model": tether.model, "temperature": scene.medium.temperature,
        "extension_error": x_error, "force_error": f_error, "correlation": correlation,
        "stretch_modulus": tether.stretch_modulus,
    }  # fmt: skip
    corrected = f
    fit = fit_chain(x, f, **given)
    for _ in range(_ROUNDS):
        corrected = f - 0.5 * _curvature(fit, tether, scene, x, spread) * spread**2
        fit = fit_chain(x, corrected, **given)
    return Stretched(x, x_error, corrected, f_error, width, fit, run)


def _molecule(scene: Scene) -> Tether:
    """Return the only tether of a scene; refuse a scene that is no stretching experiment."""
    if len(scene.beads) != 2:
        raise SceneError(f"bead: stretching requires two beads; the scene has {len(scene.beads)}")
    if len(scene.tether) != 1 or scene.tether[0].model == "spring" or scene.tether[0].point:
        raise SceneError("tether: stretching requires one chain between the two beads")
    if scene.forces.between is not None:
        raise SceneError("forces.between: acts beside the molecule; remove it")
    return scene.tether[0]


def _tension(scene: Scene, run: Run) -> Array:
    """Return the force of the light on the bead that is held, against the other bead, N."""
    moving = next(k for k, beam in enumerate(scene.beams) if beam.motion is not None)
    foci = np.array([beam.position for beam in scene.beams])
    starts = np.array([bead.start for bead in scene.beads])
    pulled = int(np.argmin(np.linalg.norm(starts - foci[moving], axis=1)))
    x, held = run["position"], 1 - pulled
    along = x[:, pulled] - x[:, held]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    force: Array = -np.einsum("ti,ti->t", run["optical_force"][:, held], along)
    return force


def _window(x: Array, f: Array) -> tuple[float, ...]:
    """Return mean and error of extension and force, two widths, and the correlation of the errors.

    The first width is the standard deviation about a straight line, the course of the ramp, and the
    second one about the mean.
    """
    both = np.stack([x, f])
    t = np.linspace(-1, 1, len(x))
    apart = both - both.mean(axis=1, keepdims=True) - np.outer(both @ t / (t @ t), t)
    count = max(1, int(_LAGS * len(x)))
    covariance = apart @ apart.T / (len(x) - 2)
    total = covariance.copy()
    for lag in range(1, count):
        product = apart[:, lag:] @ apart[:, : len(x) - lag].T / len(x)
        if product[0, 0] < 0.05 * covariance[0, 0]:
            break
        total += product + product.T
    errors = np.sqrt(np.diag(total) / len(x))
    correlation = float(total[0, 1] / np.sqrt(total[0, 0] * total[1, 1]))
    mean = both.mean(axis=1)
    return (
        float(mean[0]), float(errors[0]), float(mean[1]), float(errors[1]),
        float(np.sqrt(covariance[0, 0])), float(x.std()), min(max(correlation, -0.999), 0.999),
    )  # fmt: skip


def _curvature(fit: ChainFit, tether: Tether, scene: Scene, x: Array, spread: Array) -> Array:
    """Return the second derivative of the fitted law at extensions (n,), m, N/m^2.

    It is taken over the spread of the extension, which the law may not allow at its end.
    """
    law: Chain = chain(
        tether.model, contour_length=fit.contour_length,
        persistence_length=fit.persistence_length, temperature=scene.medium.temperature,
        stretch_modulus=tether.stretch_modulus,
    )  # fmt: skip
    step = np.minimum(spread, 0.5 * np.minimum(x, law.extensions[1] - x))
    forces = [law.force(x + sign * step)[0] for sign in (-1, 0, 1)]
    found: Array = (forces[0] - 2 * forces[1] + forces[2]) / step**2
    return found
