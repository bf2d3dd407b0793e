"""The results of the benchmark of rods as tables, as a figure, and on their page.

`python -m tests.benchmarks.rods_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.report import rounded
from tests.benchmarks.rods import BINS, EVERY, Results
from tweezer.plots import style

#: Largest time of a step over the time of two force calls, and error of the driven top, %
_RATIO, _TOP = 1.5, 0.3
#: Half width of an interval of 95 %, standard errors
_WIDE = 1.96


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of goals, two traps, one trap, and rotation."""
    return [
        _goals(results), _hopping(results), _one_trap(results), _rotation(results)
    ]  # fmt: skip


def _goals(results: Results) -> list[list[str]]:
    top, turned = results["top"], results["rotations"]
    rows = [
        ["time of a step / two force calls", f"{_RATIO}", f"{results['time']['ratio']:.2f}"],
        [
            "share of an angle, opposed beams, deviation / standard error", "4",
            rounded(max(abs(each) for each in _scores(_conservative(results)))),
        ],
        *(
            [
                f"{what} of the driven top, deviation, %", f"{_TOP} + sampling",
                _signed([100 * each for each in top[f"{key}_deviation"]]),
            ]
            for what, key in (("mean rotation", "rotation"), ("heat flow", "heat"))
        ),
        [
            f"error of the length of e after {turned['turns']:.0e} turns", "1e-15",
            f"{turned['length_error']:.0e}",
        ],
    ]  # fmt: skip
    return [["quantity", "goal", "measured"], *rows]


def _conservative(results: Results) -> Results:
    """Return the trap of opposed beams."""
    return dict(results["one_trap"][-1])


def _scores(trap: Results, path: int = 0) -> list[float]:
    """Return the deviation of each share from the energies, in standard errors."""
    run = trap["runs"][0]
    return [
        (share - expected) / error
        for (share, error), expected in zip(
            run["shares"], trap["shares_by_energy"][path], strict=True
        )
    ]


def _signed(value: list[float], digits: int = 2) -> str:
    """Return a value and its standard error."""
    return f"{value[0]:+.{digits}f} +- {value[1]:.{digits}f}"


def _interval(value: list[float], digits: int = 2) -> str:
    """Return a value and the half width of its interval of 95 %."""
    return f"{value[0]:.{digits}f} +- {_WIDE * value[1]:.{digits}f}"


def _paths(values: list[float], digits: int = 2) -> str:
    """Return what the energies by two paths give, once if they agree."""
    shown = [f"{value:.{digits}f}" for value in values]
    return " or ".join(dict.fromkeys(shown))


def _hopping(results: Results) -> list[list[str]]:
    entries = results["hopping"]
    rows = [
        [
            "energy, difference of paths, kT",
            *(rounded(each["path_rms_kT"]) for each in entries),
        ],
        ["depth of the left trap, kT", *(_paths(each["barrier_kT"]) for each in entries)],
        ["steps", *(f"{each['steps']:.1e}" for each in entries)],
        ["followed, s", *(f"{each['followed_s']:.0f}" for each in entries)],
        ["hops", *(f"{each['hops']}" for each in entries)],
        ["hops per second", *(_interval(each["hops_per_s"]) for each in entries)],
        ["at most, by energy", *(_paths(each["hops_at_most_per_s"]) for each in entries)],
        ["flips", *(f"{each['flips']}" for each in entries)],
        ["flips per second", *(_interval(each["flips_per_s"]) for each in entries)],
        ["at most, by energy", *(_paths(each["flips_at_most_per_s"]) for each in entries)],
        ["time right / left", *(_interval(each["right_over_left"]) for each in entries)],
        ["by energy", *(_paths(each["right_over_left_by_energy"]) for each in entries)],
        ["mean of n_x^2", *(_interval(each["aligned"], 4) for each in entries)],
        ["by energy", *(_paths(each["aligned_by_energy"], 4) for each in entries)],
        ["µs per step", *(rounded(each["us_per_step"]) for each in entries)],
        ["processor time, s", *(rounded(each["cpu_s"]) for each in entries)],
    ]
    return [["two traps", *(each["beams"] for each in entries)], *rows]


