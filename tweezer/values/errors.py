"""Errors and warnings for users of tweezer."""

from __future__ import annotations

import inspect
import warnings


class TweezerError(Exception):
    """Base of all errors that tweezer raises deliberately, with a message for the user."""


class SceneError(TweezerError):
    """A scene cannot be read or contains invalid values; the message has one line per value."""


class FrozenError(SceneError, AttributeError):
    """A value was assigned to a scene or a part of it, which are immutable."""


class ForceError(SceneError, ValueError):
    """A user's own force violates the requirements of `tweezer.forces.UserForce`."""


class IntegrationError(TweezerError):
    """The equations cannot be integrated further, because a rate is not finite or the step is too
    small.
    """


class ResultError(TweezerError):
    """A result or recording cannot be read, written or used."""


class TooFewError(ResultError):
    """A recording contains too few samples to analyse a trap."""


class SeveralBeadsError(ResultError):
    """A table contains several beads, but one is required."""


class PhysicsWarning(UserWarning):
    """A scene is outside the range in which one of the models used is known to be valid."""


class UnitWarning(UserWarning):
    """A number without a unit was read in the SI unit, in which its magnitude is unusual."""


def warn(text: str, category: type[Warning] = PhysicsWarning) -> None:
    """Warn, attributing the warning to the line of the user's code that led here."""
    package = __name__.partition(".")[0]
    frame, level = inspect.currentframe(), 1
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, category, stacklevel=level)
