"""The results of the benchmark of calibration as tables, as a figure, and on their page.

`python -m tests.benchmarks.calibrate_report` writes block and figure from the committed results.
"""

from __future__ import annotations

import textwrap

from matplotlib.figure import Figure
from scipy.stats import binomtest

from tests.benchmarks import pages
from tests.benchmarks.calibrate import Results
from tweezer.plots import style

METHODS = {
    "power spectrum": "spectrum",
    "power spectrum, drag fitted": "drag fitted",
    "equipartition": "variance",
    "displacement": "MSD",
    "autocorrelation": "ACF",
    "potential": "potential",
}


def tables(results: Results) -> list[list[list[str]]]:
    """Return the tables of cameras and of disturbed recordings."""
    headings = ["without finding, %", *METHODS.values(), "missed without finding"]
    told = [each for each in results["cameras"] if each not in blind(results)]
    cameras = [
        ["k, pN/um; frames per second; exposure; drag", *headings],
        *([_camera(each), *_row(each)] for each in told),
    ]
    disturbed = [
        ["relaxation times; disturbance; drag", *headings],
        *([_disturbance(each), *_row(each)] for each in results["disturbed"]),
    ]
    return [cameras, disturbed]


def blind(results: Results) -> list[Results]:
    """Return the studies of exposed recordings whose exposure is not given."""
    return [each for each in results["cameras"] if each["exposure"] and not each["exposure_given"]]


def _camera(of: Results) -> str:
    given = "given" if of["exposure_given"] else "not given"
    return (
        f"{1e6 * of['stiffness']:.0f}; {of['rate_Hz']:.0f}; {100 * of['exposure']:.0f} %, {given}; "
        f"{'given' if of['drag_given'] else 'fitted'}"
    )


def _disturbance(of: Results) -> str:
    kinds = {"noise": of["noise"], "drift": of["drift"]}
    what = ", ".join(f"{kind} {size:g} sd" for kind, size in kinds.items() if size) or "none"
    return f"{of['relaxations']:.0f}; {what}; {'given' if of['drag_given'] else 'fitted'}"


def _row(of: Results) -> list[str]:
    methods = of["methods"]
    outside = sum(each["unmarked"] - each["unmarked_and_inside"] for each in methods.values())
    every = sum(each["records"] - each["inside"] for each in methods.values())
    return [
        f"{100 * of['clean'] / of['records']:.0f}",
        *(_coverage(methods.get(method)) for method in METHODS),
        f"{outside} of {every}",
    ]


def _coverage(of: Results | None) -> str:
    """Return the coverage of results without a finding in percent, and their number."""
    if of is None:
        return ""
    if not of["unmarked"]:
        return "- (0)"
    return f"{100 * of['unmarked_and_inside'] / of['unmarked']:.0f} ({of['unmarked']})"


def speed(results: Results) -> list[list[str]]:
    """Return the table of whole calibrations, with the headings in its first row."""
    return [
        ["samples", "calibrate, s", "pylake, s", "ratio", "memory / recording"],
        *(
            [
                f"{each['samples']:,}", f"{each['seconds']:.2g}", f"{each['pylake']:.2g}",
                f"{each['seconds'] / each['pylake']:.2g}", f"{each['memory']:.2g}",
            ]
            for each in results["speed"]["records"]
        ),
    ]  # fmt: skip


def pooled(studies: list[Results]) -> dict[str, tuple[int, int]]:
    """Return, by method, the results without a finding and those that contain the true value."""
    found: dict[str, tuple[int, int]] = {}
    for method in METHODS:
        own = [each["methods"][method] for each in studies if method in each["methods"]]
        found[method] = (
            sum(each["unmarked"] for each in own),
            sum(each["unmarked_and_inside"] for each in own),
        )
    return found


def groups(results: Results) -> dict[str, list[Results]]:
    """Return the studies that are pooled for the figure."""
    cameras, disturbed = results["cameras"], results["disturbed"]
    return {
        "cameras, exposure given": [each for each in cameras if each["exposure_given"]],
        "cameras, not exposed": [each for each in cameras if not each["exposure"]],
        "820 relaxation times": [each for each in disturbed if each["relaxations"] > 100],
        "40 relaxation times": [each for each in disturbed if each["relaxations"] < 100],
    }


@style.styled
def figure(results: Results) -> Figure:
    """Draw the coverage of results without a finding, by method."""
    drawn = style.new(style.PAGE, 3.0)
    axes = drawn.subplots()
    for i, studies in enumerate(groups(results).values()):
        for j, (method, (unmarked, inside)) in enumerate(pooled(studies).items()):
            if unmarked < 20:
                continue
            low, high = binomtest(inside, unmarked).proportion_ci(0.95)
            at = 100 * inside / unmarked
            axes.errorbar(
                [i + 0.12 * (j - 2.5)], [at], [[at - 100 * low], [100 * high - at]], ms=4,
                capsize=2, label=METHODS[method] if i == 0 else None, **style.SERIES[j].points,
            )  # fmt: skip
    axes.axhline(95, color=style.MUTED, linestyle="--", linewidth=0.8)
    axes.set_xticks(range(len(groups(results))), list(groups(results)))
    axes.set(ylabel="coverage of the 95 % interval (%)", ylim=(80, 100.5))
    drawn.legend(loc="outside lower center", ncols=6)
    return drawn


def block(results: Results) -> str:
    """Return the block: coverage of cameras and disturbed recordings, and the speed."""
    numbers = [each for study in blind(results) for each in study["methods"].values()]
    outside = sum(each["records"] - each["inside"] for each in numbers)
    missed = sum(each["unmarked"] - each["unmarked_and_inside"] for each in numbers)
    counted = (
        f"There are {results['cameras'][0]['records']} recordings of each kind by cameras and "
        f"{results['disturbed'][0]['records']} of each disturbed kind. The table omits exposed "
        "recordings whose exposure is not given. Their intervals miss the true value in "
        f"{outside} results, of which {missed} have no finding."
    )
    timed = (
        "The table compares the processor time of one calibration, with all methods and findings, "
        "with a pylake fit (`calibrate_force`). Both ran on one core in one run, for recordings at "
        "78 kHz. The memory is the largest during the call, divided by the size of the positions. "
        f"These figures were measured at commit {results['speed']['machine']['commit']}."
    )
    lines = [
        *textwrap.wrap(counted, 110), "", *pages.tables(tables(results)),
        *textwrap.wrap(timed, 110), "", *pages.tables([speed(results)])[:-1],
    ]  # fmt: skip
    return pages.block("calibrate", lines, results["machine"])


if __name__ == "__main__":
    pages.renew("calibrate", block, figure)
