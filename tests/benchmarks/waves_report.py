"""Tables of wave optics from the force benchmark, their block, and their part of its figure."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable

from matplotlib import colormaps
from matplotlib.axes import Axes

from tests.benchmarks import pages
from tests.benchmarks.pages import Results
from tests.benchmarks.waves import BANDS, TOLERANCE
from tweezer.plots import style

#: (size of the bead in um, longest time in us inside) of the thesis's beads
_WANTED = {"thesis-500nm": (0.5, 4), "thesis-990nm": (1, 5), "thesis-1950nm": (2, 10)}
_BAND_STYLES = dict(zip(("inside", "edge", "outside", "far"), style.SERIES, strict=False))


def tables(waves: Results) -> list[list[list[str]]]:
    """Return the tables of goals, the four beads, sizes, maps, and sums written in NumPy."""
    return [_done(waves), _beads(waves), _by_size(waves), _maps(waves), _others(waves)]


def _done(waves: Results) -> list[list[str]]:
    beads, sizes = waves["beads"], waves["sizes"]
    mapped = [size for size in sizes if size["map"]]
    ratio = max(bead["with_jacobian_us"] / bead["us"] for bead in beads.values())
    one, batches = (
        [size["numpy"][key] for size in sizes if size["numpy"]]
        for key in ("numpy_over_quadrature", "numpy_in_batches_over_quadrature")
    )
    rows = [
        ["error at 1e-8, up to 20 radii", "1e-8", _largest(beads.values(), "largest_error")],
        [
            "true error / estimated error",
            "10",
            _two(1 / min(bead["least_estimate_over_error"] for bead in beads.values())),
        ],
        *(
            [f"inside, {size:g} µm, µs", f"{wanted}", _two(beads[name]["us"])]
            for name, (size, wanted) in _WANTED.items()
        ),
        ["time with the Jacobian / without", "2", _two(ratio)],
        [
            "reading a map, beads to 5 µm, ns",
            "60",
            _two(max(size["map"]["read_ns"] for size in mapped)),
        ],
        [
            "with the Jacobian, ns",
            "80",
            _two(max(size["map"]["with_jacobian_ns"] for size in mapped)),
        ],
        *(
            [
                f"building a map, beads to {largest:g} µm, s",
                f"{wanted:g}",
                _two(max(size["map"]["made_s"] for size in mapped if _between(size, *bounds))),
            ]
            for largest, wanted, bounds in ((2, 0.1, (0, 2)), (5, 0.5, (2, 5)))
            if any(_between(size, *bounds) for size in mapped)
        ),
        [
            "certified error of a map / largest force",
            "1e-7",
            f"{max(size['map']['certified_over_largest_force'] for size in mapped):.1e}",
        ],
    ]
    least = [
        ["NumPy, one position after another, time / tweezer", "300", _two(min(one))],
        ["NumPy, in batches, time / tweezer", "300", _two(min(batches))],
    ]
    return [
        ["waves", "goal", "largest measured"],
        *rows,
        *([name, f"at least {wanted}", f"smallest {value}"] for name, wanted, value in least),
    ]


def _between(size: Results, low: float, high: float) -> bool:
    return low < size["diameter_um"] <= high


def _largest(entries: Iterable[Results], key: str) -> str:
    return f"{max(entry[key] for entry in entries):.1e}"


def _beads(waves: Results) -> list[list[str]]:
    rows: list[tuple[str, Callable[[Results], str]]] = [
        ("largest error, up to 20 radii", lambda bead: f"{bead['largest_error']:.1e}"),
        ("smallest estimate / error", lambda bead: _two(bead["least_estimate_over_error"])),
        (
            "reference, deviation from plane waves",
            lambda bead: f"{bead['truth_off_plane_waves']:.0e}",
        ),
        ("inside, µs", lambda bead: _two(bead["us"])),
        ("with the Jacobian, µs", lambda bead: _two(bead["with_jacobian_us"])),
    ]
    beads = waves["beads"]
    return [
        ["waves at 1e-8", *beads],
        *([label, *map(value, beads.values())] for label, value in rows),
    ]


def _by_size(waves: Results) -> list[list[str]]:
    headings = ["at 1e-8, µs", *(f"{size['diameter_um']:g} µm" for size in waves["sizes"]), "rays"]
    each = [size["bands"] for size in waves["sizes"]] + [waves["rays"]]
    rows = []
    for band in BANDS:
        rows.append([band, *(_two(of[band]["us"]) for of in each)])
        rows.append(["with Jacobian", *(_two(of[band]["with_jacobian_us"]) for of in each)])
        rows.append(["error", *(f"{of[band]['largest_error']:.0e}" for of in each)])
    return [headings, *rows]


def _maps(waves: Results) -> list[list[str]]:
    rows: list[tuple[str, Callable[[Results], str]]] = [
        ("time to build, ms", lambda of: _two(1e3 * of["made_s"])),
        ("time to load, ms", lambda of: _two(1e3 * of["loaded_s"])),
        ("reading, ns", lambda of: _two(of["read_ns"])),
        ("with Jacobian, ns", lambda of: _two(of["with_jacobian_ns"])),
        ("reach, µm", lambda of: _two(of["reach_um"])),
        ("pieces", lambda of: f"{of['pieces']}"),
        ("certified error / largest force", lambda of: f"{of['certified_over_largest_force']:.0e}"),
        ("error / largest force", lambda of: f"{of['error_over_largest_force']:.0e}"),
    ]
    mapped = [size for size in waves["sizes"] if size["map"]]
    return [
        ["map at 1e-7", *(f"{size['diameter_um']:g} µm" for size in mapped)],
        *([label, *(value(size["map"]) for size in mapped)] for label, value in rows),
    ]


def _others(waves: Results) -> list[list[str]]:
    rows: list[tuple[str, Callable[[Results], str]]] = [
        ("NumPy, µs", lambda of: _two(of["us"])),
        ("in batches, µs", lambda of: _two(of["in_batches_us"])),
        ("error", lambda of: f"{of['largest_error']:.0e}"),
        ("tweezer, µs", lambda of: _two(of["quadrature_us"])),
        ("error", lambda of: f"{of['quadrature_largest_error']:.0e}"),
        ("NumPy time / tweezer time", lambda of: _two(of["numpy_over_quadrature"])),
        ("in batches / tweezer", lambda of: _two(of["numpy_in_batches_over_quadrature"])),
    ]
    summed = [size for size in waves["sizes"] if size["numpy"]]
    return [
        ["sum of partial waves", *(f"{size['diameter_um']:g} µm" for size in summed)],
        *([label, *(value(size["numpy"]) for size in summed)] for label, value in rows),
    ]


def beyond(waves: Results) -> str:
    """Return a sentence on errors above the tolerance, or "" without such errors."""
    found = [
        f"{size['diameter_um']:g} µm ({band})"
        for size in waves["sizes"]
        for band, of in size["bands"].items()
        if of["largest_error"] > TOLERANCE
    ]
    return f"The error exceeds the tolerance at {', '.join(found)}. " if found else ""


def of_fatcuda(waves: Results) -> str:
    """Return a sentence on fatcuda, or that it was not measured."""
    if (found := waves["fatcuda"]) is None:
        return (
            "fatcuda, another wave-optics program (the extra `fatcuda`), requires Python 3.12 or "
            "newer and was not measured here."
        )
    return (
        f"fatcuda, another wave-optics program, takes {_two(found['us'])} µs per position in a "
        f"batch for the 1 µm bead, with an error of {found['largest_error']:.0e}."
    )


def block(results: Results) -> str:
    """Return the block of wave optics by bead size."""
    waves = results["waves"]
    lines = [
        *pages.tables(tables(waves)),
        *textwrap.wrap(f"{beyond(waves)}{of_fatcuda(waves)}", 110),
    ]
    return pages.block("waves", lines, results["machine"])


def draw(panels: Iterable[Axes], waves: Results) -> None:
    """Draw error against time by size, time against size, and the map's times."""
    by_tolerance, by_size, of_map = panels
    diameters = [size["diameter_um"] for size in waves["sizes"]]
    for i, size in enumerate(waves["sizes"]):
        shade = colormaps["viridis"](0.9 * i / max(len(waves["sizes"]) - 1, 1))
        times, errors = (
            [max(entry[key], 1e-16) for entry in size["inside"]] for key in ("us", "largest_error")
        )
        by_tolerance.plot(
            times, errors, color=shade, marker="s", markersize=3, linewidth=1,
            label=f"{size['diameter_um']:g} µm",
        )  # fmt: skip
    by_tolerance.set(xlabel="time per position (µs)", ylabel="largest error, wave optics, inside")
    for band, mark in _BAND_STYLES.items():
        times = [size["bands"][band]["us"] for size in waves["sizes"]]
        by_size.plot(diameters, times, label=band, **mark.both)
        rays = waves["rays"][band]["us"]
        by_size.axhline(rays, color=mark.colour, linewidth=0.8, linestyle=":")
    summed = [size for size in waves["sizes"] if size["numpy"]]
    for key, line in (("us", "-"), ("in_batches_us", "--")):
        times = [size["numpy"][key] for size in summed]
        name = "NumPy, one by one" if key == "us" else "NumPy, in batches"
        by_size.plot(
            [size["diameter_um"] for size in summed],
            times,
            color="0.5",
            linestyle=line,
            label=name,
        )
    by_size.plot([], [], color="0.3", linewidth=1, linestyle=":", label="ray optics, any size")
    by_size.set(xlabel="diameter (µm)", ylabel="time at 1e-8 (µs)")
    mapped = [size for size in waves["sizes"] if size["map"]]
    for mark, (key, factor, label) in zip(style.SERIES, (
        ("made_s", 1.0, "build"), ("loaded_s", 1.0, "load"), ("read_ns", 1e-9, "read"),
        ("with_jacobian_ns", 1e-9, "read with Jacobian"),
    ), strict=False):  # fmt: skip
        times = [factor * size["map"][key] for size in mapped]
        diameters = [size["diameter_um"] for size in mapped]
        of_map.plot(diameters, times, label=label, **mark.both)
    of_map.set(xlabel="diameter (µm)", ylabel="time, wave-optics map (s)")
    for axes in (by_tolerance, by_size, of_map):
        axes.set(xscale="log", yscale="log")
        axes.grid(visible=True)
        axes.legend(
            loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=1 if axes is of_map else 2
        )


def _two(value: float) -> str:
    """Return a number with two digits."""
    return f"{float(f'{value:.1e}'):g}"
