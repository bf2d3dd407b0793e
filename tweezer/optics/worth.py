"""Validity of ray optics for a bead: comparison with the exact force of wave optics.

The numbers are in `ray_optics_worth.csv`, which `tests/benchmarks/worth.py` computes.
"""

from __future__ import annotations

import csv
import dataclasses
import functools
import json
import math
from dataclasses import dataclass
from importlib import resources

import numpy as np

from tweezer.optics.beam import cone
from tweezer.optics.light import LENGTHS
from tweezer.scene import Scene
from tweezer.scene.theory import FARTHEST_IN_WAVES, LARGEST_IN_WAVES, largest_wavenumber, no_waves
from tweezer.values.arrays import Array
from tweezer.values.printed import printed
from tweezer.values.shown import Row

Range = tuple[float, float]

#: Range of n_P/n_m in which ray optics was compared with wave optics
INDEX_RATIOS = (0.7, 1.9)
#: Largest ratio of the sizes of two beads that count as similar. The exact force oscillates with
#: size, with a period of half a wavelength
ALIKE = math.sqrt(2.0)
#: Factor by which ranges are widened, because the table has gaps. In 184 random trusted cases the
#: widened ranges contained 94 to 99 % of the exact ratios
MARGIN = 1.1
#: Column of the table: 1 if rays predict a trap, or else 0
RAY_TRAP = "ray_trap"
#: Columns of the table: errors of the force by rays, over the largest such force. The first two are
#: the root mean square and the largest with the focus up to 0.7 radii from the centre. The third is
#: the largest from there to 1.6 radii
ERRORS = ("force_inside_rms", "force_inside", "force_at_edge")
#: Column of the table: equilibrium by waves minus the one by rays, in radii
SHIFT = "equilibrium_shift"
#: Columns of the table: ratios of wave optics to ray optics
RATIOS = (
    "stiffness_across",
    "stiffness_along",
    "escape_across",
    "escape_forward",
    "escape_backward",
)


@dataclass(frozen=True)
class RayOpticsWorth:
    """Ratios of wave optics to ray optics for beads and light like those of a scene.

    A range extends from the smallest to the largest value among beads of 0.7 to 1.4 times the size,
    at the apertures and indices of the table next to the scene's, and is widened by a tenth. It is
    None if the theories were not compared for this index (n_P below 0.7 or above 1.9 n_m). Except
    for the errors of the force, it is also None if one of the theories has no trap.
    """

    wavelengths: float
    """the bead's diameter in wavelengths in the medium"""
    focal_spot: float
    """2 lambda/(pi NA), m, the waist diameter of a Gaussian beam. NA = n_m sqrt(2 <sin^2 theta>),
    averaged over the power of the light, is the lens's NA if its pupil is evenly lit"""
    focal_spots: float
    """the bead's diameter in focal spots"""
    force_inside_rms: Range | None
    """root mean square error of the force by ray optics, relative to its largest value, where the
    focus is within 0.7 radii of the bead's centre"""
    force_inside: Range | None
    """largest error, relative to the same value, where the focus is within 0.7 radii of the
    centre"""
    force_at_edge: Range | None
    """largest relative error where the focus is 0.7 to 1.6 radii from the centre"""
    equilibrium_shift: Range | None
    """z of the equilibrium by wave optics minus z by ray optics, m"""
    stiffness_across: Range | None
    """ratio of k_xx and k_yy"""
    stiffness_along: Range | None
    """ratio of k_zz"""
    escape_across: Range | None
    """ratio of the force of `Escape` along x and y"""
    escape_forward: Range | None
    """ratio of the force of `Escape` along +z"""
    escape_backward: Range | None
    """ratio of the force of `Escape` along -z"""
    trapped: float | None
    """fraction of the traps predicted by ray optics that exist in wave optics"""
    trusted: bool
    """whether ray optics is meaningful: the bead is larger than both the wavelength in the medium
    and the focal spot, and wave optics predicts a trap too"""

    @property
    def size(self) -> str:
        """Size of the bead, in wavelengths and focal spots."""
        return f"{self.wavelengths:.2g} wavelengths, {self.focal_spots:.2g} focal spots across"

    @property
    def verdict(self) -> str:
        """Validity of ray optics in a few words, which follow "ray optics is"."""
        if not self.trusted:
            return "not to be trusted"
        if self.force_inside is None or self.force_at_edge is None:
            return "not compared with wave optics"
        largest = max(self.force_inside, self.force_at_edge, key=lambda errors: errors[1])
        return f"wrong by up to {_percent(largest)} of the largest force"

    @property
    def in_short(self) -> str:
        """Summary in a few words, for a line of a table."""
        if not self.trusted:
            return f"not to be trusted: bead {self.size}"
        if self.force_inside is None:
            return "not compared with wave optics for this light and bead"
        if self.trapped is None:
            return (
                f"waves differ by up to {_percent(self.force_inside)} of the largest force inside "
                f"the bead, {_percent(self.force_at_edge)} at its edge"
            )
        across, along = between(self.stiffness_across), between(self.stiffness_along)
        return f"waves give {across} times its stiffness across, {along} times along"


