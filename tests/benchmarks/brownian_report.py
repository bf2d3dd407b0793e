"""The results of the benchmark of Brownian motion as tables, as a figure, and on its page.

`python -m tests.benchmarks.brownian_report` writes its block and its figure from the
committed results.
"""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tests.benchmarks import pages
from tests.benchmarks.brownian import HARMONIC, MILD, STEP, Results, Way, way_of
from tests.benchmarks.report import rounded
from tweezer.plots import style

_STYLES = {
    Way("full", "heun", spring=True): (style.SERIES[0].colour, "o", "-"),
    Way("full", "heun"): ("#6699cc", "o", ":"),
    Way("full", "one-call"): ("#997700", "D", "-"),
    Way("full", "euler-maruyama"): ("#bb5566", "X", "-"),
    Way("full", "baoab"): ("#aa3377", "P", "-"),
    Way("overdamped", "heun", spring=True): ("#228833", "s", "--"),
    Way("overdamped", "heun"): ("#99bb88", "s", ":"),
    Way("overdamped", "one-call"): ("#eecc66", "d", "--"),
    Way("overdamped", "euler-maruyama"): ("#ee99aa", "x", "--"),
    Way("first-order", "heun", spring=True): ("#555555", "^", "--"),
}

#: evaluation of the force in NumPy
_SHORT = {"table": "force map", "closed form": "closed form"}
#: ways that must resolve the relaxation time
_RESOLVING = (Way("full", "euler-maruyama"), Way("full", "baoab"))


def _bias(entry: dict[str, Any], key: str) -> str:
    """Return a bias in percent with its standard error, which has one digit."""
    if f"{key}_bias" not in entry:
        return ""
    value, error = 100 * entry[f"{key}_bias"], 100 * entry[f"{key}_error"]
    if error < 1e-4:
        return f"{value:z.3f}"
    digits = max(0, -math.floor(math.log10(error)))
    return f"{value:z.{digits}f} ± {error:.{digits}f}"


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of methods, NumPy, ensembles and omitted runs."""
    return [*_measured(results), pages.as_table(left_out(results))]


def _measured(results: Results) -> list[list[list[str]]]:
    return [_by_way(results), *_by_part(results), _against_numpy(results), _apart(results)]


def _by_part(results: Results) -> list[list[list[str]]]:
    """Return the table of the times of a step and its parts, if they were measured."""
    if "parts" not in results:
        return []
    heading = ["one step of a bead and its parts, one core, shortest time", "ns"]
    return [[heading, *([name, rounded(ns)] for name, ns in results["parts"].items())]]


def _by_way(results: Results) -> list[list[str]]:
    """Return the table of rates, and of biases at the step of the headline."""
    names = [name for name in results["wells"] if name != HARMONIC]
    found = {
        (way_of(entry), name): entry
        for name, entries in results["wells"].items()
        for entry in entries
        if entry["step_trap_times"] == STEP
    }
    table = [
        [f"bias at a step of {STEP:g} relaxation times, %", "million steps per second",
         *(f"⟨x²⟩, {name}" for name in names), f"corner frequency, {MILD}"],
    ]  # fmt: skip
    rates = {(each["model"], each["method"]): each["steps_per_s"] for each in results["rates"]}
    for way in (*_STYLES, Way("full", "harmonic"), Way("overdamped", "harmonic")):
        biases = [_bias(found.get((way, name), {}), "x2") for name in names]
        corner = _bias(found.get((way, MILD), {}), "corner")
        table.append([way.label, rounded(1e-6 * rates[way[:2]]), *biases, corner])
    return table


def _against_numpy(results: Results) -> list[list[str]]:
    """Return the table of Euler-Maruyama's cost for the same error."""
    table = [
        ["tweezer: scheme, well, step in relaxation times", "error of ⟨x²⟩, %",
         "Euler-Maruyama's step, velocity relaxation times", "its error of ⟨v²⟩, %",
         "ratio of steps",
         "NumPy time / tweezer time: closed form", "force map", "sum over 7644 rays",
         "compiled time / tweezer time, force map"],
    ]  # fmt: skip
    for each in results["headline"]["cheaper"]:
        cheaper = each["times_cheaper"]
        table.append(
            [
                f"{each['method']}, {each['well']}, {each['step_trap_times']:g}",
                rounded(100 * each["bias"]), rounded(each["euler_maruyama_step_relaxation_times"]),
                rounded(100 * each["euler_maruyama_v2_bias"]), rounded(each["times_fewer_steps"]),
                *(rounded(cheaper[by]["numpy"]) for by in ("closed form", "table", "ray sum")),
                rounded(cheaper["table"]["euler-maruyama"]),
            ]
        )  # fmt: skip
    return table


