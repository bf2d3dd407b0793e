"""The results of the integration benchmark as tables, as a figure, and on its page.

`python -m tests.benchmarks.integrate_report` writes its block and its figure from the
committed results.
"""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tests.benchmarks import pages
from tests.benchmarks.integrate import HEADLINE, Results
from tests.benchmarks.report import rounded
from tweezer.plots import style

_STYLES = {
    ("full", "exponential"): (style.SERIES[0].colour, "o", "unscaled, exponential"),
    ("first-order", "dop853"): ("#228833", "D", "first order, DOP853"),
    ("first-order", "dormand-prince"): ("#66ccaa", "d", "first order, Dormand-Prince"),
    ("overdamped", "dop853"): ("#bbbbbb", "s", "no inertia, DOP853"),
    ("full", "dormand-prince"): ("#aa3377", "^", "unscaled, Dormand-Prince"),
    ("full", "dop853"): ("#aa3377", "v", "unscaled, DOP853"),
    ("full", "LSODA"): ("#ee6677", "x", "SciPy LSODA, by address"),
    ("full", "odeint"): ("#cc3311", "1", "SciPy odeint, by address"),
    ("full", "Radau"): ("#ee8866", "+", "SciPy Radau, by address"),
    ("full", "CVODE"): ("#6699cc", "<", "CVODE, by address"),
    ("full", "diffrax"): ("#225522", ">", "diffrax Kvaerno5, by address"),
    ("full", "scipy:LSODA"): ("#997700", "2", "SciPy LSODA, through Python"),
    ("full", "scipy:Radau"): ("#eedd88", "3", "SciPy Radau, through Python"),
    ("full", "heyoka"): ("#000000", "*", "heyoka, closed form"),
    ("scaled", "dormand-prince"): ("#ddaa33", "P", "thesis's scaling, ε to 1, Dormand-Prince"),
    ("scaled", "numpy"): ("#bb5566", "X", "NumPy sum, SciPy RK45, thesis's scaling"),
}
#: Columns of the table of others
_OTHERS = {
    "LSODA": "SciPy LSODA", "odeint": "odeint", "CVODE": "CVODE", "Radau": "Radau",
    "diffrax": "diffrax", "scipy:LSODA": "LSODA through Python",
    "scipy:Radau": "Radau through Python", "heyoka": "heyoka",
}  # fmt: skip
#: Panels of a row of the figure
_COLUMNS = 4


def tables(results: Results) -> list[list[list[str]]]:
    """Return a table for each motion, and a table of omitted runs."""
    entries = [
        [
            [label, "tolerance", "error before, µm", "in the trap, µm", "ms", "force calls"],
            *(
                [
                    f"{entry['model']}, {entry['method']}", _setting(entry),
                    f"{entry['before_um']:.1e}", f"{entry['during_um']:.1e}",
                    rounded(entry["ms"]), f"{entry['force_calls'] or ''}",
                ]
                for entry in of["entries"]
            ),
        ]
        for label, of in results["motions"].items()
    ]  # fmt: skip
    return [*entries, pages.as_table(left_out(results))]


def converged(entries: list[dict[str, Any]], model: str) -> dict[str, Any]:
    """Return the run with DOP853's tightest tolerance, whose error is the model's own."""
    return min(
        (each for each in entries if (each["model"], each["method"]) == (model, "dop853")),
        key=lambda each: each["tolerance"],
    )


def _setting(entry: dict[str, Any]) -> str:
    if "scaling_factor" in entry:
        return f"a2 = {entry['scaling_factor']:.2g}"
    return f"{entry['tolerance']:.0e}"


