"""Quantities of calibrations, with their units and descriptions."""

from tweezer.values.measured import STANDARD, Quantity

STIFFNESS = Quantity("stiffness", "N/m", "stiffness by the power spectrum", "axis", STANDARD)
CORNER = Quantity(
    "corner_frequency", "Hz", "corner frequency by the power spectrum", "axis", STANDARD
)
DIFFUSION = Quantity("diffusion", "m^2/s", "diffusion by the power spectrum", "axis", STANDARD)
#: Quantities of a calibration that a sweep stores as variables
QUANTITIES = (STIFFNESS, CORNER, DIFFUSION)

DRAG = Quantity("drag", "kg/s", "drag", kind=STANDARD)
SENSITIVITY = Quantity("sensitivity", "m/V", "displacement sensitivity", kind=STANDARD)
FORCE_SENSITIVITY = Quantity("force_sensitivity", "N/V", "force sensitivity", kind=STANDARD)
#: Detector parameters that can be fitted, in addition to the noise
DETECTOR = {
    "exposure": Quantity("exposure", "s", "blur", kind=STANDARD, shown="us"),
    "diode_frequency": Quantity("diode_frequency", "Hz", "diode", kind=STANDARD, shown="kHz"),
    "diode_fraction": Quantity("diode_fraction", "1", "detected at once", kind=STANDARD),
}

FREE_DIFFUSION = Quantity("diffusion", "m^2/s", "diffusion", kind=STANDARD)
EXPECTED = Quantity("expected", "m^2/s", "by Einstein", kind="")
#: Quantities of which a free bead can determine one
INFERRED = {
    "viscosity": Quantity("viscosity", "Pa s", "viscosity", kind=STANDARD),
    "radius": Quantity("radius", "m", "radius", kind=STANDARD, shown="nm"),
    "drag": DRAG,
    "Boltzmann": Quantity(
        "Boltzmann", "J/K", "Boltzmann's constant", kind=STANDARD, shown="10^-23 J/K"
    ),
}

WALL = Quantity(
    "position", "m", "focus, for the bead's centre in the wall", kind=STANDARD, compared=True
)
SHIFT = Quantity("shift", "1", "the bead moves by", kind=STANDARD, compared=True)
FAR_DRAG = Quantity("drag", "kg/s", "drag far from the wall", kind=STANDARD, compared=True)
HEIGHT = Quantity("height", "m", "height", kind=STANDARD)

BOTTOM = Quantity("stiffness", "N/m", "stiffness of its bottom", kind=STANDARD)
MINIMUM = Quantity("minimum", "m", "bottom of the parabola", kind="")


def signal(name: str, about: str, unit: str) -> Quantity:
    """Return a quantity in the unit of a recording, "m" or "V", printed in nm or mV."""
    return Quantity(name, unit, about, kind=STANDARD, shown="mV" if unit == "V" else "nm")