def _apart(results: Results) -> list[list[str]]:
    """Return the table of ensembles and of the first step in a new process."""
    lines = [["ensembles with statistics; first step", ""]]
    for key, what in (
        ("two_threads_over_one", "two threads / one"),
        ("two_dask_workers_over_one", "two Dask workers / one"),
    ):
        value = results["headline"][key]
        lines.append([f"{what}, ratio of rates", f"{value:.2f}" if value else "not measured"])
    lines += [
        [
            f"peak memory, {of['trajectories']:,} trajectories of 5 samples",
            f"{of['peak_mb']:.0f} MB",
        ]
        for of in results["memory"]
    ]
    fresh = results["fresh_process"]
    for key, what in (
        ("empty_cache", "binding and a step, including compilation"),
        ("warm_cache", "the same, compiled earlier"),
    ):
        if key in fresh:
            seconds = fresh[key]["bind_s"] + fresh[key]["first_step_s"]
            lines.append([f"new process: {what}", f"{rounded(seconds)} s"])
    return lines


def left_out(results: Results) -> list[str]:
    """Return a list of runs that failed or were omitted, by reason and well."""
    steps: dict[tuple[str, str, str], list[str]] = {}
    for each in results["left_out"]:
        where, _, what = each["what"].rpartition(": ")
        at = steps.setdefault((each["why"], where, what), [])
        if "step_trap_times" in each:
            at.append(f"{each['step_trap_times']:.3g}")
    grouped: dict[str, dict[str, list[str]]] = {}
    for (why, where, what), at in steps.items():
        named = f"{what} at {' and '.join(at)}" if at else what
        grouped.setdefault(why, {}).setdefault(where, []).append(named)
    return pages.left_out(grouped, "; steps in relaxation times")


@style.styled
def figure(results: Results) -> Figure:
    """Draw the rates, and the biases in the mild well against step and cost."""
    drawn = style.new(style.PAGE, 7.4)
    panels = drawn.subplots(3, 2).reshape(2, 3)
    entries = results["wells"][MILD]
    _draw_rates(panels[0, 0], results["rates"])
    for axes, key, what in (
        (panels[0, 1], "x2", "⟨x²⟩"), (panels[1, 0], "v2", "⟨v²⟩"),
        (panels[1, 1], "corner", "$f_c$"),
    ):  # fmt: skip
        _draw(axes, entries, key, "step_trap_times")
        axes.set(xlabel="step (relaxation times)", ylabel=f"|relative bias of {what}|")
    _draw(panels[0, 2], entries, "x2", "us_per_trap_time")
    _draw_baseline(panels[0, 2], results)
    panels[0, 2].set(
        xlabel="computing time per relaxation time (µs)", ylabel="|relative bias of ⟨x²⟩|"
    )
    style.add_title(drawn, f"Biases in the well: {MILD}")
    _draw_scaling(panels[1, 2], results)
    handles = [
        Line2D([], [], color=colour, marker=marker, linestyle=line, linewidth=1, label=way.label)
        for way, (colour, marker, line) in _STYLES.items()
    ]
    handles += [
        Line2D([], [], color="0.4", marker="o", linestyle="", markerfacecolor="white",
               label="below two standard errors, drawn there"),
        Line2D([], [], color=style.MUTED, linestyle="--", linewidth=0.8,
               label="median of two standard errors"),
        *panels[0, 2].get_lines()[-2:],
    ]  # fmt: skip
    drawn.legend(handles=handles, loc="outside lower center", ncols=3)
    return drawn


