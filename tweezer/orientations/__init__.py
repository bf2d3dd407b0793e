"""Rotation and alignment of a body, from its orientations in a run or an ensemble."""

from tweezer.orientations.rotation import rotation

__all__ = ["rotation"]
