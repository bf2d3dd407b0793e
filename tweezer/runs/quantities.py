"""Quantities of the summary of a run."""

from tweezer.values.measured import Quantity

OUTCOME_TIME = Quantity("outcome_time", "s", "time of capture, of loss, or of the end")
END = Quantity("end", "m", "last position, from the focus", "axis")
OVERSHOOT = Quantity("overshoot", "m", "largest excursion beyond the axis")
APPROACH = Quantity("closest_approach", "m", "first closest approach to the focus")
APPROACH_TIME = Quantity("closest_approach_time", "s", "time of the first closest approach")
REYNOLDS = Quantity("largest_reynolds_number", "1", "largest Reynolds number")
LARGEST_FORCE = Quantity("largest_force", "N", "largest force of the light on the way")
QUANTITIES = (OUTCOME_TIME, END, OVERSHOOT, APPROACH, APPROACH_TIME, REYNOLDS, LARGEST_FORCE)
