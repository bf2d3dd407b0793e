"""The thesis reproduced: its figures, its claims, and why its 500 nm bead is lost.

Everything here is computed with the thesis's printed parameters (Tables B.1 to B.4 and 5.1), by its
own model and, beside it, by the unscaled equations.
"""

from tweezer.thesis.figures import FIGURES, figure
from tweezer.thesis.lost_bead import Study, Variant, study
from tweezer.thesis.runs import BEADS, Motions, motions
from tweezer.thesis.verdicts import Claim, claims
from tweezer.thesis.writing import reproduce

__all__ = [
    "BEADS",
    "FIGURES",
    "Claim",
    "Motions",
    "Study",
    "Variant",
    "claims",
    "figure",
    "motions",
    "reproduce",
    "study",
]
