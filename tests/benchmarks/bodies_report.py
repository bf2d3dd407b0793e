"""The results of the benchmark of light on bodies as tables, as a figure, and on their page.

`python -m tests.benchmarks.bodies_report` writes block and figure from the committed results.
"""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tests.benchmarks import pages
from tests.benchmarks.bodies import Results
from tests.benchmarks.report import rounded
from tweezer.plots import style
from tweezer.values.signs import typeset

#: tolerance of the goals
_GOAL = 1e-8
#: longest time (us) of spheroids at 1e-8, by the radius in their names
_WANTED = {"0.25 um": 5, "0.5 um": 9, "1 um": 30}
#: largest time of the 6 x 6 derivative over the time of a force
_DERIVATIVE = 4


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of goals, times, errors, T-matrices, treams and published elements."""
    return [
        _goals(results), _times(results), _errors(results), _by_stress(results),
        _t_matrices(results), _treams(results), _published(results),
    ]  # fmt: skip


def at(body: Results, tolerance: float) -> Results:
    """Return the measurements of a body at a tolerance."""
    (found,) = (each for each in body["tolerances"] if each["tolerance"] == tolerance)
    return dict(found)


def _goals(results: Results) -> list[list[str]]:
    bodies = results["bodies"]
    every = [(body, entry) for body in bodies for entry in body["tolerances"]]
    rows = [
        [
            "error of the force / tolerance / largest force", "1",
            rounded(max(each["error_over_largest_force"] / each["tolerance"] for _, each in every)),
        ],
        [
            "true error / estimated error", "1",
            rounded(1 / min(each["least_estimate_over_error"] for _, each in every)),
        ],
        [
            "force and torque, deviation from the stress tensor", "1e-10",
            _power(max(max(b["force_off_stress"], b["torque_off_stress"]) for b in bodies)),
        ],
    ]  # fmt: skip
    for radius, longest in _WANTED.items():
        of = [at(b, _GOAL)["us"] for b in bodies if b["name"].split(",")[0] == radius]
        if of:
            rows.append([f"spheroid, {radius}, at 1e-8, µs", f"{longest}", rounded(max(of))])
    rows += [
        [
            "6 x 6 derivative / force, time", f"{_DERIVATIVE}",
            rounded(max(each["derivative_over_force"] for _, each in every)),
        ],
        [
            "error of S - 1 of a T-matrix", "1e-9",
            _power(max(each["error"] for each in results["t_matrices"])),
        ],
        [
            "S - 1, deviation from treams at equal degree", "1e-12",
            _power(max(each["difference"] for each in results["treams"]["degrees"]))
            if results["treams"]["version"] else "not installed",
        ],
        [
            "T, deviation from SMARTIES", "1e-10",
            _power(max(each["difference"] for each in results["published"])),
        ],
    ]  # fmt: skip
    return [["quantity", "goal", "largest measured"], *rows]


def _power(value: float) -> str:
    return f"{value:.0e}"


def _times(results: Results) -> list[list[str]]:
    headings = ["body", "tolerance", "force, µs", "/ sphere", "6 x 6, µs", "/ force"]
    rows = [
        [
            "1 um sphere", _power(each["tolerance"]), rounded(each["us"]), "1",
            f"3 x 3: {rounded(each['gradient_us'])}", rounded(each["gradient_us"] / each["us"]),
        ]
        for each in results["sphere"]
    ]  # fmt: skip
    rows += [
        [
            body["name"], _power(each["tolerance"]), rounded(each["us"]),
            rounded(each["over_sphere"]), rounded(each["derivative_us"]),
            rounded(each["derivative_over_force"]),
        ]
        for body in results["bodies"]
        for each in body["tolerances"]
    ]  # fmt: skip
    return [headings, *rows]


def _errors(results: Results) -> list[list[str]]:
    headings = [
        "error at", "tolerance", "force", "of largest", "torque", "6 x 6", "estimate / error"
    ]  # fmt: skip
    keys = (
        "force_error", "error_over_largest_force", "torque_error_over_largest",
        "derivative_error_over_largest",
    )  # fmt: skip
    rows = [
        [
            body["name"], _power(each["tolerance"]), *(_power(each[key]) for key in keys),
            rounded(each["least_estimate_over_error"]),
        ]
        for body in results["bodies"]
        for each in body["tolerances"]
    ]  # fmt: skip
    return [headings, *rows]


def _by_stress(results: Results) -> list[list[str]]:
    return [
        ["stress tensor", "degree of T", "force, deviation", "torque, deviation"],
        *(
            [
                body["name"], f"{body['degree']}", _power(body["force_off_stress"]),
                _power(body["torque_off_stress"]),
            ]
            for body in results["bodies"]
        ),
    ]  # fmt: skip


def _t_matrices(results: Results) -> list[list[str]]:
    return [
        ["T-matrix", "degree", "time, s", "error", "unitarity", "reciprocity"],
        *(
            [
                each["name"], f"{each['degree']}", rounded(each["seconds"]),
                *(_power(each[key]) for key in ("error", "unitarity", "reciprocity")),
            ]
            for each in results["t_matrices"]
        ),
    ]  # fmt: skip


def _treams(results: Results) -> list[list[str]]:
    found = results["treams"]
    if found["version"] is None:
        return [["treams", "result"], [f"{found['name']}", "not installed, not compared"]]
    rows = [
        [
            f"{found['name']}, degree {each['degree']}", rounded(each["tweezer_s"]),
            rounded(each["treams_s"]), rounded(each["treams_s"] / each["tweezer_s"]),
            _power(each["difference"]),
        ]
        for each in found["degrees"]
    ]  # fmt: skip
    rows += [
        [f"{quantity} by its file", "", "", "", _power(found[f"{quantity}_difference"])]
        for quantity in ("force", "torque")
    ]
    headings = ["cluster", "tweezer, s", f"treams {found['version']}, s", "ratio", "difference"]
    return [headings, *rows]


def _published(results: Results) -> list[list[str]]:
    return [
        ["gold spheroid, 40 x 80 nm", "elements", "largest", "deviation", "stated accuracy"],
        *(
            [
                f"{each['nm']:g} nm", f"{each['elements']}", rounded(each["largest"]),
                _power(each["difference"]), _power(each["accuracy"]),
            ]
            for each in results["published"]
        ),
    ]  # fmt: skip


@style.styled
def figure(results: Results) -> Figure:
    """Draw errors against times for spheroids and clusters, and the times of T-matrices."""
    drawn = style.new(style.PAGE, 2.9)
    left, middle, right = drawn.subplots(1, 3)
    for axes, kind in ((left, "spheroid"), (middle, "cluster")):
        bodies = [body for body in results["bodies"] if body["kind"] == kind]
        for body, mark in zip(bodies, style.SERIES, strict=False):
            axes.plot(
                [each["us"] for each in body["tolerances"]],
                [each["error_over_largest_force"] for each in body["tolerances"]],
                label=typeset(body["name"]), **mark.both,
            )  # fmt: skip
        axes.axvline(
            results["sphere"][-1]["us"], color=style.MUTED, ls="--", lw=0.8, label="1 µm sphere"
        )
        axes.set(xscale="log", yscale="log", xlabel="time per force (µs)")
        _plain(axes, [each["us"] for body in results["bodies"] for each in body["tolerances"]])
        axes.set_title({"spheroid": "spheroids", "cluster": "clusters"}[kind])
        columns = {"spheroid": 2, "cluster": 1}[kind]
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.24), ncols=columns)
    middle.sharey(left)
    left.set_ylabel("error / largest force")
    _draw_matrices(right, results)
    return drawn


def _plain(axes: Axes, times: list[float]) -> None:
    """Label times without powers of ten."""
    shown = [each for each in (2, 5, 10, 20, 50, 100) if each <= 2 * max(times)]
    axes.set_xlim(2, 1.4 * max(times))
    axes.set_xticks(shown, [f"{each}" for each in shown])
    axes.set_xticks([], minor=True)


def _draw_matrices(axes: Axes, results: Results) -> None:
    """Draw the times of T-matrices by tweezer and treams against the degree of the spheres."""
    found = results["treams"]["degrees"]
    for name, key, mark in zip(
        ("tweezer", "treams"), ("tweezer_s", "treams_s"), style.SERIES, strict=False
    ):
        if found:
            axes.plot(
                [each["degree"] for each in found], [each[key] for each in found], label=name,
                **mark.both,
            )  # fmt: skip
    axes.set(yscale="log", xlabel="degree about the spheres", ylabel="time (s)")
    axes.set_title("T-matrix")
    if found:
        axes.set_xticks([each["degree"] for each in found])
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.24), ncols=2)


def block(results: Results) -> str:
    """Return the block with all tables."""
    return pages.block("bodies", pages.tables(tables(results))[:-1], results["machine"])


if __name__ == "__main__":
    pages.renew("bodies", block, figure)
