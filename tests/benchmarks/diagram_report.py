"""The trapping diagram as tables, a figure, a file of its numbers, and on its page.

`python -m tests.benchmarks.diagram_report` writes them from the committed results.
"""

from __future__ import annotations

import csv
import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.diagram import MATERIALS, TIMES, Results
from tests.benchmarks.timing import ROOT
from tweezer.plots import style
from tweezer.trap.quantities import HELD, SHALLOW

#: The least powers, one line for each bead and time
NUMBERS = ROOT / "docs/figures/trapping-diagram.csv"
#: sizes of the table, um
SHOWN = 0.2, 0.25, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0
#: lines of the figure
LINES = {"1 h": "-", "1 year": "--"}
#: range of the figure's powers, W, and of its depths, k_B T
LOWEST, DEPTHS = 1e-5, (10.0, 1e5)
#: outcomes of scenes that have a trap
TRAPPED = HELD, SHALLOW


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of minimum powers and of lifetimes, with the headings in the first row."""
    return [
        [
            ["bead, um", *(f"{material}, {name}" for material in MATERIALS for name in TIMES)],
            *_least(results),
        ],
        [
            ["bead", "depth, kT", "lifetime, s", "ensemble, s", "deviation, sd"],
            *map(_against_ensemble, results["ensembles"]),
        ],
    ]


def _least(results: Results) -> list[list[str]]:
    """Return the rows of minimum powers of some sizes, mW."""
    diameters = np.array(results["diameters_m"])
    nearest = {int(np.abs(np.log(diameters / (1e-6 * size))).argmin()) for size in SHOWN}
    rows = []
    for diameter in diameters[sorted(nearest)]:
        of_size = [each for each in results["least"] if each["diameter_m"] == diameter]
        by_material = {each["material"]: each["powers_W"] for each in of_size}
        powers = [by_material[material][name] for material in MATERIALS for name in TIMES]
        rows.append([f"{1e6 * diameter:.2f}", *map(_milliwatts, powers)])
    return rows


def _milliwatts(power: float | None) -> str:
    return "never" if power is None else f"{1e3 * power:.3g}"


def _against_ensemble(each: Results) -> list[str]:
    light = ", linear light" if each["polarisation"] == "linear" else ""
    return [
        f"{1e6 * each['diameter_m']:g} um {each['material']}, {1e3 * each['power_W']:g} mW{light}",
        f"{each['depth_kT']:.1f}",
        f"{each['lifetime_s']:.3g} +- {each['lifetime_error_s']:.1g}",
        f"{each['ensemble_s']:.3g} +- {each['ensemble_error_s']:.1g}",
        f"{off(each):.1f}",
    ]


def off(each: Results) -> float:
    """Return the deviation of the ensemble's time from the lifetime, in standard deviations."""
    error = math.hypot(each["ensemble_error_s"], each["lifetime_error_s"])
    return float((each["ensemble_s"] - each["lifetime_s"]) / error)


@style.styled
def figure(results: Results) -> Figure:
    """Draw the trap depth over size and power, and the minimum powers, for each material."""
    drawn = style.new(style.PAGE, 3.4)
    panels = drawn.subplots(1, 2, sharex=True, sharey=True)
    colours: Any = None
    for panel, (material, found) in zip(panels, results["maps"].items(), strict=True):
        colours = _depths(panel, results, found)
        for name, line in LINES.items():
            points = [
                (1e6 * each["diameter_m"], each["powers_W"][name])
                for each in results["least"]
                if each["material"] == material and each["powers_W"][name] is not None
            ]
            wide = 2.0 if name == "1 h" else 1.0
            panel.plot(*zip(*points, strict=True), line, color="black", lw=wide, label=name)
        panel.set(xscale="log", yscale="log", xlabel="diameter (µm)", title=material)
        panel.set_ylim(LOWEST, max(results["powers_W"]))
        panel.set_xticks([0.2, 0.3, 0.5, 1, 2, 3], ["0.2", "0.3", "0.5", "1", "2", "3"])
        panel.minorticks_off()
    panels[0].set_ylabel("power through the pupil (W)")
    panels[0].legend(title="minimum power for a lifetime of", loc="lower left")
    drawn.colorbar(colours, ax=panels, label="escape work ($k_BT$)")
    return drawn


