r"""Temperatures of the medium and of the bead in the light of a scene, and hot Brownian motion.

A liquid that absorbs a part of the light is warmest at the focus. Light of the power P makes it
warmer than a plane glass at the distance h by a P/(2 pi kappa) ln(2 pi h/lambda). Here a is the
absorption coefficient and kappa the thermal conductivity (Peterman, Gittes and Schmidt, 2003). A
sphere that absorbs the power P_abs is warmer than the liquid by P_abs/(4 pi kappa r).

The liquid about a hot sphere has the temperature T(x) = T + dT r/x. The drag is the least
dissipation of all flows without sources that follow the sphere, in the viscosity mu(T(x)). The
thermal motion has the mean temperature over this dissipation (Rings et al., 2010). With the
equations of `derivation.heat`, the drag over 6 pi r is the minimum over the flows g(u) of

.. math::

    \int_0^1 \mu\left(T + u\,\Delta T\right)
    \left[\tfrac{2}{3} g'^2 + \tfrac{1}{9} u^2 g''^2\right] du, \quad g(1) = 1,\ g'(1) = g(0) = 0.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np
from numpy.polynomial import Polynomial, legendre

from tweezer.generated import heat as emitted
from tweezer.optics.at_rest import at_rest
from tweezer.optics.beam import cone
from tweezer.optics.binding import light_force
from tweezer.scene import Scene, SceneLike, checked_scene
from tweezer.scene.heating import (
    check_temperature,
    distances_of_glass,
    heats_bead,
    heats_medium,
    medium_at,
    water_absorption,
)
from tweezer.scene.media import GASES, MEDIA, SODIUM
from tweezer.scene.temperatures import Heating
from tweezer.values.arrays import Array
from tweezer.values.errors import SceneError

#: Relative error of an absorbed power, and of a given temperature rise per power
ABSORPTION_ERROR = 0.1
#: Number of flows that are added to Stokes's, and of nodes of the integral over u
_FLOWS, _NODES = 16, 48
#: Step of the derivative of the viscosity, K
_STEP = 0.5


def heated(scene: SceneLike) -> Scene:
    """Return a scene whose medium, drag and thermal motion have the temperatures of its light.

    A scene without heat is returned unchanged. The bead absorbs the light at
    its equilibrium, in the medium at its new temperature.

    Parameters
    ----------
    scene : Scene, str or mapping
        Scene, with or without heat.

    Raises
    ------
    SceneError
        If the light heats the medium beyond its known range, or an absorbing bead is not trapped.
    """
    scene = checked_scene(scene)
    if scene.heat is None or scene.heat.found is not None:
        return scene
    return scene.heated(_heating(scene))


@functools.lru_cache(maxsize=64)
def _heating(scene: Scene) -> Heating:
    """Return the temperatures in the light of a scene with heat, and their effect on the motion."""
    assert scene.heat is not None
    power = sum(cone(scene.with_one_beam(beam)).power for beam in scene.beams) if scene.lit else 0.0
    water = _rise_of_medium(scene, power)
    found = Heating(water=water, water_error=ABSORPTION_ERROR * water)
    temperature = scene.medium.temperature + water
    medium = medium_at(scene, temperature).model_copy(update={"temperature": temperature})
    cold = scene.model_copy(update={"medium": medium, "heat": None})
    rise, error = 0.0, 0.0
    if heats_bead(scene):
        rise, error = _rise_of_bead(scene, cold, power)
    if scene.medium.name in GASES:
        return _in_gas(scene, found, rise, error)
    return _in_liquid(scene, found, rise, error)


def _rise_of_medium(scene: Scene, power: float) -> float:
    """Return the temperature rise of the medium at the focus, K, by light of a power, W."""
    heat = scene.heat
    assert heat is not None
    if not heats_medium(scene):
        return 0.0
    if heat.light is not True:
        return heat.light * power
    wavelength = scene.beam.wavelength
    absorption = heat.absorption
    if absorption is None:
        absorption = water_absorption(wavelength)
    distance = effective_distance(*distances_of_glass(scene))
    rise: float = emitted.water_rise(
        power, absorption, _conductivity(scene, scene.medium.temperature), wavelength, distance
    )
    return rise


def effective_distance(first: float, second: float | None = None) -> float:
    r"""Return the distance, m, from a single glass at which light heats the focus as much as here.

    Two glasses at the distances h and H - h have the effect of one at the distance d. The sum over
    all images of a line of sources gives

    .. math::

        d = 2 H \frac{\Gamma(1 - h/2H)\,\Gamma(1/2 + h/2H)}{\Gamma(h/2H)\,\Gamma(1/2 - h/2H)}.

    Parameters
    ----------
    first, second : float
        Distances of the focus from one or two parallel glasses, m.
    """
    if second is None:
        return first
    x, y = (each / (2 * (first + second)) for each in (first, second))
    ratio = math.gamma(1 - x) * math.gamma(1 - y) / (math.gamma(x) * math.gamma(y))
    return 2 * (first + second) * ratio


def _conductivity(scene: Scene, temperature: float) -> float:
    """Return the thermal conductivity of the liquid of a scene at a temperature, W/(m K)."""
    assert scene.heat is not None
    if scene.heat.conductivity is not None:
        return scene.heat.conductivity
    conductivity: float = emitted.conductivity(temperature)
    return conductivity


def _rise_of_bead(scene: Scene, cold: Scene, power: float) -> tuple[float, float]:
    """Return the temperature of the bead's surface above the medium, K, and its relative error.

    Walls take the heat of images of the bead. Two errors are included: the change of the
    conductivity near the bead, and images of these images.

    Parameters
    ----------
    scene : Scene
        Scene with heat.
    cold : Scene
        The scene without heat, whose medium has the temperature about the bead.
    power : float
        Power of the light, W.
    """
    heat, temperature = scene.heat, cold.medium.temperature
    assert heat is not None
    if heat.bead is not True:
        return heat.bead * power, ABSORPTION_ERROR
    place = at_rest(cold)
    if place is None:
        raise SceneError(
            "heat.bead = true: the light holds the bead at no position near the focus, so that its "
            'absorbed power is not constant; give the temperature rise, such as "1000 K/W"'
        )
    position = np.array([place.position])
    absorbed = float(light_force(cold).absorbed_power(position)[0])
    radius, conductivity = scene.bead.radius, _conductivity(scene, temperature)
    planes = scene.wall.planes if scene.wall else ()
    images = sum(radius / (2 * abs(position[0, 2] - z)) for z, _ in planes)
    rise = emitted.bead_rise(absorbed, conductivity, radius) * (1 - images)
    check_temperature(scene.medium.name or "", temperature + rise)
    bending = abs(_conductivity(scene, temperature + rise) / conductivity - 1) / 2
    return rise, math.hypot(ABSORPTION_ERROR, bending, images**2)


def _in_liquid(scene: Scene, found: Heating, rise: float, error: float) -> Heating:
    """Return the temperatures and the drag of a bead in a liquid.

    Parameters
    ----------
    scene : Scene
        Scene with heat.
    found : Heating
        Temperature of the medium.
    rise : float
        Temperature of the bead above the medium, K.
    error : float
        Relative error of `rise`.
    """
    temperature = scene.medium.temperature + found.water
    fluid = MEDIA[scene.medium.name or ""]
    check_temperature(fluid.name, temperature + rise)
    part = getattr(scene.medium, fluid.part) if fluid.part else 0.0

    def viscosity(at: float) -> float:
        """Return the viscosity at a temperature, K."""
        return fluid.at(at, part, SODIUM).viscosity

    drag, rotational_drag, noise = hot_motion(viscosity, temperature, rise)
    middle = temperature + 5 / 12 * rise - _STEP
    slope = math.log(viscosity(middle + _STEP) / viscosity(middle)) / _STEP
    return Heating(
        water=found.water, water_error=found.water_error, bead=rise, bead_error=error * rise,
        noise=noise, noise_error=error * noise, drag=drag, rotational_drag=rotational_drag,
        drag_error=abs(slope) * math.hypot(found.water_error, 5 / 12 * error * rise),
    )  # fmt: skip


def _in_gas(scene: Scene, found: Heating, rise: float, error: float) -> Heating:
    """Return the temperatures and the drag of a bead among free molecules; see `_in_liquid`.

    At a finite Knudsen number Kn, the changes by the heat have a further relative error of 1/Kn.
    """
    temperature, accommodation = scene.medium.temperature, scene.medium.accommodation or 1.0
    warm = temperature + found.water
    drag, moving = emitted.hot_in_gas(accommodation, warm, warm + rise)
    error = math.hypot(error, 1 / scene.knudsen) if rise else 0.0
    return Heating(
        water=found.water, water_error=found.water_error, bead=rise, bead_error=error * rise,
        noise=moving - warm, noise_error=error * (moving - warm), drag=drag,
        drag_error=error * (drag - 1),
    )  # fmt: skip


def hot_motion(
    viscosity: Callable[[float], float], temperature: float, rise: float
) -> tuple[float, float, float]:
    """Return the drags of a hot sphere over those of a cold one, and the excess of its temperature.

    Parameters
    ----------
    viscosity : callable
        Viscosity of the liquid at a temperature, K.
    temperature : float
        Temperature far away, K.
    rise : float
        Temperature of the surface above it, K.

    Returns
    -------
    drag, rotational_drag : float
        Drags over those at `temperature`.
    noise : float
        Temperature of the translational thermal motion above `temperature`, K.
    """
    if rise == 0.0:
        return 1.0, 1.0, 0.0
    u, weights, slopes, curvatures = _flows()
    mu = np.array([viscosity(temperature + rise * each) for each in u]) / viscosity(temperature)
    pairs = emitted.dissipation(
        u, slopes[:, None], slopes[None], curvatures[:, None], curvatures[None]
    )
    matrix = pairs @ (weights * mu)
    flow = np.concatenate([[1.0], -np.linalg.solve(matrix[1:, 1:], matrix[1:, 0])])
    dissipated = np.einsum("i,ijk,j->k", flow, pairs, flow) * weights * mu
    rotational = 1 / float(3 * (weights * u**2 / mu).sum())
    drag = float(dissipated.sum())
    return drag, rotational, rise * float((dissipated * u).sum()) / drag


@functools.cache
def _flows() -> tuple[Array, Array, Array, Array]:
    """Return nodes u and weights (n,) of the integral over u, and derivatives of flows at them.

    The derivatives dg/du and d^2g/du^2 have the shape (flows, n). The first flow is Stokes's. The
    others are at rest on the sphere: u (1 - u)^2 times Legendre polynomials.
    """
    nodes, weights = legendre.leggauss(_NODES)
    u, x, still = (nodes + 1) / 2, Polynomial([-1, 2]), Polynomial([0, 1, -2, 1])
    added = (still * legendre.Legendre.basis(k).convert(kind=Polynomial)(x) for k in range(_FLOWS))
    flows = [Polynomial([0, 1.5, 0, -0.5]), *added]
    slopes, curvatures = (np.array([each.deriv(order)(u) for each in flows]) for order in (1, 2))
    return u, weights / 2, slopes, curvatures
