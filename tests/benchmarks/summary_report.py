"""What the other benchmarks come to: the README's figures, and what each model is worth.

`python -m tests.benchmarks.summary_report` writes both from the committed results, and follows the
thesis's three beads again for their table.
"""

from __future__ import annotations

from typing import Any

import tweezer
from tests.benchmarks import pages
from tests.benchmarks.integrate_report import converged
from tests.benchmarks.pages import Results
from tests.benchmarks.report import rounded

#: Ends the names of the motions of the thesis's beads by its light
_OF_THE_THESIS = ", rays, map"
BEADS = ("thesis-1950nm", "thesis-990nm", "thesis-500nm")


def headline(force: Results, integration: Results, brownian: Results) -> str:
    """The README's block: one row for a figure."""
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


def models(integration: Results) -> str:
    """The block of docs/models.md: the error of each model, and what that took."""
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
    """The most exact run of the full model, the models' own errors, and every scaling factor."""
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
    """The table of the thesis's three beads in docs/models.md; runs them."""
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
    headings = ("scene", "outcome", "overshoot", "steps", "force calls", "off the unscaled bead")
    return "\n".join(["<!-- bench-beads -->", *pages.markdown(headings, rows), "<!-- end -->"])


if __name__ == "__main__":
    integrated = pages.committed("integrate")
    pages.quote(
        "headline", headline(pages.committed("force"), integrated, pages.committed("brownian"))
    )
    pages.quote("models", models(integrated))
    pages.quote("beads", beads())
