"""Write the thesis's figures, its claims with their verdicts, and the study of the lost bead."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from tweezer.arguments import check_seed
from tweezer.errors import ResultError, SceneError
from tweezer.io import replacing, write_json
from tweezer.thesis.figures import FIGURES, figure, study_figure
from tweezer.thesis.lost_bead import Study, study
from tweezer.thesis.runs import BEADS, Motions, motions
from tweezer.thesis.verdicts import Claim, claims

#: Names of what `reproduce` can write besides figures
TABLES = ("claims", "study")
#: Approximate durations, in units of a figure
_WORK = {"motions": 15.0, "claims": 15.0, "study": 60.0}


@dataclass(frozen=True)
class Reproduction:
    """Results of `reproduce`."""

    files: list[Path]
    """files written, in this order"""
    claims: list[Claim]
    """empty if they were not requested"""


def reproduce(
    what: Sequence[str] = (),
    out: str | Path = "thesis-results",
    *,
    seed: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Reproduction:
    """Write figures, claims or the study into the folder `out`, which is created if its parent
    exists.

    what: numbers of figures ("5.1" to "5.15", "C.1" to "C.12"), written as PNG; "claims", written
    as claims.json and claims.md; "study", of the 500 nm bead, as study.png and study.json.
    Everything if empty. seed: of the thermal motions. progress: called with the finished part.

    Existing files are replaced one by one, each as a whole. Before any computation raises
    `SceneError` for a seed that is not valid or a figure that the thesis does not have, and
    `ResultError` for a folder that cannot be created; later `ResultError` if a file cannot be
    written.
    """
    asked = list(dict.fromkeys(what)) or [*FIGURES, *TABLES]
    for name in asked:
        if name not in FIGURES and name not in TABLES:
            raise SceneError(
                f"{name}: no such figure; 5.1 to 5.15, C.1 to C.12, {' or '.join(TABLES)}"
            )
    check_seed(seed)
    folder = Path(out)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise ResultError(f"{out}: cannot be made: {error.strerror}") from None
    needed = [
        bead
        for bead in BEADS
        if "claims" in asked or any(FIGURES[name][1] == bead for name in asked if name in FIGURES)
    ]
    total = sum(_WORK.get(name, 1) for name in asked) + _WORK["motions"] * len(needed)
    done = 0.0

    def did(work: float) -> None:
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
    decided = claims(by_bead) if "claims" in asked else []
    if decided:
        files += _write_claims(decided, folder)
        did(_WORK["claims"])
    if "study" in asked:
        files += _write_study(study(lambda part: did(part * _WORK["study"])), folder)
    return Reproduction(files, decided)


def _save(figure: Figure, path: Path) -> Path:
    with replacing(path) as whole:
        figure.savefig(whole, format="png", dpi=100)
    return path


def _write_claims(found: Sequence[Claim], folder: Path) -> list[Path]:
    as_json, as_markdown = folder / "claims.json", folder / "claims.md"
    entries = [dataclasses.asdict(claim) | {"verdict": claim.verdict} for claim in found]
    write_json(entries, as_json)
    lines = [
        "| where | claim | taken as | computed | verdict |",
        "| --- | --- | --- | --- | --- |",
        *(
            "| "
            + " | ".join(
                text.replace("|", "\\|")
                for text in (
                    claim.where, claim.text, claim.reading, claim.computed, f"**{claim.verdict}**",
                )
            )
            + " |"
            for claim in found
        ),
    ]  # fmt: skip
    with replacing(as_markdown) as whole:
        whole.write(("\n".join(lines) + "\n").encode())
    return [as_json, as_markdown]


def _write_study(found: Study, folder: Path) -> list[Path]:
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
