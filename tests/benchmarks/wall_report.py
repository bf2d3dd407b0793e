"""The results of the benchmark of thermal motion beside a wall as tables and figure, on their page.

`python -m tests.benchmarks.wall_report` writes block and figure from the committed results.
"""

from __future__ import annotations

from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.wall import OF_INERTIA, Results
from tweezer.plots import style

#: schemes by how they are called
_SCHEMES = {
    "heun": "plane, heun", "one-call": "plane, one call", "euler, drift": "Euler with drift",
    "fixman": "Fixman", "euler, no drift": "Euler, no drift",
}  # fmt: skip
_WALLS = {"none": "no wall", "one": "a wall", "two": "two walls"}


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of biases, passages, inertia and step rates."""
    bias = [
        _biases(results, key, heading)
        for key, heading in (
            ("mean", "bias of the mean gap, %: step / T"),
            ("low", "bias of the time below a tenth of it, %: step / T"),
        )
    ]
    passages = [
        ["passage, in mean gaps", "mean gap, radii", "exact time, s", "beads", "deviation, %"],
        *(
            [
                f"{of['begin']:g} to {of['end']:g}",
                f"{of['mean_gap']:g}" if of["mean_gap"] else "no weight",
                f"{of['exact_s']:.3g}", f"{of['beads']}", _with_error(of["off"], of["error"]),
            ]
            for of in results["passages"]
        ),
    ]  # fmt: skip
    inertia = [
        ["step / tau", "free flight, radii", "bias of the mean gap, %", "low, %"],
        *(
            [f"{of['ratio']:g}", f"{of['flight']:.2g}", _with_error(of["mean"], of["mean_error"]),
             _with_error(of["low"], of["low_error"])]
            for of in results["inertia"]
        ),
    ]  # fmt: skip
    steps = [
        ["step with the map", "walls", "ns", "rate / rate without a wall"],
        *(
            [f"{of['model']}, {of['method']}", _WALLS[of["walls"]], f"{of['ns']:.0f}",
             f"{of['rate']:.2f}"]
            for of in results["steps"]
        ),
    ]  # fmt: skip
    return [*bias, passages, inertia, steps]


def _biases(results: Results, key: str, heading: str) -> list[list[str]]:
    rows = [[heading, *_SCHEMES.values()]]
    for step in dict.fromkeys(each["step"] for each in results["bias"]):
        of = {each["scheme"]: each for each in results["bias"] if each["step"] == step}
        told = [_with_error(of[name][key], of[name][f"{key}_error"]) for name in _SCHEMES]
        rows.append([f"{step:g}", *told])
    return rows


def _with_error(value: float, error: float) -> str:
    return f"{value:+.1f} ± {error:.1f}"


@style.styled
def figure(results: Results) -> Figure:
    """Draw the biases of the mean gap against the step, and with inertia."""
    drawn = style.new(style.PAGE, 3.1)
    left, right = drawn.subplots(1, 2)
    steps = sorted({each["step"] for each in results["bias"]})
    for (name, label), mark in zip(_SCHEMES.items(), style.SERIES, strict=False):
        of = [each for each in results["bias"] if each["scheme"] == name]
        left.errorbar(
            [each["step"] for each in of], [abs(each["mean"]) for each in of],
            [each["mean_error"] for each in of], label=label, **mark.both,
        )  # fmt: skip
    left.axhline(1, color="grey", lw=1, ls="--")
    left.set(xscale="log", yscale="log", ylim=(1e-2, 100), xlabel="step / T",
             ylabel="bias of the mean gap (%)")  # fmt: skip
    left.set_xticks(steps, [f"{step:g}" for step in steps], minor=False)
    left.set_xticks([], minor=True)
    left.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3)
    of = results["inertia"]
    for mark, (key, label) in zip(
        style.SERIES, (("mean", "mean gap"), ("low", "time below a tenth of it")), strict=False
    ):
        right.errorbar(
            [each["ratio"] for each in of], [each[key] for each in of],
            [each[f"{key}_error"] for each in of], label=label, **mark.both,
        )  # fmt: skip
    right.axhspan(-1, 1, color=style.SHADE, lw=0, zorder=0)
    right.set(xscale="log", xlabel="step / relaxation time of the velocity",
              ylabel="bias (%)")  # fmt: skip
    right.set_title(f"with inertia, steps of {OF_INERTIA:g} T")
    right.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    return drawn


def written(results: Results) -> str:
    """Return the block of the page."""
    return pages.block("wall", pages.tables(tables(results))[:-1], results["machine"])


if __name__ == "__main__":
    pages.renew("wall", written, figure)
