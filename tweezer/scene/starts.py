"""Positions of several beads at the start, filled in before a scene is checked."""

from __future__ import annotations

from typing import Any

from tweezer.scene.courses import refusal
from tweezer.values.units import to_si


def with_starts(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a scene in which each of several beads has a position at the start.

    A bead without one starts at the focus of the beam with the same number. `start.position`
    becomes the position of the first bead. A scene of one bead is returned unchanged.
    """
    beads = [data.get("bead"), *(data.get("more_beads") or ())]
    beams = [data.get("beam"), *(data.get("more_beams") or ())]
    start = data.get("start", {})
    known = all(isinstance(each, dict) for each in (*beads, start))
    if len(beads) == 1 or not known or any(isinstance(each, str) for each in beams):
        return data  # the check of the keys reports the error
    if start.get("frame", "focus") != "focus":
        raise refusal("start.frame = 'lens': requires a single bead; remove start.frame")
    placed = []
    for i, bead in enumerate(beads):
        start_of_bead = bead.get("start")
        if start_of_bead is None:
            if i >= len(beams):
                raise refusal(f"bead[{i + 1}].start: missing; there is no beam[{i + 1}] to hold it")
            beam = beams[i]
            focus = beam.get("position") if isinstance(beam, dict) else beam.position
            start_of_bead = focus or (0.0, 0.0, 0.0)
        placed.append({**bead, "start": start_of_bead})
    given = start.get("position")
    if given is not None and _si(given) != _si(placed[0]["start"]):
        raise refusal(
            f"start.position = {given!r}: requires a single bead; set bead[1].start instead"
        )
    return {
        **data, "bead": placed[0], "more_beads": placed[1:],
        "start": {**start, "position": placed[0]["start"]},
    }  # fmt: skip


def _si(position: Any) -> Any:
    """Return a position in m, or the value itself if it is not one."""
    try:
        return [to_si(each, "m") for each in position]
    except (TypeError, ValueError):
        return position
