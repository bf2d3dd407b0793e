"""Output of the reproduction: figures, claims with verdicts, captures and the study of the lost
bead.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from tweezer.plots import style
from tweezer.results.io import write_json
from tweezer.scene.arguments import check_seed
from tweezer.thesis.captures import Capture, captures
from tweezer.thesis.claims import Claim, number
from tweezer.thesis.figures import (
    FIGURES,
    captures_figure,
    figure,
    memory_figure,
    study_figure,
)
from tweezer.thesis.fluid_inertia import READINGS, Remembered, Scaled, remembered
from tweezer.thesis.lost_bead import Study, study
from tweezer.thesis.runs import BEADS, Motions, motions
from tweezer.thesis.verdicts import claims
from tweezer.values.errors import ResultError, SceneError
from tweezer.values.files import replacing
from tweezer.values.prefixes import per

#: Names of the results that `reproduce` can write in addition to figures
TABLES = ("claims", "waves", "memory", "study")
#: Names of the theories of the light
_THEORIES = {"rays": "ray optics", "waves": "wave optics"}
#: Approximate durations, relative to that of a figure
_WORK = {"motions": 15.0, "waves": 2.0, "memory": 3.0, "claims": 25.0, "study": 60.0}


@dataclass(frozen=True)
class Reproduction:
    """Results of `reproduce`: files written and claims judged."""

    files: list[Path]
    """paths of the files in the order in which they were written"""
    claims: list[Claim]
    """claims with their verdicts; empty if not requested"""


def reproduce(
    what: Sequence[str] = (),
    out: str | Path = "thesis-results",
    *,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Reproduction:
    """Write figures, claims or the study into the folder `out`.

    The folder is created if its parent exists. Existing files are replaced one by one, atomically.

    Parameters
    ----------
    what : sequence of str
        Results to write. Default: all.

        * "5.1" to "5.15" and "C.1" to "C.12": a figure, as PNG
        * "claims": claims.json and claims.md
        * "waves": the captures with ray and wave optics, as waves.png, waves.json and waves.md
        * "memory": the same in a fluid with inertia, as memory.png, memory.json and memory.md
        * "study": the study of the 500 nm bead, as study.png and study.json
    out : str or Path
        Folder to write to.
    seed : int
        Seed of the thermal motion.
    progress : callable, optional
        Called with the completed fraction.

    Raises
    ------
    SceneError
        Before any computation, for an invalid seed or a figure that the thesis does not have.
    ResultError
        Before any computation, if the folder cannot be created; later, if a file cannot be written.
    """
    asked = list(dict.fromkeys(what)) or [*FIGURES, *TABLES]
    for name in asked:
        if name not in FIGURES and name not in TABLES:
            raise SceneError(
                f"{name}: no such figure; 5.1 to 5.15, C.1 to C.12, {', '.join(TABLES)}"
            )
    check_seed(seed)
    folder = Path(out)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise ResultError(f"{out}: cannot be created: {error.strerror}") from None
    in_waves = not {"claims", "waves", "memory"}.isdisjoint(asked)
    needed = [
        bead
        for bead in BEADS
        if in_waves or any(FIGURES[name][1] == bead for name in asked if name in FIGURES)
    ]
    total = sum(_WORK.get(name, 1) for name in asked) + _WORK["motions"] * len(needed)
    done = 0.0

    def did(work: float) -> None:
        """Report that `work`, relative to a figure, is completed."""
        nonlocal done
        done += work
        if progress:
            progress(done / total)

    files: list[Path] = []
    by_bead: dict[str, Motions] = {}
    for bead in needed:
        by_bead[bead] = motions(bead, seed)
        did(_WORK["motions"])
        for name in asked:
            if name in FIGURES and FIGURES[name][1] == bead:
                files.append(_save(figure(name, by_bead[bead]), folder / f"figure-{name}.png"))
                did(1)
    by_waves = {bead: motions(bead, seed, "waves") for bead in BEADS} if in_waves else {}
    decided = claims(by_bead, by_waves) if "claims" in asked else []
    if decided:
        files += _write_claims(decided, folder)
        did(_WORK["claims"])
    if "waves" in asked:
        files += _write_captures(captures((by_bead, by_waves)), folder)
        files.append(_save(captures_figure((by_bead, by_waves)), folder / "waves.png"))
        did(_WORK["waves"])
    if "memory" in asked:
        found = remembered((by_bead, by_waves))
        files += _write_remembered(found, folder)
        files.append(_save(memory_figure(by_bead, found), folder / "memory.png"))
        did(_WORK["memory"])
    if "study" in asked:
        files += _write_study(study(lambda part: did(part * _WORK["study"])), folder)
    return Reproduction(files, decided)


def _save(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG atomically, with letters for its panels, and return its path."""
    style.add_letters(figure)
    with replacing(path) as whole:
        style.save(figure, whole, "png")
    return path


