"""What speaks for each theory, model and method, on the page that helps to choose.

`python -m tests.benchmarks.choosing_report` writes its blocks from the committed results of the
other benchmarks, the table of what rays are worth, and the exact mobilities beside a wall.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import tweezer
from tests.benchmarks import pages
from tests.benchmarks.brownian import HARMONIC, MILD, STEP, Way, way_of
from tests.benchmarks.integrate_report import converged
from tests.benchmarks.pages import ROOT, Results
from tests.benchmarks.report import rounded
from tests.benchmarks.summary_report import BEADS
from tweezer.optics import ray_optics_worth

#: The thesis's beads in water that remembers; `tweezer reproduce` writes it
MEMORY = ROOT / "docs/figures/thesis/memory.json"
#: Gaps between bead and wall, in radii
GAPS = (0.1, 0.3, 1.0, 3.0, 10.0, 20.0)
#: Ways of thermal motion that a user chooses from, and what each is for
WAYS = {
    Way("full", "heun", spring=True): "velocities, spectra to any frequency",
    Way("full", "one-call"): "distributions with inertia",
    Way("overdamped", "heun", spring=True): "positions, beside walls too",
    Way("overdamped", "one-call"): "distributions, escapes, stiffness",
    Way("overdamped", "euler-maruyama"): "comparison with other programs",
}


def light(force: Results) -> list[str]:
    """Time of a force with both theories by the size of a bead, and the error of ray optics."""
    scene = tweezer.load_scene("silica-1um")
    rays = force["waves"]["rays"]["inside"]
    rows = []
    for size in force["waves"]["sizes"]:
        diameter, inside = size["diameter_um"], size["bands"]["inside"]
        worth = ray_optics_worth(
            scene.replace(bead={"diameter": f"{diameter} um"}, optics={"theory": "rays"})
        )
        assert worth is not None
        rows.append(
            (
                f"{diameter:g} µm", f"{worth.wavelengths:.2g}", f"{rounded(inside['us'])} µs",
                f"{inside['largest_error']:.0e}", f"{rounded(rays['us'])} µs",
                _percent(worth.force_inside), _times(worth.stiffness_across),
                _times(worth.stiffness_along), "" if worth.trusted else "not to be trusted",
            )
        )  # fmt: skip
    headings = (
        "silica bead", "diameter in wavelengths", "wave optics: time of a force", "relative error",
        "ray optics: time of a force", "error relative to the largest force",
        "stiffness across, wave over ray optics", "stiffness along, wave over ray optics",
        "judgement",
    )  # fmt: skip
    return pages.markdown(headings, rows)


def _percent(of: tuple[float, float] | None) -> str:
    return f"{100 * of[0]:.2g} to {100 * of[1]:.2g} %" if of else "not compared"


def _times(of: tuple[float, float] | None) -> str:
    return f"{of[0]:.2g} to {of[1]:.2g}" if of else "no trap"


def motion(integration: Results) -> list[str]:
    """Error and time of each model, the worst of the thesis's three beads."""
    chosen: dict[str, list[dict[str, Any]]] = {}
    for bead in BEADS:
        entries = integration["motions"][f"{bead}, rays, map"]["entries"]
        by_full = [
            each for each in entries if (each["model"], each["method"]) == ("full", "exponential")
        ]
        chosen.setdefault("full", []).append(min(by_full, key=lambda each: each["during_um"]))
        for model in ("first-order", "overdamped"):
            chosen.setdefault(model, []).append(converged(entries, model))
        printed = tweezer.load_scene(bead).simulation.scaling_factor
        scaled = [each for each in entries if each.get("scaling_factor", 1) < 1]
        chosen.setdefault("scaled, a2 near the thesis's", []).append(
            min(scaled, key=lambda each: abs(math.log(each["scaling_factor"] / printed)))
        )
    rows = [
        (
            model,
            *(f"{max(each[key] for each in of):.0e} µm" for key in ("before_um", "during_um")),
            f"{rounded(max(each['ms'] for each in of))} ms",
        )
        for model, of in chosen.items()
    ]
    headings = ("model", "error before the trap", "error in the trap", "run time")
    return pages.markdown(headings, rows)


def fluid(fluids: Results, memory: Sequence[dict[str, Any]]) -> list[str]:
    """Error without hydrodynamic memory, and run times with and without it."""
    times = {
        (each["bead"].removeprefix("thesis-"), each["theory"]): each
        for each in reversed(fluids["calls"])
    }
    rows = []
    for each in memory:
        calls = times[each["bead"], each["theory"]]
        without, with_it = (rounded(calls[kind]["ms"]) for kind in ("none", "memory"))
        overshoots = " → ".join(f"{1e9 * value:.2g}" for value in each["overshoot"])
        rows.append(
            (
                f"{each['bead'].removesuffix('nm')} nm, {each['theory'][:-1]} optics",
                f"{1e6 * each['off']:.2f} µm", f"{overshoots} nm", f"{without} → {with_it} ms",
            )
        )  # fmt: skip
    thermal = ", ".join(
        f"{of['times']:.1f} times with {of['poles']} poles" for of in fluids["steps"] if of["poles"]
    )
    headings = (
        "bead, light", "largest error without memory", "overshoot without → with",
        "run time without → with",
    )  # fmt: skip
    return [
        *pages.markdown(headings, rows), "",
        f"A step of thermal motion takes longer than without memory: {thermal}.",
    ]  # fmt: skip