def _depths(panel: Axes, results: Results, found: Results) -> Any:
    """Draw the depth in colours, and grey where nothing is trapped."""
    depth = np.array(found["depth_kT"]).T
    held = np.isin(np.array(found["outcome"]).T, TRAPPED)
    panel.axhspan(min(results["powers_W"]), max(results["powers_W"]), color="0.8", lw=0)
    return panel.pcolormesh(
        1e6 * np.array(results["diameters_m"]), results["powers_W"],
        np.ma.masked_array(depth, ~held), norm=LogNorm(*DEPTHS), cmap="viridis",
        shading="nearest", rasterized=True,
    )  # fmt: skip


def block(results: Results) -> str:
    """Return the block: counts of traps, the figure, minimum powers and checked lifetimes."""
    cases = len(results["diameters_m"]) * len(results["powers_W"])
    told = []
    for material, found in results["maps"].items():
        outcomes = np.array(found["outcome"])
        short = sum(
            time is not None and time < TIMES["1 h"]
            for row, outcome in zip(found["lifetime_s"], outcomes, strict=True)
            for time, each in zip(row, outcome, strict=True)
            if each in TRAPPED
        )
        held = int(np.isin(outcomes, TRAPPED).sum())
        told.append(
            f"With {material}, {held:,} of {cases:,} scenes have a trap, and {short} of these lose "
            "their bead within an hour."
        )
    ratios = [
        each["powers_W"]["1 year"] / each["powers_W"]["1 h"]
        for each in results["least"]
        if None not in each["powers_W"].values()
    ]
    largest = max(
        each["errors_W"][name] / power
        for each in results["least"]
        for name, power in each["powers_W"].items()
        if power is not None
    )
    furthest = max(abs(off(each)) for each in results["ensembles"])
    explained = (
        f"The range is {1e3 * min(results['powers_W']):g} mW to {max(results['powers_W']):g} W and "
        f"{1e6 * min(results['diameters_m']):g} to {1e6 * max(results['diameters_m']):g} µm. "
        f"{' '.join(told)} The table contains the minimum powers through the pupil in mW. Their "
        f"errors are at most {100 * largest:.2g} %. A lifetime of a year requires "
        f"{min(ratios):.2g} to {max(ratios):.2g} times the power that a lifetime of an hour "
        "requires."
    )
    checked = (
        "Short lifetimes were compared with ensembles of "
        f"{results['ensembles'][0]['trajectories']:,} beads. The largest deviation is "
        f"{furthest:.1f} standard deviations:"
    )
    least, ensembles = tables(results)
    lines = [
        *textwrap.wrap(explained, 110), "",
        "![Trap depth of polystyrene and silica beads over size and power, with the minimum",
        "power for an hour and for a year](figures/bench-diagram.png)", "",
        *pages.tables([least]), *textwrap.wrap(checked, 110), "", *pages.tables([ensembles])[:-1],
    ]  # fmt: skip
    return pages.block("diagram", lines, results["machine"])


def write_numbers(results: Results) -> None:
    """Write the minimum powers with their errors to a file."""
    with NUMBERS.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["material", "diameter_um", "held_for", "least_power_mW", "error_mW"])
        for each in results["least"]:
            for name in TIMES:
                power, error = each["powers_W"][name], each["errors_W"][name]
                numbers = (
                    ["", ""] if power is None else [f"{1e3 * power:.4g}", f"{1e3 * error:.1g}"]
                )
                rows.writerow([each["material"], f"{1e6 * each['diameter_m']:.4g}", name, *numbers])


if __name__ == "__main__":
    pages.renew("diagram", block, figure)
    write_numbers(pages.committed("diagram"))
