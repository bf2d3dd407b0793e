"""Headline figures of the benchmarks, for the README, the summary page and the page of models.

`python -m tests.benchmarks.summary_report` writes them from the committed results, and simulates
the thesis's three beads again for their table.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from typing import Any

import tweezer
from tests.benchmarks import pages
from tests.benchmarks.brownian import DEFAULT, HARMONIC, STEP, way_of
from tests.benchmarks.camera_report import pooled as camera_pooled
from tests.benchmarks.diagram_report import off
from tests.benchmarks.heights_report import pooled as heights_pooled
from tests.benchmarks.hydro_report import pooled as fast_pooled
from tests.benchmarks.integrate_report import converged
from tests.benchmarks.pages import Results
from tests.benchmarks.report import rounded
from tests.benchmarks.scaling import CORES, STATISTICS

#: Ends the names of the motions of the thesis's beads by its light
_OF_THE_THESIS = ", rays, map"
BEADS = ("thesis-1950nm", "thesis-990nm", "thesis-500nm")


def headline(force: Results, integration: Results, brownian: Results) -> str:
    """Return the README's block, with one row for each headline figure."""
    inside, edge = (force["headline"]["by_place"][kind] for kind in ("inside", "edge"))
    map_ns, map_error = (
        max(of[key] for of in force["headline"]["by_place"].values() if key in of)
        for key in ("map_ns", "map_largest_error_over_largest_force")
    )
    waves = force["waves"]["beads"]["silica-1um"]
    motion = integration["headline"]["thesis-990nm, rays, map"]
    baseline = motion["numpy"]
    cheaper = [
        each["times_cheaper"]["table"]["numpy"]
        for each in brownian["headline"]["cheaper"]
        if (each["method"], each["step_trap_times"]) == ("heun", 0.2)
    ]
    (default,) = (
        each for each in brownian["rates"] if (each["model"], each["method"]) == ("full", "heun")
    )
    rows = [
        ("force of waves, 1 µm silica: time near the focus, largest relative error to 20 radii",
         f"{rounded(waves['us'])} µs, {waves['largest_error']:.1e}"),
        ("force of rays, integral over the lens, bead near the focus: time",
         f"{rounded(inside['quadrature_us'])} µs"),
        ("the same, at the hardest places: time, largest relative error",
         f"{rounded(edge['quadrature_at_the_slowest_place_us'])} µs, "
         f"{edge['quadrature_largest_error']:.1e}"),
        ("the thesis's 7644 rays in NumPy, near the focus: times slower, largest relative error",
         f"{rounded(inside['numpy_over_quadrature'])}, {inside['grid_largest_error']:.1e}"),
        ("force from a table, at the hardest places: time, error as a part of the largest force",
         f"{rounded(map_ns)} ns, {map_error:.1e}"),
        ("990 nm bead released and caught, all its inertia, to 2e-6 µm: time",
         f"{rounded(motion['full']['ms'])} ms"),
        ("SciPy's LSODA, CVODE at the same error, with the same compiled force: times slower",
         f"{rounded(motion['LSODA']['times_slower'])}, {rounded(motion['CVODE']['times_slower'])}"),
        ("the thesis's sum in NumPy under SciPy, scaled: times slower, its error, ours",
         f"{rounded(baseline['ms'] / baseline['ours_ms'])}, {baseline['error_um']:.1e} µm, "
         f"{baseline['our_error_um']:.1e} µm"),
        ("thermal motion, with inertia, one core: million steps a second",
         rounded(1e-6 * default["steps_per_s"])),
        ("Euler-Maruyama in NumPy at the same bias of ⟨x²⟩: times dearer, by the well",
         f"{rounded(min(cheaper))} to {rounded(max(cheaper))}"),
    ]  # fmt: skip
    return pages.block("headline", pages.markdown(("", ""), rows), force["machine"])


