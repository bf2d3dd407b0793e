"""The sections of a scene for a photodiode behind the bead, and for an amplifier behind it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictBool

from tweezer.scene.courses import Section
from tweezer.values.units import Frequency, Quantity


class Detector(Section):
    """A position-sensitive photodiode in the back focal plane of a condenser or of the lens."""

    numerical_aperture: Annotated[float, Quantity("", 1e-3, 10)] = Field(
        description="numerical aperture of the collected light; at most the index of the medium"
    )
    side: Literal["forward", "backward"] = Field(
        "forward",
        description="forward: light that passes the bead and what it scatters forward, by a "
        "condenser; backward: light that it scatters back",
    )
    kind: Literal["quadrant", "linear", "momentum"] = Field(
        "quadrant",
        description="x, y and z of the signal. quadrant: differences between halves, and all of "
        "the light; linear: light weighted by its position over the diode's radius, and all of the "
        "light; momentum: light weighted by the components of its direction",
    )
    efficiency: Annotated[float, Quantity("", 1e-6, 1)] = Field(
        1.0, description="part of the collected light that is detected"
    )
    bandwidth: Frequency | None = Field(
        None,
        description="half-power frequency of a first-order low-pass filter. Default: none; the "
        "shot noise is then the mean over the sampling interval",
    )
    noise: StrictBool = Field(True, description="whether the signal of a run has shot noise")


class LockIn(Section):
    """A lock-in amplifier: the slow amplitude of a bead about a frequency, in thermal motion."""

    frequency: Frequency = Field(description="frequency of the reference")
    bandwidth: Frequency = Field(
        description="corner frequency of the low-pass of first order behind the mixer"
    )
