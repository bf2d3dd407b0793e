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
    """Time of a force by waves and rays over the size of a bead, and how far rays are off."""
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
        "silica bead", "wavelengths across", "waves: a force takes", "its error",
        "rays: a force takes", "off by, of the largest force", "true stiffness across, over theirs",
        "true stiffness along, over theirs", "judgement",
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
    return pages.markdown(("model", "off before the trap", "in it", "takes"), rows)


def fluid(fluids: Results, memory: Sequence[dict[str, Any]]) -> list[str]:
    """What leaving out the fluid's memory costs, and what having it costs."""
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
                f"{each['bead'].removesuffix('nm')} nm, {each['theory']}",
                f"{1e6 * each['off']:.2f} µm", f"{overshoots} nm", f"{without} → {with_it} ms",
            )
        )  # fmt: skip
    thermal = ", ".join(
        f"{of['times']:.1f} times by {of['poles']} poles" for of in fluids["steps"] if of["poles"]
    )
    headings = ("bead, light", "off without it by up to", "overshoot without → with", "a run takes")
    return [
        *pages.markdown(headings, rows), "",
        f"A step of thermal motion takes {thermal} as long as without memory.",
    ]  # fmt: skip


def wall(walls: Results) -> list[str]:
    """How much too fast Stokes's drag is beside a wall; biases of thermal motion there."""
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
        f"Thermal motion at a step of {STEP:g} of the time to sink by a mean gap: `heun` puts the "
        f"mean gap off by {bias['heun']['mean']:.1f} ± {bias['heun']['mean_error']:.1f} %, Euler's "
        f"method with the usual drift by {bias['euler, drift']['mean']:.0f} %, without that drift "
        f"by {bias['euler, no drift']['mean']:.0f} %. It runs at {rate:.2g} times the rate without "
        "a wall."
    )
    headings = ("gap", "moves too fast by Stokes's drag, along the wall", "away from it")
    return [*pages.markdown(headings, rows), "", told]


def thermal(brownian: Results) -> list[str]:
    """Bias and rate of the ways of thermal motion at the usual step."""
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
        f"That bead relaxes in {1e6 * relaxation:.2g} µs, and follows the trap in "
        f"{1e6 * trap:.2g} µs. "
        "With inertia, Euler-Maruyama must resolve the first: for the same error it takes "
        f"{rounded(min(fewer))} to {rounded(max(fewer))} times as many steps."
    )
    headings = (
        "model, method", "for", "forces a step", "steps a second", "⟨x²⟩ off by up to",
        "corner frequency off by",
    )  # fmt: skip
    return [*pages.markdown(headings, rows), "", told]


def evaluator(force: Results) -> list[str]:
    """A map or the quadrature: time, error, and from how many forces on a map pays."""
    inside, kinds = force["headline"]["by_place"]["inside"], force["headline"]["by_place"].values()
    rows = []
    for theory, quadrature, table, key in (
        ("rays", "quadrature", "map", "map"),
        ("waves", "waves", "waves_map", "waves' map"),
    ):
        exact, read = inside[f"{quadrature}_us"], 1e-3 * inside[f"{table}_ns"]
        made = force["fresh_process"][key]["empty_table_cache"]["bind_s"]
        error = max(of[f"{quadrature}_largest_error"] for of in kinds)
        tabled = f"{table}_largest_error_over_largest_force"
        off = max(of[tabled] for of in kinds if tabled in of)
        rows += [
            (f"{theory}, `quadrature`", f"{rounded(exact)} µs", f"{error:.0e} of itself", "", ""),
            (
                f"{theory}, `map`", f"{rounded(read)} µs", f"{off:.0e} of the largest force",
                f"{rounded(made)} s", f"{float(rounded(1e6 * made / (exact - read))):,.0f}",
            ),
        ]  # fmt: skip
    headings = (
        "990 nm bead",
        "a force takes",
        "largest error",
        "made in",
        "pays from so many forces",
    )
    return pages.markdown(headings, rows)


def blocks() -> dict[str, str]:
    """What stands on the page, by its names there."""
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