def overview() -> str:
    """Return the block of the summary page: headline figures of all subjects, and the machines."""
    found = {name: pages.committed(name) for name in _SUBJECTS}
    rows = [
        f"| [{subject}]({page}) | {headline(found[name])} | `{name}` {_commit(found[name])} |"
        for name, (subject, page, headline) in _SUBJECTS.items()
    ]
    used: dict[str, list[str]] = {}
    for name, results in found.items():
        of = results["machine"]
        machine = (
            f"{of['processor']}, {of['cores']} cores, Python {of['python']}, Numba {of['numba']}"
        )
        used.setdefault(machine, []).append(f"`{name}`")
    lines = ["| subject | headline | benchmark, commit |", "| --- | --- | --- |", *rows, ""]
    lines += ["The machines are:", ""]
    for machine, names in used.items():
        item = f"- {machine}: {', '.join(names)}."
        lines += textwrap.wrap(item, 110, subsequent_indent="  ", break_on_hyphens=False)
    return "\n".join(["<!-- bench-overview -->", *lines, "<!-- end -->"])


def _commit(results: Results) -> str:
    return str(results["machine"]["commit"])


def _force(force: Results) -> str:
    waves = force["waves"]["beads"]["silica-1um"]
    rays = force["headline"]["by_place"]["inside"]
    return (
        f"wave optics, 1 µm bead near the focus: {rounded(waves['us'])} µs with an error of "
        f"{waves['largest_error']:.1e}; ray optics {rounded(rays['quadrature_us'])} µs; the "
        f"thesis's rays in NumPy {rounded(rays['numpy_us'])} µs with an error of "
        f"{rays['grid_largest_error']:.1e}"
    )


def _bodies(bodies: Results) -> str:
    (body,) = (each for each in bodies["bodies"] if each["name"] == "0.5 um, 2:1")
    tight = body["tolerances"][-1]
    return (
        f"polystyrene spheroid, 0.8 by 1.6 µm: {rounded(tight['us'])} µs with an error of "
        f"{tight['error_over_largest_force']:.0e} of the largest force; "
        f"{rounded(tight['over_sphere'])} times as long as for a 1 µm sphere"
    )


def _rods(rods: Results) -> str:
    entry = rods["hopping"][0]
    hops, flips = (entry[f"{key}_per_s"][0] for key in ("hops", "flips"))
    return (
        f"rod in two traps: {rounded(hops)} hops and {rounded(flips)} flips per second in "
        f"{entry['steps']:.0e} steps of {rounded(entry['us_per_step'])} µs with the exact force"
    )


def _integration(integration: Results) -> str:
    motion = integration["headline"]["thesis-990nm, rays, map"]
    return (
        f"capture of the 990 nm bead to 2e-6 µm: {rounded(motion['full']['ms'])} ms; SciPy's LSODA "
        f"takes {rounded(motion['LSODA']['times_slower'])} times as long with the same force"
    )


def _thermal(brownian: Results) -> str:
    rate = next(
        each["steps_per_s"] for each in brownian["rates"]
        if (each["model"], each["method"]) == ("full", "heun")
    )  # fmt: skip
    biases = [
        abs(each["x2_bias"])
        for name, entries in brownian["wells"].items()
        for each in entries
        if name != HARMONIC and way_of(each) == DEFAULT and each["step_trap_times"] == STEP
    ]
    return (
        f"{rounded(1e-6 * rate)} million steps per second on one core, with inertia; bias of ⟨x²⟩ "
        f"at the default step at most {100 * max(biases):.2g} %"
    )


def _fluid(fluids: Results) -> str:
    tight = [of["usual"][-1]["error_um"] for of in fluids["captures"]]
    without = [of["without_um"] for of in fluids["captures"]]
    (usual,) = (of for of in fluids["steps"] if of["poles"] == 24)
    return (
        f"captures differ from the exact memory by at most {max(tight):.1e} µm (without memory up "
        f"to {max(without):.2g} µm); a thermal step takes {usual['times']:.1f} times as long"
    )


def _wall(walls: Results) -> str:
    at = {each["scheme"]: each for each in walls["bias"] if each["step"] == STEP}
    ours, euler = at["heun"], at["euler, drift"]
    return (
        f"mean gap at a step of {STEP:g} relaxation times biased by {ours['mean']:z.1f} ± "
        f"{ours['mean_error']:.1f} %; Euler's method with drift by {euler['mean']:.0f} %"
    )


def _within(inside: int, of: int, what: str) -> str:
    return f"{100 * inside / of:.1f} % of {of:,} intervals contain {what}"


