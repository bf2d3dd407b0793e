"""Moments of a linear feedback loop in closed form, by the sampled theory of linear systems."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from tweezer.dynamics.brownian.feedback import matrices_of
from tweezer.dynamics.layout import TRANSLATION
from tweezer.dynamics.problem import bound_once
from tweezer.dynamics.thermal import Linearised, decide
from tweezer.scene import SceneLike, checked_scene
from tweezer.values.arrays import Array
from tweezer.values.constants import Boltzmann
from tweezer.values.errors import SceneError

if TYPE_CHECKING:
    import xarray as xr

    from tweezer.scene import Scene

#: Number of frequencies of the spectrum
_FREQUENCIES = 200
#: Dimensions of position and velocity
_AXES = 3


class _Loop(NamedTuple):
    """A loop from tick to tick, z -> M z + noise."""

    M: Array
    """(size, size); z is (x, v, c and queue of each axis, output that acts), in units of `scale`"""
    covariance: Array
    """(size, size) covariance of the noise"""
    scale: Array
    """(size,) units of z"""


def loop_moments(
    scene: SceneLike, frequencies: Sequence[float] | Array | None = None
) -> xr.Dataset:
    """Return variances and spectra of a bead with a linear controller, in closed form.

    Near its equilibrium the bead follows m x'' + beta x' + K x = F(u) + noise. The motion from tick
    to tick is exact. The controller holds its output between ticks. The covariance after a tick
    then satisfies a discrete Lyapunov equation. The controller does not enter the equilibrium, and
    `target` shifts means only.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene with `feedback` and thermal motion, of any kind but "parametric".
    frequencies : ndarray or sequence, shape (n,), optional
        Frequencies of the spectra up to half the rate of the controller, Hz.

    Returns
    -------
    xarray.Dataset
        At the ticks: `position_variance` (axis), m^2; `velocity_variance` (axis), (m/s)^2, and
        `temperature` (axis), K, of models with inertia; `output_variance` (axis), N^2 or m^2; and
        `position_spectrum` (axis, frequency), one-sided and aliased by the ticks, m^2/Hz.

    Raises
    ------
    SceneError
        If the loop is not linear or not stable, or if there is no equilibrium.

    References
    ----------
    C. F. Van Loan, IEEE Trans. Automat. Contr. 23, 395 (1978).
    """
    import xarray as xr
    from scipy.linalg import solve_discrete_lyapunov

    scene = checked_scene(scene)
    feedback = scene.feedback
    if feedback is None or feedback.kind == "parametric":
        raise SceneError("feedback: must be given, and of another kind than 'parametric'")
    loop, mass, kT = _loop(scene)
    radius = float(np.abs(np.linalg.eigvals(loop.M)).max())
    if radius >= 1:
        raise SceneError(
            f"feedback: the loop is not stable; a disturbance is multiplied by {radius:.6g} in a "
            "tick; set a smaller gain or a shorter delay, or measure every axis without a trap"
        )
    variances = np.diag(solve_discrete_lyapunov(loop.M, loop.covariance)) * loop.scale**2
    rate = feedback.rate
    if frequencies is None:
        hertz = np.geomspace(1e-4 * rate, rate / 2, _FREQUENCIES)
    else:
        hertz = np.atleast_1d(np.asarray(frequencies, float))
        if hertz.ndim != 1 or not ((hertz > 0) & (hertz <= rate / 2)).all():
            raise SceneError(f"frequencies: must be above 0 and at most rate/2 = {rate / 2:g} Hz")
    spectra = np.stack([_spectrum(loop, each / rate) for each in hertz], axis=1) * 2 / rate
    axes = np.array(["x", "y", "z"])
    acts, unit = loop.M.shape[0] - _AXES, "N^2" if feedback.acts_on == "force" else "m^2"
    dataset = xr.Dataset(
        coords={
            "axis": ("axis", axes, {"long_name": "axis, z along the light"}),
            "frequency": ("frequency", hertz, {"units": "Hz", "long_name": "frequency"}),
        }
    )
    for name, values, units, long_name in (
        ("position_variance", variances[:_AXES], "m^2", "variance of the position at the ticks"),
        ("output_variance", variances[acts:], unit, "variance of the output that acts"),
    ):
        dataset[name] = "axis", values, {"units": units, "long_name": long_name}
    if mass > 0:
        speed = variances[_AXES : 2 * _AXES]
        dataset["velocity_variance"] = "axis", speed, {
            "units": "m^2/s^2", "long_name": "variance of the velocity at the ticks",
        }  # fmt: skip
        dataset["temperature"] = "axis", mass * speed / Boltzmann, {
            "units": "K", "long_name": "temperature of the velocity",
        }  # fmt: skip
    dataset["position_spectrum"] = (
        ("axis", "frequency"),
        spectra[:_AXES] * loop.scale[:_AXES, None] ** 2,
        {"units": "m^2/Hz", "long_name": "one-sided spectrum of the position at the ticks"},
    )
    dataset.attrs = {
        "title": scene.title, "factor_per_tick": radius, "thermal_energy": kT,
        "scene": scene.model_dump_json(exclude_none=True),
    }  # fmt: skip
    return dataset


def _spectrum(loop: _Loop, cycles: float) -> Array:
    """Return the two-sided spectra (size,), per tick, at a frequency in cycles per tick."""
    size = len(loop.M)
    response = np.linalg.inv(np.exp(2j * math.pi * cycles) * np.eye(size) - loop.M)
    found: Array = np.einsum(
        "ij,jk,ik->i", response, loop.covariance, response.conj(), optimize=True
    ).real
    return found


def _loop(scene: Scene) -> tuple[_Loop, float, float]:
    """Return the loop of a scene, the effective mass of the bead (0 without inertia), and kT."""
    from scipy.linalg import block_diag, expm

    feedback = scene.feedback
    assert feedback is not None
    problem, _ = decide(bound_once(scene))
    linear = Linearised.of(problem)
    if linear.modes is not None and len(linear.modes.times) > 1:
        raise SceneError("medium.inertia: must be 'none' or 'added-mass' for a closed form")
    if problem.body is not None or linear.towards is not None:
        raise SceneError("feedback: the closed form requires a sphere without a wall")
    trap = problem.equilibrium
    stiffness = np.zeros((3, 3)) if trap is None else trap.stiffness
    drag = 1 / linear.mobility[TRANSLATION]
    mass = problem.effective_mass if linear.inertial else 0.0
    kT, T = linear.kT, 1 / feedback.rate
    acting = np.eye(3) if feedback.acts_on == "force" else stiffness
    # units: the thermal displacement along the stiffest axis, or that of a tick without a trap
    hold = float(np.linalg.eigvalsh(0.5 * (stiffness + stiffness.T)).max())
    far = math.sqrt(kT / hold) if hold > 0 else math.sqrt(2 * kT * T / drag.min())
    fast = math.sqrt(kT / mass) if mass else 1.0
    push = kT / far if feedback.acts_on == "force" else far
    if mass:
        A = np.block([[np.zeros((3, 3)), np.eye(3)], [-stiffness / mass, -np.diag(drag / mass)]])
        B, Q = np.vstack([np.zeros((3, 3)), acting / mass]), np.zeros((6, 6))
        Q[_AXES:, _AXES:] = np.diag(2 * kT * drag / mass**2)
        own = np.array([far] * 3 + [fast] * 3)
    else:
        A, B = -stiffness / drag[:, None], acting / drag[:, None]
        Q, own = np.diag(2 * kT / drag), np.full(3, far)
    A, B, Q = A * own / own[:, None], B * push / own[:, None], Q / np.outer(own, own)
    n = len(A)
    step = expm(np.block([[A, B], [np.zeros((3, n + 3))]]) * T)
    loan = expm(np.block([[-A, Q], [np.zeros((n, n)), A.T]]) * T)
    moved, pushed, spread = step[:n, :n], step[:n, n:], loan[n:, n:].T @ loan[:n, n:]
    # the controller, in units of `far` for positions and `push` for outputs
    F, G, H, J = matrices_of(feedback, problem.effective_mass)
    size = np.abs(G) * far
    size[size == 0] = far
    F, G, H, J = F * size / size[:, None], G * far / size, H * size / push, J * far / push
    measured = np.diag([float(axis in feedback.measures) for axis in "xyz"])
    late, states = feedback.ticks_late, len(G)
    Fs, Gs = np.kron(measured, F), np.kron(measured, G[:, None])
    Hs, Js = np.kron(measured, H[None]), J * measured
    queue = np.kron(np.eye(late, k=1), np.eye(3))
    # rows: motion, states, queue, acting; y = x after the step + noise
    C = np.hstack([np.eye(3), np.zeros((3, n - 3))])
    whole = block_diag(moved, Fs, queue, np.zeros((3, 3)))
    c, q, u = n, n + 3 * states, n + 3 * states + 3 * late
    whole[:n, u:] = pushed
    whole[c:q, :n], whole[c:q, u:] = Gs @ C @ moved, Gs @ C @ pushed
    out = slice(u - 3, u) if late else slice(u, u + 3)
    direct = Js + Hs @ Gs
    whole[out, :n], whole[out, u:] = direct @ C @ moved, direct @ C @ pushed
    whole[out, c:q] = Hs @ Fs
    if late:
        whole[u:, q : q + _AXES] = np.eye(3)
    into = np.zeros((u + 3, n + 3))
    into[:n, :n] = np.eye(n)
    into[c:q] = Gs @ np.hstack([C, np.eye(3)])
    into[out] = direct @ np.hstack([C, np.eye(3)])
    noise = block_diag(spread, feedback.noise * feedback.rate / far**2 * np.eye(3))
    scale = np.concatenate([own, np.tile(size, 3), np.full(3 * late + 3, push)])
    return _Loop(whole, into @ noise @ into.T, scale), mass, kT
