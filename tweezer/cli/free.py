"""The output of the command calibrate for free beads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tweezer.cli.console import OUT
from tweezer.values.errors import ResultError
from tweezer.values.printed import in_unit, printed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tweezer.calibration import Diffusion, Trajectory

#: Smallest number of frames in each track at which trapped beads are calibrated one by one
_LONG = 100


def print_free(free: Diffusion, unit: str, seen: str | None = None) -> None:
    """Print one line with the diffusion; below it what was omitted and the findings.

    Parameters
    ----------
    free : Diffusion
    unit : str
        Unit of the recording, "m" or "V".
    seen : str, optional
        Beginning of the line, before the diffusion.
    """
    from tweezer.calibration.wording import NO_TRAP, diffusion_in_words

    OUT.print(diffusion_in_words(free, unit, seen or NO_TRAP), highlight=False, soft_wrap=True)
    for text in (*free.remarks, *(f"not trusted: {each.text}" for each in free.findings)):
        OUT.print(f"   {text}", highlight=False, soft_wrap=True)


def print_tracks(free: Diffusion, tracks: Sequence[Trajectory], few: ResultError | None) -> None:
    """Print the diffusion of one short track, or the common diffusion of several.

    Raises `ResultError` for long tracks of trapped beads, which are calibrated one by one.

    Parameters
    ----------
    free : Diffusion
    tracks : sequence of Trajectory
    few : ResultError or None
        Reason why the last track cannot be calibrated as a trapped bead, if any.
    """
    first = tracks[0]
    held = any(each.name == "confined" for each in free.findings)
    held |= not free.interval[0] or free.uncertainty > free.diffusion / 2
    held &= min(each.frames for each in tracks) >= _LONG
    if len(tracks) > 1 and held:
        source, _, label = first.name.rpartition(", bead ")
        way = f'--bead "{label}"' if source else first.name
        raise ResultError(
            f"{source or first.name}: has {len(tracks)} beads that do not diffuse freely as far as "
            f"is seen; calibrate them one by one, such as {way}"
        )
    if held and few is not None:
        raise few
    seen = f"{len(tracks)} tracks together, treated as free beads"
    if len(tracks) == 1:
        why = "samples are too few" if first.frames < _LONG else "samples have too many gaps"
        seen = f"{first.frames} {why} to detect a trap; treated as a free bead"
    print_free(free, first.unit, seen)
    if free.homogeneity is not None:
        OUT.print(
            f"   diffusion of single tracks: {_spread(free)}; p = {free.homogeneity:.2g} for one "
            "diffusion of all",
            highlight=False, soft_wrap=True,
        )  # fmt: skip


def _spread(free: Diffusion) -> str:
    values = sorted(each.diffusion for each in free.tracks)
    unit = "um^2/s" if free.inferred is not None or free.expected is not None else "10^-12 V^2/s"
    return f"{in_unit(values[0], unit, 3)} to {printed(values[-1], unit, 3)}"