def _calibration(calibration: Results) -> str:
    numbers = [
        each
        for study in calibration["cameras"]
        if study["exposure_given"] or not study["exposure"]
        for each in study["methods"].values()
    ]
    inside = sum(each["unmarked_and_inside"] for each in numbers)
    of = sum(each["unmarked"] for each in numbers)
    return f"{_within(inside, of, 'the true stiffness')} (cameras, results without a finding)"


def _camera(camera: Results) -> str:
    counted = [of for study in camera["studies"] for of in camera_pooled(study).values()]
    inside, of = sum(inside for _, inside in counted), sum(count for count, _ in counted)
    return _within(inside, of, "the true stiffness")


def _free(free: Results) -> str:
    inside = sum(each["inside"] for each in free["studies"])
    of = sum(each["seen_free"] for each in free["studies"])
    return _within(inside, of, "the true diffusion coefficient")


def _fast(hydro: Results) -> str:
    (of, inside), theirs = (fast_pooled(hydro, "passive", by) for by in ("volts", "pylake"))
    return (
        f"{_within(inside, of, 'the true stiffness or sensitivity')}; with lumicks.pylake "
        f"{100 * theirs[1] / theirs[0]:.1f} %"
    )


def _heights(heights: Results) -> str:
    of, inside = heights_pooled(heights, "steady", lambda by, _: "uncertain" not in by)
    series = heights_pooled(heights, "series", lambda by, _: True)
    return (
        f"{_within(inside, of, 'the true value')} at a given height; if five heights locate the "
        f"wall, {100 * series[1] / series[0]:.1f} %"
    )


def _fit(fits: Results) -> str:
    keys = [of for study in fits["studies"] for of in study["keys"].values()]
    inside, of = (sum(key[name] for key in keys) for name in ("determined_inside", "determined"))
    return f"{_within(inside, of, 'the true value')} (keys that the recording determines)"


def _depth(depth: Results) -> str:
    shares = [100 * each["coverage"] for each in depth["beads"]]
    return f"{min(shares):.0f} to {max(shares):.0f} % of the intervals contain the true depth"


def _sweep(sweep: Results) -> str:
    return (
        f"{sweep['whole']['cases']:,} traps with wave optics take {sweep['whole']['wall_s']:.0f} s "
        f"on {sweep['processes']} processes"
    )


def _diagram(diagram: Results) -> str:
    powers = [
        1e3 * each["powers_W"]["1 h"]
        for each in diagram["least"]
        if each["material"] == "polystyrene" and each["powers_W"]["1 h"] is not None
    ]
    return (
        f"{max(powers):.3g} to {min(powers):.3g} mW hold polystyrene beads of 0.2 to 3 µm for an "
        f"hour; lifetimes within {max(abs(off(each)) for each in diagram['ensembles']):.1f} "
        "standard deviations of ensembles"
    )


def _scaling(scaling: Results) -> str:
    (plan,) = (each for each in scaling["plan"] if each["kind"] == STATISTICS.label)
    (entry,) = (each for each in plan["cores"] if each["cores"] == CORES[-1])
    return f"{100 * entry['efficiency']:.0f} % efficiency on {CORES[-1]:,} cores, modelled"


def _view(view: Results) -> str:
    run, ensemble = view["pages"]
    return (
        f"a run's page has {run['megabytes']:.3g} MB; it plays at {run['frames_per_s']:.0f} frames "
        f"per second without a graphics card, 10,000 beads at {ensemble['frames_per_s']:.0f}"
    )


def _commands(costs: Results) -> str:
    of = {each["command"]: each for each in costs["commands"]}["tweezer run silica-1um"]
    return (
        f"`tweezer run silica-1um`: {of['cold_wall_s']:.2g} s the first time, "
        f"{of['warm_wall_s']:.2g} s later"
    )


