r"""Heating by the laser: water about the focus, a bead, and the Brownian motion of a hot bead.

Water absorbs a P dz of the power P in a length dz of the beam. On the axis this is a line of
sources, whose images in a plane glass (held at the temperature of the room) are sinks. A bead that
absorbs the power P has the temperature P/(4 pi kappa r) above that of the fluid far away.

The fluid about a hot bead has the temperature T + dT u, with u = r/x at the distance x from the
centre. A sphere that moves with the speed 1 drives a flow without sources,

    v_x = g cos(theta), v_theta = -(g + x g'/2) sin(theta),

which dissipates 6 pi r times the integral of mu [2/3 (dg/du)^2 + u^2/9 (d^2g/du^2)^2] over u from 0
to 1. The creeping sphere drives the flow of least dissipation, which is the drag.
The effective temperature of the motion is the mean temperature over this dissipation.

References
----------
E. J. G. Peterman, F. Gittes and C. F. Schmidt, Biophys. J. 84, 1308 (2003): water.
D. Rings et al., Phys. Rev. Lett. 105, 090604 (2010): hot Brownian motion.
IAPWS SR6-08(2011), equation (8): thermal conductivity of water.
J. Millen et al., Nat. Nanotech. 9, 425 (2014): a hot bead in a rarefied gas. They assign a
temperature of its own to the noise of the arriving and of the leaving molecules. Here the noise
follows from the momenta of the molecules, of which a part `a` leaves diffusely with the bead's
temperature.
"""

from __future__ import annotations

import sympy as sp

from . import symbols as sy
from .equations import Equation

T, T_s = sy.TEMPERATURE.symbol, sy.SURFACE_TEMPERATURE.symbol
P, kappa, absorption = sy.LIGHT_POWER.symbol, sy.CONDUCTIVITY.symbol, sy.ABSORPTION.symbol
wavelength, r, depth = sy.WAVELENGTH.symbol, sy.RADIUS.symbol, sy.SINK_DISTANCE.symbol
u, a = sy.NEARNESS.symbol, sy.ACCOMMODATION.symbol
log_T = sy.LOG_TEMPERATURE.symbol

#: coefficients in W/(m K) and powers of T/300 K
_CONDUCTIVITY = (("1.6630", "-1.15"), ("-1.7781", "-3.4"), ("1.1567", "-6"), ("-0.432115", "-7.6"))
conductivity = sum(
    sp.Float(factor) * sp.exp(sp.Rational(power) * log_T) for factor, power in _CONDUCTIVITY
)

# --- sources ------------------------------------------------------------------------------------
#: shortest distance from the focus at which light heats the water as a cone
waist = wavelength / (2 * sp.pi)
#: temperature that a line of sources of 1 W/m on the axis adds at a unit distance
_of_source = absorption * P / (4 * sp.pi * kappa)
z = sp.Symbol("z", positive=True)


def beside_plane() -> sp.Expr:
    """Return the temperature at the focus, at `depth` from a plane at the temperature of the room.

    Every source at the height z above the focus, or z below it, has a sink at its mirror image.
    """
    above = sp.integrate(1 / z - 1 / (2 * depth + z), z)
    below = sp.integrate(1 / z - 1 / (2 * depth - z), (z, waist, depth))
    return _of_source * (sp.limit(above, z, sp.oo) - above.subs(z, waist) + below)


def within_sphere(radius: sp.Expr) -> sp.Expr:
    """Return the temperature at the centre of a sphere whose surface has the room's temperature.

    Two cones bring the heat 2 a P dz to each shell.
    """
    return _of_source * 2 * sp.integrate(1 / z - 1 / radius, (z, waist, radius))


water_rise = absorption * P / (2 * sp.pi * kappa) * sp.log(depth / waist)
bead_rise = P / (4 * sp.pi * kappa * r)

# --- hot Brownian motion in a liquid --------------------------------------------------------------
slope, other_slope = (each.symbol for each in sy.FLOW_SLOPES)
curvature, other_curvature = (each.symbol for each in sy.FLOW_CURVATURES)
#: dissipation of two flows per viscosity and 6 pi r, by their derivatives dg/du and d^2g/du^2
dissipation = (
    sp.Rational(2, 3) * slope * other_slope
    + u**2 / 9 * curvature * other_curvature
)  # fmt: skip
#: Stokes's flow
STOKES = sp.Rational(3, 2) * u - u**3 / 2


def dissipated(flow: sp.Expr, weight: sp.Expr) -> sp.Expr:
    """Return the integral of `weight` over the dissipation of a flow g(u)."""
    first, second = sp.diff(flow, u), sp.diff(flow, u, 2)
    values = {
        slope: first, other_slope: first, curvature: second, other_curvature: second
    }  # fmt: skip
    return sp.integrate(sp.expand(weight * dissipation.subs(values)), (u, 0, 1))


# --- a hot bead among free molecules --------------------------------------------------------------
#: drag and momentum noise by molecules that leave with the temperature of the bead, over those of
#: the molecules that arrive, for a bead as warm as the gas
_hot = sp.pi / 8 * sp.sqrt(T_s / T)
#: drag over that of a bead as warm as the gas
hot_drag = (1 + a * _hot) / (1 + a * sp.pi / 8)
#: temperature of the motion
hot_temperature = ((1 - a) * T + a * (T + T_s) / 2 + a * _hot * T) / (1 + a * _hot)

WATER = Equation("-", "temperature rise of water at the focus", r"\Delta T", water_rise)
BEAD = Equation("-", "temperature rise of an absorbing sphere", r"\Delta T", bead_rise)
HOT_DRAG = Equation("-", "drag of a hot sphere among free molecules", r"\beta/\beta_0", hot_drag)
HOT_TEMPERATURE = Equation("-", "temperature of its motion", r"T_{cm}", hot_temperature)
