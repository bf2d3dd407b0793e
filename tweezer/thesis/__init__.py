"""The thesis reproduced: its figures, its claims, and why its 500 nm bead is lost.

Everything here is computed with the thesis's printed parameters (Tables B.1 to B.4 and 5.1), by its
own model and, beside it, by the unscaled equations.
"""

from tweezer.thesis.claims import Claim, claims
from tweezer.thesis.figures import FIGURES, figure
from tweezer.thesis.motions import BEADS, Motions, motions
from tweezer.thesis.reproduce import reproduce
from tweezer.thesis.study import Study, Variant, study

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
