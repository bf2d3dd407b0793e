"""Ten real tracks of beads that are not trapped: the example of docs/free-beads.md.

`python -m tests.benchmarks.real_tracks FOLDER` reads them from the folder `data` of the repository
yunkiyau/3rdyearphys-optical_tweezers_experiment, which is not part of this one, keeps what was
found, and writes block and figure of the page. Without a folder it takes what was kept.

Lag by lag: the mean squared displacement less its drift at two lags, whose difference has no blur
and no localisation error; its uncertainty is the scatter among simulated tracks.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import tweezer
from tests.benchmarks import pages
from tests.benchmarks.force import _to_four_digits
from tests.benchmarks.timing import ROOT, machine
from tests.reference.free_bead import free
from tweezer.plots import style

Results = dict[str, Any]

#: The camera's and the tracker's, and of the water; its temperature is not said
READING = {"rate": "15 Hz", "scale": "11.66 px/um"}
TEMPERATURE, VISCOSITY = "20 degC", "1.002 mPa s"
#: Lags, frames
LAGS = (1, 2, 4, 8, 16)
#: Pairs of them that a diffusion is told by
PAIRS = ((1, 4), (4, 16))
#: Simulated tracks
COPIES = 300


def measure(folder: Path) -> Results:
    """What the tracks tell."""
    files = sorted(folder.glob("*.csv"))
    results: Results = _to_four_digits(
        {"machine": machine(), "tracks": [_track(each) for each in files]}
    )
    return results


def _track(path: Path) -> Results:
    recording = tweezer.load_recording(path, **READING)
    told = tweezer.calibrate(recording, temperature=TEMPERATURE, viscosity=VISCOSITY).free
    assert told is not None
    frames = len(recording.times)
    copies = free(
        recording.step, frames, told.diffusion, 1, count=2 * COPIES, exposure=recording.step
    ).reshape(COPIES, 2, frames)
    scatter = np.std([_by_pairs(each.T, recording.step) for each in copies], axis=0)
    return {
        "name": path.stem, "frames": frames, "axes": [each.axis for each in told.axes],
        "diffusion": told.diffusion, "interval": told.interval, "radius": told.inferred.value,
        "radius_interval": told.inferred.interval, "remarks": told.remarks,
        "findings": [each.text for each in told.findings],
        "by_lag": _by_lag(recording.positions, recording.step).tolist(),
        "by_pairs": _by_pairs(recording.positions, recording.step),
        "by_pairs_uncertainty": scatter.tolist(),
    }  # fmt: skip


def _displacement(positions: np.ndarray, lag: int) -> float:
    """Mean square along one axis, of all, without the mean drift."""
    apart = positions[lag:] - positions[:-lag]
    drift = (positions[-1] - positions[0]) / (len(positions) - 1)
    return float(((apart - lag * drift) ** 2).mean())


def _by_lag(positions: np.ndarray, step: float) -> np.ndarray:
    return np.array([_displacement(positions, lag) / (2 * lag * step) for lag in LAGS])


def _by_pairs(positions: np.ndarray, step: float) -> list[float]:
    return [
        (_displacement(positions, long) - _displacement(positions, short))
        / (2 * (long - short) * step)
        for short, long in PAIRS
    ]


#: What the figure shows
SHOWS = (
    "Mean squared displacement over twice the time for each of ten tracks against the lag, "
    "1 to 16 frames: most rise with the lag, from below the shaded interval of D into it"
)


def block(results: Results) -> str:
    """Its part of the page, between its markers."""
    headings = [
        "track",
        "frames",
        "D, um²/s (95 %)",
        "lags 1 and 4",
        "lags 4 and 16",
        "radius, um (95 %)",
    ]
    rows = []
    for each in results["tracks"]:
        pairs = [
            f"{1e12 * value:.3f} ± {1e12 * error:.3f}"
            for value, error in zip(each["by_pairs"], each["by_pairs_uncertainty"], strict=True)
        ]
        rows.append(
            [each["name"], str(each["frames"]), _ends(each["diffusion"], each["interval"], 1e12, 3),
             *pairs, _ends(each["radius"], each["radius_interval"], 1e6, 2)]
        )  # fmt: skip
    figure = f"![{SHOWS}](figures/free-tracks.png)"
    made = f"These figures were measured at commit {results['machine']['commit']}."
    lines = [*pages.markdown(headings, rows), "", figure, "", made]
    return "\n".join(["<!-- bench-real-tracks -->", *lines, "<!-- end -->"])


def _ends(value: float, interval: list[float], factor: float, digits: int) -> str:
    low, high = interval
    return f"{factor * value:.{digits}f} ({factor * low:.{digits}f} to {factor * high:.{digits}f})"


def _short(name: str) -> str:
    """Return the name of a track as the title of a panel: the size, the series and the bead."""
    name = name.replace(" brownian ambient light off - use this", "").replace("um", " µm ")
    words = name.replace("_bead", " bead ").split()
    return " ".join(word for word in words if not word.startswith("brown"))


@style.styled
def figure(results: Results) -> Figure:
    """Mean squared displacements over lags, and the interval of the diffusion, by track."""
    drawn = style.new(style.PAGE, 3.0)
    every = drawn.subplots(2, math.ceil(len(results["tracks"]) / 2), sharex=True, sharey="row")
    for axes, each in zip(every.flat, results["tracks"], strict=True):
        axes.axhspan(*(1e12 * end for end in each["interval"]), color=style.SHADE)
        axes.semilogx(LAGS, [1e12 * v for v in each["by_lag"]], **style.SERIES[0].points)
        axes.set_title(_short(each["name"]))
        axes.set_xticks(LAGS, [str(lag) for lag in LAGS])
        axes.minorticks_off()
    for first in every[:, 0]:
        first.set_ylim(0, None)
    drawn.supxlabel("lag (frames)")
    drawn.supylabel("MSD / 2t along one axis (µm²/s)")
    return drawn


if __name__ == "__main__":
    if len(sys.argv) > 1:
        kept = json.dumps(measure(Path(sys.argv[1])), indent=2) + "\n"
        (ROOT / "tests/benchmarks/results/real_tracks.json").write_text(kept, encoding="utf-8")
    found = pages.committed("real_tracks")
    pages.quote("real-tracks", block(found))
    pages.save(figure(found), "free-tracks")