def _write_claims(found: Sequence[Claim], folder: Path) -> list[Path]:
    """Write the claims as claims.json and claims.md, and return the paths."""
    heading = (
        "section", "claim of the thesis", "criterion", "result", "verdict", "with wave optics",
    )  # fmt: skip
    rows = [
        (
            claim.where, claim.text, claim.reading, claim.computed, f"**{claim.verdict}**",
            _by_waves(claim),
        )
        for claim in found
    ]  # fmt: skip
    return _write_table("claims", [_entry(claim) for claim in found], heading, rows, folder)


def _by_waves(claim: Claim) -> str:
    """Return the result and verdict of a claim with wave optics, or the reason for none, for a
    table.
    """
    if isinstance(claim.by_waves, Claim):
        return f"{claim.by_waves.computed}: **{claim.verdict_by_waves}**"
    return claim.verdict_by_waves


def _entry(claim: Claim) -> dict[str, Any]:
    """Return a claim as a JSON object; `by_waves` has only entries that can differ."""
    entry = dataclasses.asdict(claim) | {"verdict": claim.verdict}
    if isinstance(claim.by_waves, Claim):
        of_waves = _entry(claim.by_waves)
        differing = ("computed", "thesis", "unscaled", "numbers", "verdict")
        return entry | {"by_waves": {name: of_waves[name] for name in differing}}
    return entry


def _write_captures(found: Sequence[Capture], folder: Path) -> list[Path]:
    """Write the captures as waves.json and waves.md, and return the paths."""
    heading = (
        "bead, theory", "settling time to 20 nm", "overshoot", "equilibrium beyond the focus",
        "lateral stiffness", "axial stiffness",
    )  # fmt: skip
    rows = [
        (
            f"{each.bead[:-2]} nm, {_THEORIES[each.theory]}", number(each.arrival, "ms", ".1f"),
            number(each.overshoot, "um", ".2g"), number(each.rest, "um", ".3f"),
            number(each.stiffness_across, "pN/um", ".0f"),
            number(each.stiffness_along, "pN/um", ".0f"),
        )
        for each in found
    ]  # fmt: skip
    return _write_table("waves", list(map(dataclasses.asdict, found)), heading, rows, folder)


def _write_remembered(found: Sequence[Remembered], folder: Path) -> list[Path]:
    """Write the effect of fluid inertia as memory.json and memory.md, and return the paths."""
    entries = [dataclasses.asdict(each) for each in found]
    for entry in entries:
        for scaled in entry["scaled"]:
            del scaled["time"], scaled["q2"]
    heading = (
        "bead, theory", "largest effect on the position", "time to reach one radius",
        "overshoot", *(f"printed a2: {reading}" for reading in READINGS),
    )  # fmt: skip
    rows = [
        (
            f"{each.bead[:-2]} nm, {_THEORIES[each.theory]}", number(each.off, "um", ".2f"),
            " → ".join(f"{per('ms') * time:.2f}" for time in each.within) + " ms",
            " → ".join(_nanometres(length) for length in each.overshoot) + " nm",
            *(_fate(scaled) for scaled in each.scaled),
        )
        for each in found
    ]  # fmt: skip
    return _write_table("memory", entries, heading, rows, folder)


def _fate(scaled: Scaled) -> str:
    """Return the outcome of a scaled bead in words, for a captured one with its overshoot."""
    if scaled.outcome != "captured":
        return scaled.outcome
    return f"overshoots by {_nanometres(scaled.overshoot)} nm" if scaled.overshoot else "captured"


def _nanometres(length: float) -> str:
    """Return a length, m, as text in nm: whole numbers above 10 nm, otherwise two digits."""
    return f"{per('nm') * length:{'.0f' if length > 1e-8 else '.2g'}}"


def _write_table(
    name: str,
    entries: Sequence[dict[str, Any]],
    heading: Sequence[str],
    rows: Sequence[Sequence[str]],
    folder: Path,
) -> list[Path]:
    """Write entries as NAME.json, and rows below a heading as a Markdown table NAME.md.

    Returns both paths.
    """
    as_json, as_table = folder / f"{name}.json", folder / f"{name}.md"
    write_json(entries, as_json)
    lines = [
        "| " + " | ".join(text.replace("|", "\\|") for text in row) + " |"
        for row in (heading, ["---"] * len(heading), *rows)
    ]
    with replacing(as_table) as whole:
        whole.write(("\n".join(lines) + "\n").encode())
    return [as_json, as_table]


def _write_study(found: Study, folder: Path) -> list[Path]:
    """Write the study as study.json (without paths) and study.png, and return both paths."""
    as_json = folder / "study.json"
    variants = [
        {
            **{
                field.name: getattr(variant, field.name)
                for field in dataclasses.fields(variant)
                if field.name not in ("time", "q2")
            },
            "as_claimed": variant.as_claimed,
        }
        for variant in found.variants
    ]
    write_json(
        {
            "variants": variants,
            "factors": found.factors,
            "powers_mW": found.powers,
            "captured": found.captured.tolist(),
            "overshoot": found.overshoot.tolist(),
            "kept": found.kept,
            "released": found.released,
            "kept_interval": found.kept_interval,
        },
        as_json,
    )
    return [as_json, _save(study_figure(found), folder / "study.png")]
