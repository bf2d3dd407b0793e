"""Errors and warnings for users of tweezer."""

from __future__ import annotations

import inspect
import warnings


class TweezerError(Exception):
    """Base of every error raised on purpose; its text is meant for the user as it stands."""


class SceneError(TweezerError):
    """A scene that cannot be read or holds a bad value; one line per bad value."""


class FrozenError(SceneError, AttributeError):
    """A scene, or a part of it, that is assigned to."""


class ForceError(SceneError, ValueError):
    """A force of the user's own that breaks the contract of `tweezer.forces.UserForce`."""


class IntegrationError(TweezerError):
    """The equations could not be integrated further: non-finite rates, collapsed step."""


class ResultError(TweezerError):
    """A result file that cannot be written or read."""


class TooFewError(ResultError):
    """A recording with too few samples for the analysis of a trap."""


class SeveralBeadsError(ResultError):
    """A table of several beads where one is needed."""


class PhysicsWarning(UserWarning):
    """A scene outside the range where one of the models used is known to hold."""


class UnitWarning(UserWarning):
    """A number without a unit, read in the SI unit, in which it is unusual."""


def warn(text: str, category: type[Warning] = PhysicsWarning) -> None:
    """Warn, attributing the warning to the line of the user's code that led here."""
    package = __name__.partition(".")[0]
    frame, level = inspect.currentframe(), 1
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, level = frame.f_back, level + 1
    warnings.warn(text, category, stacklevel=level)
