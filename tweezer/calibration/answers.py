"""Evidence for a fit in addition to the spectrum: responses to a moving stage, and a known drag."""

from __future__ import annotations

import cmath
import dataclasses
import math
from dataclasses import dataclass

from tweezer.calibration.spectra import TrappedBead


@dataclass(frozen=True)
class Answer:
    """Amplitude of a bead's response at one frequency of a moving stage, or in a narrow band."""

    frequency: float
    """frequency of the stage, Hz"""
    stage: float
    """amplitude of the stage, m"""
    stage_uncertainty: float
    """standard uncertainty of `stage`, m"""
    signal: float
    """amplitude of the signal, m or V"""
    signal_uncertainty: float
    """standard uncertainty of `signal`, from the thermal motion around it, m or V"""
    phase: float
    """phase by which the signal leads the stage, rad"""

    @property
    def response(self) -> complex:
        """Complex ratio of signal to stage motion: V/m, or dimensionless for a signal in m."""
        return cmath.rect(self.signal / self.stage, self.phase)

    @property
    def response_uncertainty(self) -> float:
        """Standard uncertainty of the real and of the imaginary part of `response`."""
        of_stage = abs(self.response) * self.stage_uncertainty
        return math.hypot(self.signal_uncertainty, of_stage) / self.stage

    def misfit(self, bead: TrappedBead) -> float:
        """Return the deviation from the amplitude of `bead`, in standard uncertainties."""
        per_metre = abs(complex(bead.driven(self.frequency)))
        error = math.hypot(self.signal_uncertainty, per_metre * self.stage_uncertainty)
        return (self.signal - per_metre * self.stage) / error

    def late(self, bead: TrappedBead) -> tuple[float, float]:
        """Return the phase lag of the signal behind that of `bead`, and its uncertainty, rad.

        The lag may be negative. A reversed sign of the signal, a phase of pi, is ignored.
        """
        behind = cmath.phase(complex(bead.driven(self.frequency))) - self.phase
        error = math.hypot(
            self.signal_uncertainty / self.signal, self.stage_uncertainty / self.stage
        )
        return (behind + math.pi / 2) % math.pi - math.pi / 2, error

    def per(self, response: float) -> Answer:
        """Return this answer with its signal divided by a response."""
        return dataclasses.replace(
            self,
            signal=self.signal / response,
            signal_uncertainty=self.signal_uncertainty / response,
        )


@dataclass(frozen=True)
class KnownDrag:
    """Drag that is known independently of the recording, with an uncertainty."""

    drag: float
    """drag of the bead, kg/s"""
    uncertainty: float
    """standard uncertainty of the drag's logarithm"""

    def misfit(self, bead: TrappedBead) -> float:
        """Return the deviation from the drag of `bead`, in standard uncertainties."""
        return math.log(bead.drag / self.drag) / self.uncertainty

    def per(self, _: float) -> KnownDrag:
        """Return this drag unchanged, because it does not depend on the signal's unit."""
        return self