def _one_trap(results: Results) -> list[list[str]]:
    entries = results["one_trap"]
    rows = [
        ["energy, difference of paths, kT", *(rounded(each["path_rms_kT"]) for each in entries)]
    ]
    for k, axis in enumerate("xyz"):
        by_energy = (
            _paths([each[k] for each in entry["mean_squares_by_energy"]], 4) for entry in entries
        )
        rows.append([f"mean of n_{axis}^2 by energy", *by_energy])
        for run, step in enumerate(("step", "half the step")):
            measured = (_signed(entry["runs"][run]["mean_squares"][k], 4)[1:] for entry in entries)
            rows.append([f"measured, {step}", *measured])
    rows += [
        [
            "shares, largest deviation / standard error",
            *(
                " or ".join(rounded(max(abs(each) for each in _scores(entry, path)))
                            for path in ((0, 1) if entry["path_rms_kT"] > 0.01 else (0,)))
                for entry in entries
            ),
        ],
        ["steps", *(f"{each['runs'][0]['steps']:.1e}" for each in entries)],
        ["processor time, s", *(rounded(each["runs"][0]["seconds"]) for each in entries)],
    ]  # fmt: skip
    return [["one trap", *(each["beams"] for each in entries)], *rows]


def _rotation(results: Results) -> list[list[str]]:
    turned, time = results["rotations"], results["time"]
    return [
        ["rotation and time", "value"],
        ["turns by fixed twists", f"{turned['turns']:.2e}"],
        ["largest error of the length of e", f"{turned['length_error']:.1e}"],
        ["error of the orientation, rad", f"{turned['orientation_error_rad']:.1e}"],
        ["thermal updates of a free rod", f"{turned['thermal_updates']:.0e}"],
        ["their largest error of the length", f"{turned['thermal_length_error']:.1e}"],
        ["one update, ns", rounded(turned["ns_per_update"])],
        ["step in one trap, µs", rounded(time["step_us"])],
        ["two force calls, µs", rounded(time["two_calls_us"])],
    ]


@style.styled
def figure(results: Results) -> Figure:
    """Draw a trajectory in two traps, and the distribution of the angle in one trap."""
    drawn = style.new(style.PAGE, 4.2)
    (position, angle), (upwards, opposed) = drawn.subplots(2, 2)
    entry = results["hopping"][0]
    x, n = np.array(entry["trace"])
    t = np.arange(len(x)) * EVERY * results["step_s"]
    colour = style.SERIES[0].colour
    for axes, values, core, label in (
        (position, 1e6 * x, 1e6 * results["cores"]["x"], "x (µm)"),
        (angle, n, results["cores"]["n_x"], "axis along x, $n_x$"),
    ):
        axes.plot(t, values, ",", color=colour)
        axes.plot(t, values, lw=0.3, color=colour)
        for limit in (-core, core):
            axes.axhline(limit, color=style.MUTED, lw=0.8, ls="--")
        axes.set(xlabel="time (s)", ylabel=label, xlim=(0, t[-1]))
    position.set_title(f"two traps, {entry['beams']}")
    angle.set_title("flips of the axis")
    for axes, trap in zip((upwards, opposed), results["one_trap"], strict=False):
        _draw_shares(axes, trap)
    upwards.set_ylabel("share per degree")
    return drawn


def _draw_shares(axes: Axes, trap: Results) -> None:
    """Draw measured shares of the angle and those of the energies by both paths."""
    width = np.diff(BINS)
    middle = (BINS[1:] + BINS[:-1]) / 2
    share, error = np.array(trap["runs"][0]["shares"]).T / width
    axes.errorbar(
        middle, share, _WIDE * error, ls="", marker=".", color=style.SERIES[0].colour,
        label="measured, 95 %",
    )  # fmt: skip
    for path, mark, name in zip(
        trap["shares_by_energy"], style.SERIES[1:], ("rotated first", "rotated last"), strict=False
    ):
        axes.plot(middle, np.array(path) / width, label=f"energy, {name}", **mark.curve)
    axes.set(xlabel="angle to the polarisation (°)", xlim=(0, 90), ylim=(0, None))
    axes.set_title(f"one trap, {trap['beams']}")
    axes.legend()


def block(results: Results) -> str:
    """Return the block with all tables."""
    return pages.block("rods", pages.tables(tables(results))[:-1], results["machine"])


if __name__ == "__main__":
    pages.renew("rods", block, figure)
