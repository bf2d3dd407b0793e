"""The plan for more machines as tables, as a figure, and on its page.

`python -m tests.benchmarks.scaling_report` writes its block and its figure anew from the committed
results.
"""

from __future__ import annotations

import re
import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.pages import Results
from tests.benchmarks.report import rounded
from tests.benchmarks.scaling import CORES, STATISTICS
from tweezer.plots import style

_UNITS = (("years", 365.25 * 86400.0), ("days", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 1.0))


def duration(seconds: float) -> str:
    """In the largest unit of which it is one or more, two digits."""
    name, size = next(((name, size) for name, size in _UNITS if seconds >= size), _UNITS[-1])
    return f"{rounded(seconds / size)} {name}"


def tables(results: Results) -> list[list[list[str]]]:
    """By model, by what is kept, costs and checks; the first row is that of the headings."""
    return [_by_model(results), _by_kind(results), _costs(results), _checks(results)]


def _by_model(results: Results) -> list[list[str]]:
    """Statistics by model and method; the first row is that of the headings."""
    table = [["statistics, 10^6 beads, 10^9 steps", "million steps per second and core",
              "core-hours", *(f"{cores:,} cores" for cores in CORES)]]  # fmt: skip
    for each in results["models"]:
        times = (duration(each["seconds"][str(cores)]) for cores in CORES)
        table.append(
            [each["model"], rounded(1e-6 * each["steps_per_s"]), f"{each['core_hours']:,.0f}",
             *times]
        )  # fmt: skip
    return table


def _by_kind(results: Results) -> list[list[str]]:
    """Time, efficiency and walls by what is kept; the first row is that of the headings."""
    table = [["full, heun", *(f"{cores:,} cores" for cores in CORES), "efficiency at 10,000",
              "stored, TB", "time of a block, s", "most cores by blocks",
              "most cores by the file system", "most cores by the process in charge"]]  # fmt: skip
    for each in results["plan"]:
        entries = {entry["cores"]: entry for entry in each["cores"]}
        table.append(
            [
                each["kind"], *(duration(entries[cores]["seconds"]) for cores in CORES),
                f"{100 * entries[CORES[-1]]['efficiency']:.0f} %", rounded(each["terabytes"]),
                rounded(each["block_s"]),
                *(f"{float(rounded(most)):,.0f}" for most in each["most_cores"].values()),
            ]
        )  # fmt: skip
    return table


def _costs(results: Results) -> list[list[str]]:
    """What was measured; the first row is that of the headings."""
    table = [["measured here", ""]]
    blocks = results["blocks"]
    for kind in ("statistics", "trajectories"):
        of = blocks[f"{kind}, short blocks"]
        beside = of["worker_s"] - of["steps"] / results["steps_per_s"]["full, heun"]
        table += [
            [f"{kind}: further time of a block in its worker", f"{rounded(1e3 * beside)} ms"],
            [
                f"{kind}: time of a block in the process in charge",
                f"{rounded(1e3 * of['client_s'])} ms",
            ],
            [f"{kind}: fixed time of an ensemble", f"{rounded(of['once_s'])} s"],
        ]
    table.append(["a task of the scheduler", f"{rounded(1e3 * results['task_s'])} ms"])
    table += [
        [f"a checkpoint of {each['bytes'] / 1e6:g} MB", f"{rounded(1e3 * each['written_s'])} ms"]
        for each in results["files"]
    ]
    (gathered,) = (each for each in results["plan"] if each["kind"] == STATISTICS.label)
    table += [
        ["statistics of a block", f"{rounded(1e-6 * gathered['checkpoint_bytes'])} MB"],
        ["a number of a trajectory, stored", f"{results['bytes_per_number']:.2f} bytes"],
    ]
    rates = {each["beads"]: each["steps_per_s"] for each in results["beads_of_a_block"]}
    table += [
        [f"rate of a block of {beads} bead{'s' if beads > 1 else ''}, relative to 64 beads",
         f"{100 * rate / rates[64]:.0f} %"]
        for beads, rate in rates.items()
        if beads < 64
    ]  # fmt: skip
    return table


def _checks(results: Results) -> list[list[str]]:
    """Ensembles on Dask workers, measured and modelled; the first row is that of the headings."""
    return [
        ["ensemble", "Dask workers", "measured, s", "modelled, s"],
        *(
            [each["blocks"], str(each["workers"]), rounded(each["measured_s"]),
             rounded(each["modelled_s"])]
            for each in results["checks"]
        ),
    ]  # fmt: skip


@style.styled
def figure(results: Results) -> Figure:
    """Time and efficiency against cores, by what is kept."""
    drawn = style.new(style.PAGE, 3.3)
    times, efficiencies = drawn.subplots(1, 2, sharex=True)
    for mark, each in zip(style.SERIES, results["plan"], strict=False):
        cores = [entry["cores"] for entry in each["cores"]]
        hours = [entry["seconds"] / 3600 for entry in each["cores"]]
        efficiency = [entry["efficiency"] for entry in each["cores"]]
        times.loglog(cores, hours, label=_powers(each["kind"]), **mark.both)
        efficiencies.semilogx(cores, efficiency, **mark.both)
    _finish(times, "time (h)")
    _finish(efficiencies, "efficiency")
    style.legend_below(drawn, 3, handles=times.get_lines())
    efficiencies.set_ylim(0, 1.05)
    drawn.suptitle(f"{_powers('10^15')} steps, full model, heun: modelled; some curves coincide")
    return drawn


def _powers(text: str) -> str:
    """With raised exponents."""
    return re.sub(r"10\^(\d+)", r"$10^{\1}$", text)


def _finish(axes: Axes, label: str) -> None:
    axes.set(xlabel="cores", ylabel=label)
    axes.grid(visible=True)


def block(results: Results) -> str:
    """The page's part, between its markers."""
    lines = pages.tables(tables(results))
    ratios = [each["measured_s"] / each["modelled_s"] for each in results["checks"]]
    told = (
        f"The measured time is {rounded(min(ratios))} to {rounded(max(ratios))} times the modelled "
        f"time. During the measurement {rounded(results['load_per_core'])} processes competed for "
        "each core. With more than one, costs are overestimated, and ensembles are slower than "
        "when they run alone."
    )
    lines += [*textwrap.wrap(told, 110), ""]
    lines.append("![Time and efficiency against cores](figures/bench-scaling.png)")
    return pages.block("scaling", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("scaling", block, figure)
