"""What a run tells: derived quantities and how it ended."""

from tweezer.analysis.derived import derived_quantities
from tweezer.analysis.summary import Summary, summarise

__all__ = ["Summary", "derived_quantities", "summarise"]
