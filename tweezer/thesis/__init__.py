"""Reproduction of the thesis: its figures, its claims, and why its 500 nm bead is lost.

Everything is computed with the thesis's printed parameters (Tables B.1 to B.4 and 5.1), by its own
model and by the unscaled equations. The light is computed by ray optics, as in the thesis, and by
wave optics. The motion is also computed in a fluid with inertia.
"""

from tweezer.thesis.captures import Capture, captures
from tweezer.thesis.claims import Claim
from tweezer.thesis.figures import FIGURES, figure
from tweezer.thesis.fluid_inertia import Remembered, remembered
from tweezer.thesis.lost_bead import Study, Variant, study
from tweezer.thesis.runs import BEADS, THEORIES, Motions, motions
from tweezer.thesis.verdicts import claims
from tweezer.thesis.writing import reproduce

__all__ = [
    "BEADS",
    "FIGURES",
    "THEORIES",
    "Capture",
    "Claim",
    "Motions",
    "Remembered",
    "Study",
    "Variant",
    "captures",
    "claims",
    "figure",
    "motions",
    "remembered",
    "reproduce",
    "study",
]