#: by benchmark: its subject, its page and its headline figure
_SUBJECTS: dict[str, tuple[str, str, Callable[[Results], str]]] = {
    "force": ("The force of the light", "evidence-force.md", _force),
    "bodies": ("Light on spheroids and clusters", "evidence-bodies.md", _bodies),
    "rods": ("Thermal motion of rods", "evidence-rods.md", _rods),
    "integrate": ("Integration in time", "evidence-integration.md", _integration),
    "brownian": ("Thermal motion", "evidence-thermal-motion.md", _thermal),
    "fluid": ("Fluid inertia", "evidence-fluid-inertia.md", _fluid),
    "wall": ("Thermal motion beside a wall", "evidence-walls.md", _wall),
    "calibrate": ("Calibration", "evidence-calibration.md", _calibration),
    "camera": ("Calibration from camera images", "evidence-camera.md", _camera),
    "free": ("Diffusion of free beads", "evidence-free-beads.md", _free),
    "hydro": ("Calibration of fast recordings", "evidence-fast-recordings.md", _fast),
    "heights": ("Calibration beside a wall", "evidence-calibration-walls.md", _heights),
    "fit": ("Fits of a scene", "evidence-fits.md", _fit),
    "depth": ("Release depth", "evidence-depth.md", _depth),
    "sweep": ("Sweeps", "sweeps.md", _sweep),
    "diagram": ("Trapping diagram", "trapping-diagram.md", _diagram),
    "scaling": ("Clusters", "scaling.md", _scaling),
    "view": ("Interactive pages", "evidence-pages.md", _view),
    "commands": ("Commands", "evidence-commands.md", _commands),
}


def models(integration: Results) -> str:
    """Return the block with the error and the cost of each model."""
    table = [
        (
            f"{label.removesuffix(_OF_THE_THESIS)}, {named}",
            f"{entry['before_um']:.1e}", f"{entry['during_um']:.1e}", rounded(entry["ms"]),
            f"{entry['force_calls']}",
        )
        for label, of in integration["motions"].items()
        if label.endswith(_OF_THE_THESIS) and label.split(",")[0] in BEADS
        for named, entry in _own_errors(of["entries"])
    ]  # fmt: skip
    headings = ("bead, model", "error before, µm", "in the trap, µm", "ms", "force calls")
    return pages.block("models", pages.markdown(headings, table), integration["machine"])


def _own_errors(entries: list[dict[str, Any]]) -> list[tuple[str, dict[str, Any]]]:
    """Return the most exact full run, the other models' own errors, and all scaling factors."""
    exact = min(
        (each for each in entries if (each["model"], each["method"]) == ("full", "exponential")),
        key=lambda each: each["during_um"],
    )
    scaled = [
        each
        for each in entries
        if (each["model"], each["method"]) == ("scaled", "dormand-prince")
        and each["scaling_factor"] < 1
    ]
    return [
        ("full", exact),
        *((model, converged(entries, model)) for model in ("first-order", "overdamped")),
        *((f"scaled, a2 = {each['scaling_factor']:.2g}", each) for each in scaled),
    ]


def beads() -> str:
    """Simulate the thesis's three beads and return the block with their table."""
    rows = []
    for name in BEADS:
        scene = tweezer.load_scene(name)
        run = tweezer.simulate(scene)
        summary = tweezer.summarise(run)
        outcome = f"{summary.outcome} after {1e3 * summary.outcome_time:.0f} ms"
        if summary.outcome == "lost":
            unscaled = tweezer.summarise(tweezer.simulate(scene, model="full", method="auto"))
            way = "upward" if summary.end[2] > 0 else "downward"
            outcome += f", {way}; unscaled it is {unscaled.outcome}"
        rows.append(
            (
                f"`{name}`", outcome, f"{1e6 * summary.overshoot:.3f} µm",
                f"{run.attrs['steps']}", f"{run.attrs['force_calls']}",
                f"{rounded(1e6 * run.attrs['model_error'])} µm",
            )
        )  # fmt: skip
    headings = (
        "scene",
        "outcome",
        "overshoot",
        "steps",
        "force calls",
        "distance to the unscaled bead",
    )
    return "\n".join(["<!-- bench-beads -->", *pages.markdown(headings, rows), "<!-- end -->"])


if __name__ == "__main__":
    integrated = pages.committed("integrate")
    pages.quote(
        "headline", headline(pages.committed("force"), integrated, pages.committed("brownian"))
    )
    pages.quote("overview", overview())
    pages.quote("models", models(integrated))
    pages.quote("beads", beads())