def _draw_rates(axes: Axes, rates: list[dict[str, Any]]) -> None:
    labels = [f"{each['model']}, {each['method']}" for each in rates]
    axes.barh(labels, [1e-6 * each["steps_per_s"] for each in rates], color=style.SERIES[4].colour)
    axes.invert_yaxis()
    axes.set(xlabel="million steps per second, one core")
    axes.grid(axis="x", visible=True)


def _draw(axes: Axes, entries: list[dict[str, Any]], key: str, against: str) -> None:
    """Draw the size of the bias, or a hollow mark at two standard errors if it is smaller.

    Dashed: the median of two standard errors of what takes steps longer than tau.
    """
    floor: dict[float, list[float]] = {}
    for way, (colour, marker, line) in _STYLES.items():
        own = sorted(
            (e for e in entries if way_of(e) == way and f"{key}_bias" in e),
            key=lambda e: e[against],
        )
        if not own:
            continue
        at = np.array([e[against] for e in own])
        bias = np.array([abs(e[f"{key}_bias"]) for e in own])
        twice = np.array([2 * e[f"{key}_error"] for e in own])
        lost = bias < twice
        shown = np.where(lost, twice, bias)
        axes.plot(at, shown, color=colour, linestyle=line, linewidth=1)
        for of, face in ((~lost, colour), (lost, "white")):
            axes.plot(
                at[of], shown[of], color=colour, marker=marker, linestyle="", markersize=3.5,
                markerfacecolor=face,
            )  # fmt: skip
        if way not in _RESOLVING:
            for step, of in zip(at, twice, strict=True):
                floor.setdefault(step, []).append(of)
    if against == "step_trap_times":
        steps = sorted(floor)
        axes.plot(
            steps, [np.median(floor[step]) for step in steps], color="0.4", linestyle="--",
            linewidth=1,
        )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.grid(visible=True)


def _draw_baseline(axes: Axes, results: Results) -> None:
    """Draw Euler-Maruyama in NumPy in a harmonic trap, where its bias is known."""
    bias, trap = results["baseline"]["euler_maruyama_harmonic"], results["trap"]
    steps = np.array(bias["steps_relaxation_times"]) * trap["relaxation_time_s"]
    for name, line in (("table", "-"), ("closed form", ":")):
        ns = results["baseline"]["ns_per_step"][name]["numpy"]
        axes.plot(
            1e-3 * ns * trap["trap_time_s"] / steps, bias["x2_bias"], color="black",
            linewidth=1, linestyle=line, label=f"Euler-Maruyama in NumPy, {_SHORT[name]}",
        )  # fmt: skip


def _draw_scaling(axes: Axes, results: Results) -> None:
    axes.axis("off")
    lines = [
        *(
            (f"{each['kind']}: {each['count']}", f"{1e-6 * each['steps_per_s']:.1f} M steps/s",
             f"ratio {each['times_one']:.2f}")
            for each in results["cores"]
        ),
        *(
            (f"{each['trajectories']:,} trajectories", f"{each['peak_mb']:.0f} MB at the peak", "")
            for each in results["memory"]
        ),
    ]  # fmt: skip
    table = axes.table(
        cellText=lines, loc="center", cellLoc="left", edges="open", colWidths=[0.5, 0.32, 0.22]
    )
    table.auto_set_font_size(False)
    table.set_fontsize(style.SMALL)
    table.scale(1.0, 1.3)
    axes.set_title("ensembles with statistics: full, heun")


def block(results: Results) -> str:
    """Return the block: the trap's times, the tables, and what was omitted."""
    trap = results["trap"]
    times = (
        f"The trap's relaxation time is {1e6 * trap['trap_time_s']:.0f} µs. The "
        f"velocity's relaxation time is {1e9 * trap['relaxation_time_s']:.0f} ns."
    )
    lines = [
        *textwrap.wrap(times, 110), "", *pages.tables(_measured(results))[:-1], *left_out(results)
    ]  # fmt: skip
    return pages.block("brownian", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("brownian", block, figure)
