"""Quantities of a calibration along each axis, from the fit of the power spectrum."""

from tweezer.values.measured import Quantity

QUANTITIES = (
    Quantity("stiffness", "N/m", "stiffness by the power spectrum", "axis"),
    Quantity("corner_frequency", "Hz", "corner frequency by the power spectrum", "axis"),
    Quantity("diffusion", "m^2/s", "diffusion by the power spectrum", "axis"),
)