def wall(walls: Results) -> list[str]:
    """Excess mobility of Stokes's drag beside a wall, and biases of thermal motion there."""
    mobilities = tweezer.wall_mobilities(list(GAPS))
    along, away = mobilities["parallel"], mobilities["perpendicular"]
    rows = [
        (
            f"{gap:g} radii",
            *(f"{rounded(100 * (1 / float(each[at]) - 1))} %" for each in (along, away)),
        )
        for at, gap in enumerate(GAPS)
    ]  # fmt: skip
    bias = {each["scheme"]: each for each in walls["bias"] if each["step"] == STEP}
    (rate,) = (
        each["rate"] for each in walls["steps"]
        if (each["model"], each["method"], each["walls"]) == ("overdamped", "heun", "one")
    )  # fmt: skip
    told = (
        f"Thermal motion was simulated with a step of {STEP:g} of the time to sink by a mean gap. "
        f"The error of the mean gap is {bias['heun']['mean']:.1f} ± "
        f"{bias['heun']['mean_error']:.1f} % with `heun`, {bias['euler, drift']['mean']:.0f} % for "
        f"Euler's method with the usual drift, and {bias['euler, no drift']['mean']:.0f} % without "
        f"that drift. The rate of `heun` is {rate:.2g} times the rate without a wall."
    )
    headings = ("gap", "excess mobility by Stokes's drag, along the wall", "away from the wall")
    return [*pages.markdown(headings, rows), "", told]


def thermal(brownian: Results) -> list[str]:
    """Bias and rate of each model and method of thermal motion at the default step."""
    wells = [name for name in brownian["wells"] if name != HARMONIC]
    rates = {(each["model"], each["method"]): each for each in brownian["rates"]}
    rows = []
    for way, purpose in WAYS.items():
        found = {
            name: each
            for name in wells
            for each in brownian["wells"][name]
            if each["step_trap_times"] == STEP and way_of(each) == way
        }
        corner = found[MILD].get("corner_bias")
        rate = rates[way[:2]]
        rows.append(
            (
                f"`{way.model}`, `{way.method}`", purpose, f"{rate['force_calls']}",
                f"{rounded(1e-6 * rate['steps_per_s'])} million",
                f"{100 * max(abs(each['x2_bias']) for each in found.values()):.2g} %",
                "" if corner is None else f"{100 * abs(corner):.2g} %",
            )
        )  # fmt: skip
    fewer = [
        each["times_fewer_steps"]
        for each in brownian["headline"]["cheaper"]
        if (each["method"], each["step_trap_times"]) == ("heun", STEP)
    ]
    relaxation, trap = (brownian["trap"][key] for key in ("relaxation_time_s", "trap_time_s"))
    told = (
        f"The relaxation time of the velocity is {1e6 * relaxation:.2g} µs, and the relaxation "
        f"time in the trap is {1e6 * trap:.2g} µs. With inertia, Euler-Maruyama must resolve the "
        f"shorter time. For the same error it requires {rounded(min(fewer))} to "
        f"{rounded(max(fewer))} times as many steps."
    )
    headings = (
        "model, method", "use", "forces per step", "steps per second", "largest error of ⟨x²⟩",
        "error of the corner frequency",
    )  # fmt: skip
    return [*pages.markdown(headings, rows), "", told]


def evaluator(force: Results) -> list[str]:
    """Time and error of map and quadrature, and how many forces make a map faster."""
    inside, kinds = force["headline"]["by_place"]["inside"], force["headline"]["by_place"].values()
    rows = []
    for theory, quadrature, table, key in (
        ("ray optics", "quadrature", "map", "map"),
        ("wave optics", "waves", "waves_map", "waves' map"),
    ):
        exact, read = inside[f"{quadrature}_us"], 1e-3 * inside[f"{table}_ns"]
        made = force["fresh_process"][key]["empty_table_cache"]["bind_s"]
        error = max(of[f"{quadrature}_largest_error"] for of in kinds)
        tabled = f"{table}_largest_error_over_largest_force"
        off = max(of[tabled] for of in kinds if tabled in of)
        rows += [
            (
                f"{theory}, `quadrature`", f"{rounded(exact)} µs", f"{error:.0e} of the force",
                "", "",
            ),
            (
                f"{theory}, `map`", f"{rounded(read)} µs", f"{off:.0e} of the largest force",
                f"{rounded(made)} s", f"{float(rounded(1e6 * made / (exact - read))):,.0f}",
            ),
        ]  # fmt: skip
    headings = (
        "990 nm bead",
        "time of a force",
        "largest error",
        "time to make the map",
        "faster above so many forces",
    )
    return pages.markdown(headings, rows)


def blocks() -> dict[str, str]:
    """Blocks of the page by their names."""
    force, brownian = pages.committed("force"), pages.committed("brownian")
    memory = json.loads(MEMORY.read_text(encoding="utf-8"))
    machine = force["machine"]
    parts = {
        "light": light(force), "motion": motion(pages.committed("integrate")),
        "fluid": fluid(pages.committed("fluid"), memory), "wall": wall(pages.committed("wall")),
        "thermal": thermal(brownian), "evaluator": evaluator(force),
    }  # fmt: skip
    whole = {
        name: "\n".join([f"<!-- bench-choosing-{name} -->", *lines, "<!-- end -->"])
        for name, lines in parts.items()
    }
    return {**whole, "machine": pages.block("choosing-machine", [], machine)}


if __name__ == "__main__":
    for _name, _text in blocks().items():
        pages.quote(f"choosing-{_name}", _text)
