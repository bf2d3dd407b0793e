"""The results of the benchmark of the fluid's inertia as tables, as a figure, and on their page.

`python -m tests.benchmarks.fluid_report` writes block and figure from the committed results.
"""

from __future__ import annotations

from statistics import median

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.fluid import Results
from tests.benchmarks.report import rounded
from tweezer.plots import style

#: what of the modes is compared, and how
_QUANTITIES = {
    "velocity": "velocity autocorrelation / (kT/M)",
    "displacement": "mean squared displacement",
    "spectrum": "PSD below 1 MHz",
    "relaxation": "relaxation in a trap",
    "tail": "tail to 1e5 τ_f",
}
#: edges of the viscosities that share a row of the reported errors, mPa s
_DECADES = ((1, 10), (10, 100), (100, 2000))


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of modes, captures, force calls, reported errors and thermal steps.

    Each table has its headings in the first row.
    """
    of_modes = [
        ["poles", *_QUANTITIES.values(), "time to find the modes, ms"],
        *(
            [f"{each['poles']}", *(f"{each[name]:.1e}" for name in _QUANTITIES),
             f"{1e3 * each['seconds']:.2f}"]
            for each in results["modes"]
        ),
    ]  # fmt: skip
    captures = [
        ["capture, until", "without memory, µm", "default poles, tolerance 1e-7", "tolerance 1e-9",
         *(f"{each['poles']} poles" for each in results["captures"][0]["by_poles"])],
        *(
            [
                f"{of['bead']}, {of['until_ms']:.0f} ms", f"{of['without_um']:.2g}",
                *(f"{each['error_um']:.1e} ({each['poles']})" for each in of["usual"]),
                *(f"{each['error_um']:.1e}" for each in of["by_poles"]),
            ]
            for of in results["captures"]
        ),
    ]  # fmt: skip
    calls = [
        ["capture, light", "tolerance", "force calls without memory", "with memory (poles)",
         "ratio", "ms without", "ms with"],
        *(
            [
                f"{of['bead']}, {of['theory']}", f"{of['tolerance']:.0e}",
                f"{of['none']['force_calls']}",
                f"{of['memory']['force_calls']} ({of['memory']['poles']})",
                f"{of['memory']['force_calls'] / of['none']['force_calls']:.2f}",
                rounded(of["none"]["ms"]), rounded(of["memory"]["ms"]),
            ]
            for of in results["calls"]
        ),
    ]  # fmt: skip
    told = [
        ["viscosity, mPa·s", "runs", "poles", "largest true error, nm", "runs reported below it",
         "reported / true, smallest", "median", "largest"],
        *(_told(results["told"]["runs"], low, high) for low, high in _DECADES),
    ]  # fmt: skip
    steps = [
        ["thermal step of heun, map", "ns", "time / time without memory"],
        *(
            [f"{of['poles']} poles" if of["poles"] else "without memory", f"{of['ns']:.0f}",
             f"{of['times']:.2f}"]
            for of in results["steps"]
        ),
    ]  # fmt: skip
    return [of_modes, captures, calls, told, steps]


def _told(runs: list[Results], low: float, high: float) -> list[str]:
    """Return the row of the runs with a viscosity from `low` up to `high`, mPa s."""
    within = [each for each in runs if low <= 1e3 * each["viscosity"] < high]
    ratios = [each["told_m"] / each["true_m"] for each in within]
    poles = [each["poles"] for each in within]
    return [
        f"{low:g} to {high:g}", f"{len(within)}", f"{min(poles)} to {max(poles)}",
        f"{1e9 * max(each['true_m'] for each in within):.1e}",
        f"{sum(ratio < 1 for ratio in ratios)}",
        *(f"{each:.2f}" for each in (min(ratios), median(ratios), max(ratios))),
    ]  # fmt: skip


@style.styled
def figure(results: Results) -> Figure:
    """Draw the errors of modes and of captures against the number of poles."""
    drawn = style.new(style.PAGE, 2.9)
    left, right = drawn.subplots(1, 2, sharex=True)
    poles = [each["poles"] for each in results["modes"]]
    for (name, label), mark in zip(_QUANTITIES.items(), style.SERIES, strict=False):
        values = [each[name] for each in results["modes"]]
        left.semilogy(poles, values, label=label.replace("τ_f", r"$\tau_f$"), **mark.both)
    left.set(xlabel="poles", ylabel="largest error, four beads")
    style.headroom(left, 0.35)
    left.legend(loc="upper right")
    for of, mark in zip(results["captures"], style.SERIES, strict=False):
        each = of["by_poles"]
        right.semilogy(
            [one["poles"] for one in each], [one["error_um"] for one in each],
            label=of["bead"], **mark.both,
        )  # fmt: skip
        right.axhline(of["without_um"], color=mark.colour, lw=0.8, ls="--")
    right.set(xlabel="poles", ylabel="position error of a capture (µm)")
    right.set_title("dashed: without fluid inertia")
    right.legend(loc="lower left")
    return drawn


def written(results: Results) -> str:
    """Return the block of the page."""
    lines = pages.tables(tables(results))
    lines.append(f"The reported errors were measured at commit {results['told']['commit']}.")
    return pages.block("fluid", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("fluid", written, figure)