@style.styled
def figure(results: Results) -> Figure:
    """Draw the error in the trap against time for each motion, and for some against force calls."""
    motions = {label: of for label, of in results["motions"].items() if "quadrature" not in label}
    by_calls = [label for label, of in motions.items() if "least_force_calls" in of][:_COLUMNS]
    panels = [(label, "ms") for label in motions] + [(label, "force_calls") for label in by_calls]
    rows = -(-len(panels) // _COLUMNS)
    drawn = style.new(style.PAGE, 1.95 * rows + 1.3)
    each = drawn.subplots(rows, _COLUMNS, sharey=True, squeeze=False).ravel()
    for axes in each[len(panels) :]:
        axes.remove()
    for axes, (label, key) in zip(each, panels, strict=False):
        _draw(axes, motions[label]["entries"], key)
        named = label.replace("rays", "ray optics").replace("waves", "wave optics")
        axes.set_title(named.replace(", ", ",\n", 1))
        axes.set_xlabel("time (ms)" if key == "ms" else "force calls")
    for axes in each[: len(panels) : _COLUMNS]:
        axes.set_ylabel("largest error in the trap (µm)")
    handles = [
        Line2D([], [], color=colour, marker=marker, linewidth=1, markersize=3.5, label=label)
        for colour, marker, label in _STYLES.values()
    ]
    drawn.legend(handles=handles, loc="outside lower center", ncols=3)
    return drawn


def _draw(axes: Axes, entries: list[dict[str, Any]], key: str) -> None:
    for (model, method), (colour, marker, _) in _STYLES.items():
        named = [e for e in entries if (e["model"], e["method"]) == (model, method) and e[key] > 0]
        if named:
            axes.plot(
                [e[key] for e in named], np.maximum([e["during_um"] for e in named], 1e-10),
                color=colour, marker=marker, linewidth=1, markersize=3.5,
            )  # fmt: skip
    axes.set(xscale="log", yscale="log")
    axes.grid(visible=True)


def block(results: Results) -> str:
    """Return the block: own runs, other solvers, the NumPy baseline and the error estimate."""
    before, during = HEADLINE[1], HEADLINE[0]
    limits = f"Error limits: {before:.0e} µm before the trap, {during:.0e} µm in the trap."
    headings = ("motion, force", "two solvers agree to, µm", "tolerance", "error before, µm",
                "in the trap, µm", "ms", "force calls", "minimum", "calls / minimum")  # fmt: skip
    lines = [limits, "", *pages.markdown(headings, _own(results)), ""]
    named = [key for key in _OTHERS if any(key in of for of in results["headline"].values())]
    lines += pages.markdown(
        ("time / tweezer's time", *(_OTHERS[key] for key in named)),
        [
            (label, *(_times_slower(of.get(key)) for key in named))
            for label, of in results["headline"].items()
        ],
    )
    lines += ["", *pages.markdown(
        ("NumPy, SciPy, scaled", "its error, µm", "s", "tweezer's error, µm", "ms", "time ratio"),
        [
            (label, f"{of['numpy']['error_um']:.1e}", rounded(1e-3 * of["numpy"]["ms"]),
             f"{of['numpy']['our_error_um']:.1e}", rounded(of["numpy"]["ours_ms"]),
             rounded(of["numpy"]["ms"] / of["numpy"]["ours_ms"]))
            for label, of in results["headline"].items()
            if "numpy" in of
        ],
    )]  # fmt: skip
    estimated = results["estimate"]
    honest = (
        "The estimate of the integration error was compared with the true error. The test used "
        f"{estimated['scenes']} random scenes with ray and wave optics: radius 0.1 to 3 µm, "
        "release up to 6 radii away, models `full`, `scaled` and `overdamped`, tolerances 1e-5 to "
        f"1e-9. In {estimated['below_the_truth']} of them the run is more accurate than the "
        f"reference. The ratio of estimate to error is at least {rounded(estimated['least'])}, "
        f"{rounded(estimated['median'])} in the median, {rounded(estimated['tenth'])} to "
        f"{rounded(estimated['nine_tenths'])} for eight scenes of ten, and at most "
        f"{rounded(estimated['largest'])}. Estimates below a third of the error: "
        f"{len(estimated['too_small'])}. Failed runs: {estimated['failed']}."
    )
    absent = "; ".join(f"{name} {why}" for name, why in results["missing"].items())
    lines += [
        "", *textwrap.wrap(honest, 110),
        "", *textwrap.wrap(f"Not compared: {absent}.", 110),
        *left_out(results),
    ]  # fmt: skip
    return pages.block("integrate", lines, results["machine"])


def _own(results: Results) -> list[tuple[str, ...]]:
    """Return the rows of the exponential method's own table."""
    rows = []
    for label, of in results["headline"].items():
        agree = f"{of['solvers_agree_to_um']:.1e}" if "solvers_agree_to_um" in of else ""
        best, least = of["full"], of.get("least_force_calls")
        if best is None:
            rows.append((label, agree, "not reached", *[""] * 6))
            continue
        rows.append(
            (
                label, agree, f"{best['tolerance']:.0e}", f"{best['before_um']:.1e}",
                f"{best['during_um']:.1e}", rounded(best["ms"]), f"{best['force_calls']}",
                f"{least}" if least else "",
                rounded(best["force_calls"] / least) if least else "",
            )
        )  # fmt: skip
    return rows


def _times_slower(of: dict[str, Any] | None) -> str:
    if of is None:
        return ""
    spread = f"({rounded(of['least_times_slower'])} to {rounded(of['most_times_slower'])})"
    return f"{rounded(of['times_slower'])} {spread}" if of["times_slower"] else spread


def left_out(results: Results) -> list[str]:
    """Return a list of omitted runs, by reason and motion."""
    grouped: dict[str, dict[str, list[str]]] = {}
    for each in results["left_out"]:
        scaled = f", a2 = {each['scaling_factor']:.2g}" if "scaling_factor" in each else ""
        named = f"{each['model']}{scaled} by {each['method']}"
        grouped.setdefault(each["left_out"], {}).setdefault(each["motion"], []).append(named)
    return pages.left_out(grouped)


if __name__ == "__main__":
    pages.renew("integrate", block, figure)