@functools.lru_cache(maxsize=16)
def ray_optics_worth(scene: Scene) -> RayOpticsWorth | None:
    """Return the validity of ray optics for the bead and the light of `scene`.

    The result is None without light, or if the scene uses wave optics.

    The exact force is computed for unpolarised plane waves in phase at the focus (Debye's
    integral), scattered by a sphere (Mie). It oscillates with the bead's size, and only its average
    over sizes tends to ray optics (Mazolli, Maia Neto and Nussenzveig, Proc. R. Soc. A 459, 3021,
    2003). For beads outside the table's 0.25 to 32 wavelengths, and apertures outside its range,
    the ratios at its border are used. If there are several beams, the first is compared as if it
    were alone; counter-propagating beams were not compared. In linearly polarised light the exact
    stiffnesses along x and y also differ, by a third for beads of about a wavelength.
    """
    if not scene.lit or scene.theory == "waves":
        return None
    medium, diameter = scene.medium, 2 * scene.bead.radius
    aperture = cone(scene).spread
    index_ratio = scene.bead.index.real / medium.refractive_index
    wavelengths = diameter * medium.refractive_index / scene.beam.wavelength
    focal_spot = 2 * scene.beam.wavelength / (math.pi * aperture * medium.refractive_index)
    # beams that face each other form another trap than the table's
    alike = _alike(math.nan if _facing(scene) else index_ratio, aperture, wavelengths)
    by_rays = alike[RAY_TRAP] == 1
    trapped = ~np.isnan(alike["stiffness_across"])
    return RayOpticsWorth(
        wavelengths=wavelengths,
        focal_spot=focal_spot,
        focal_spots=diameter / focal_spot,
        trapped=float(trapped[by_rays].mean()) if by_rays.any() else None,
        trusted=bool(trapped[by_rays].all()) and wavelengths >= 1 and diameter >= focal_spot,
        equilibrium_shift=_range(scene.bead.radius * alike[SHIFT][trapped]),
        **{name: _range(alike[name], MARGIN) for name in ERRORS},
        **{name: _range(alike[name][trapped], MARGIN) for name in RATIOS},
    )


def _facing(scene: Scene) -> bool:
    """Return whether the scene has beams in opposite directions."""
    return len({beam.direction for beam in scene.beams}) > 1


def ray_optics_caveat(scene: Scene) -> str | None:
    """Return the validity of ray optics in one sentence, with the way to the exact force.

    Returns None without light, or if the scene uses wave optics.
    """
    worth = ray_optics_worth(scene)
    if worth is None:
        return None
    parts = [
        f"the bead is {worth.wavelengths:.2g} wavelengths across in the medium, "
        f"{worth.focal_spots:.2g} times the focal spot ({printed(worth.focal_spot, 'um', 2)})"
    ]
    if worth.force_inside is None:
        of = "beams that face each other" if _facing(scene) else "beads of this index"
        parts.append(f"ray optics was not compared with wave optics for {of}")
    else:
        parts.append(
            "relative to the largest force, ray optics is wrong by up to "
            f"{_percent(worth.force_inside)} with the focus inside the bead, "
            f"{_percent(worth.force_at_edge)} where the light grazes it"
        )
    if worth.trapped == 0:
        parts.append("where ray optics finds a trap, wave optics has none")
    elif worth.trapped is not None:
        parts.append(
            f"wave optics gives {between(worth.stiffness_across)} times its stiffness across the "
            f"light, {between(worth.stiffness_along)} times along it, and "
            f"{between(worth.escape_across)} times its escape force across, "
            f"{between(worth.escape_forward)} times forward"
        )
        if worth.trapped < 1:
            parts.append(
                f"it predicts no trap for {100 * (1 - worth.trapped):.0f} % of similar beads"
            )
    if not worth.trusted:
        parts.append("the trap of ray optics is not to be trusted")
    return "; ".join([*parts, _way_out(scene)])


def ray_optics_warning(scene: Scene) -> str | None:
    """Return the validity of ray optics in one line of about 90 characters.

    Returns None without light, or if the scene uses wave optics.
    """
    worth = ray_optics_worth(scene)
    if worth is None:
        return None
    return f"the bead is {worth.wavelengths:.2g} wavelengths across: ray optics is {worth.verdict}"


