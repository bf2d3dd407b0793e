"""Errors and warnings a user of tweezer can meet."""

from __future__ import annotations


class TweezerError(Exception):
    """Base of every error raised on purpose; its text is meant for the user as it stands."""


class SceneError(TweezerError):
    """A scene that cannot be read or holds a bad value; one line per bad value."""


class IntegrationError(TweezerError):
    """The equations could not be integrated further: non-finite rates, collapsed step."""


class ResultError(TweezerError):
    """A result file that cannot be written or read."""


class PhysicsWarning(UserWarning):
    """A scene outside the range where one of the models used is known to hold."""
