"""Positions of several beads at the start, filled in before a scene is checked."""

from __future__ import annotations

from typing import Any

from tweezer.scene.courses import refusal


def with_starts(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data of a scene in which each of several beads has a position at the start.

    A bead without one starts at the focus of the beam with the same number. `start.position`
    becomes the position of the first bead. A scene of one bead is returned unchanged.
    """
    beads = [data.get("bead"), *(data.get("more_beads") or ())]
    start = data.get("start", {})
    if len(beads) == 1 or not all(isinstance(each, dict) for each in (*beads, start)):
        return data
    beams = [data.get("beam"), *(data.get("more_beams") or ())]
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
    return {
        **data, "bead": placed[0], "more_beads": placed[1:],
        "start": {**start, "position": placed[0]["start"]},
    }  # fmt: skip