def _way_out(scene: Scene) -> str:
    """Return a clause on how to compute the exact force for a scene, or why this is impossible."""
    if (reason := no_waves(scene.optics, scene.beams)) is not None:
        return reason
    if (reason := _too_far_for_waves(scene)) is not None:
        return reason
    exact = "optics.theory = 'waves' is exact"
    farthest = FARTHEST_IN_WAVES / largest_wavenumber(scene.medium, scene.beams)
    if LENGTHS * scene.bead.radius / cone(scene).spread > farthest:
        exact += f", and available up to {farthest:.3g} m from the focus"
    if scene.optics.theory == "auto":
        return f"{exact}; 'auto' selected ray optics because {scene.theory_reason}"
    return exact


def _too_far_for_waves(scene: Scene) -> str | None:
    """Return why wave optics is not available for the bead of a scene; None if it is."""
    wavenumber = largest_wavenumber(scene.medium, scene.beams)
    largest, farthest = LARGEST_IN_WAVES / wavenumber, FARTHEST_IN_WAVES / wavenumber
    if scene.bead.radius > largest:
        return f"wave optics is available for beads up to {largest:.3g} m in radius"
    aside = max(float(np.linalg.norm(beam.position)) for beam in scene.beams)
    # a start lies within it
    if scene.simulation.loss_distance + aside > farthest:
        return (
            f"wave optics is available up to {farthest:.3g} m from the focus, less than "
            "simulation.loss_distance"
        )
    return None


def worth_attributes(scene: Scene) -> dict[str, str]:
    """Return the attributes of results that describe the theory of the light of `scene`.

    They are the theory and the reason for it, the validity of ray optics as a sentence, and
    `RayOpticsWorth` as JSON ("null" with wave optics).
    """
    worth = ray_optics_worth(scene)
    return {
        "theory": scene.theory,
        "theory_reason": scene.theory_reason,
        "ray_optics_caveat": ray_optics_caveat(scene) or "",
        "ray_optics_worth": json.dumps(worth and dataclasses.asdict(worth)),
    }


@functools.cache
def _table() -> dict[str, Array]:
    """Return the columns of `ray_optics_worth.csv` by name; NaN where wave optics has no trap."""
    with resources.files("tweezer.optics").joinpath("ray_optics_worth.csv").open() as file:
        names, *rows = csv.reader(file)
    values = [[float(each or "nan") for each in row] for row in rows]
    return dict(zip(names, np.array(values).T, strict=True))


def _alike(index_ratio: float, aperture: float, wavelengths: float) -> dict[str, Array]:
    """Return the table's rows for beads and light like those of a scene, by column.

    Their size differs by up to `ALIKE`; their apertures and index ratios are the nearest ones on
    both sides. `index_ratio` is n_P/n_m of bead and medium; outside `INDEX_RATIOS` no rows are
    alike. `aperture` is `Cone.spread`, and `wavelengths` the diameter of the bead in wavelengths in
    the medium.
    """
    table = _table()
    sizes = table["wavelengths"]
    size = min(max(wavelengths, sizes.min()), sizes.max())
    like = np.abs(np.log(sizes / size)) <= math.log(ALIKE)
    like &= INDEX_RATIOS[0] <= index_ratio <= INDEX_RATIOS[1]
    side = (table["index_ratio"] > 1) == (index_ratio > 1)
    like &= side
    for name, value in (("index_ratio", index_ratio), ("aperture", aperture)):
        levels = np.unique(table[name][side])
        above = levels[levels >= value].min(initial=levels[-1])
        below = levels[levels <= value].max(initial=levels[0])
        like &= (table[name] >= below) & (table[name] <= above)
    return {name: column[like] for name, column in table.items()}


def _range(values: Array, margin: float = 1.0) -> Range | None:
    """Return smallest and largest value, widened by the factor `margin`; None without values."""
    return (float(values.min()) / margin, float(values.max()) * margin) if values.size else None


def _percent(errors: Range | None) -> str:
    """Return the upper end of a range of relative errors in words: "12 %"; "" without a range."""
    return "" if errors is None else f"{float(f'{100 * errors[1]:.2g}'):g} %"


def rows_of_light(scene: Scene) -> list[Row]:
    """Return rows of a table on the theory of the light, its reason, and how valid rays are."""
    if not scene.lit:
        return [Row("light", "none")]
    rows = [Row("light", scene.theory), Row("  because", scene.theory_reason, detail=True)]
    if worth := ray_optics_worth(scene):
        rows += [Row("ray optics", worth.verdict), Row("  in detail", worth.in_short, detail=True)]
    return rows


def between(ratios: Range | None) -> str:
    """Return a range of ratios in words: "0.9 to 1.3"; "" without a range."""
    if ratios is None:
        return ""
    low, high = (f"{ratio:.2g}" for ratio in ratios)
    return low if low == high else f"{low} to {high}"
