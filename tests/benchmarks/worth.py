"""Makes tweezer/optics/ray_optics_worth.csv: traps of ray optics against those of waves.

`python -m tests.benchmarks.worth` takes half an hour. Circular light, sine condition, light alone.
The exact force is that of `tests.reference.waves`, that of rays is tweezer's; the latter does not
depend on the wavelength, so one trap serves every size.
"""

from __future__ import annotations

import csv
import math
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import tweezer
from tests.reference.waves import Light, Sphere, force
from tweezer.optics.worth import RATIOS, SHIFT

FILE = Path(tweezer.__file__).parent / "optics" / "ray_optics_worth.csv"

INDEX_RATIOS = (1.05, 1.09, 1.195, 1.3)
APERTURES = (0.25, 0.45, 0.65, 0.8, 0.9, 0.98)
#: of the beam, in radii of the pupil: as wide as it, and evenly lit
WAISTS = (1.0, 100.0)
#: diameters in wavelengths in the medium
SIZES = 2 ** np.arange(-2, 4.01, 0.25)

#: Samples per wavelength on lines
SAMPLES = 14
#: Half the distance, in wavelengths, of the difference that gives a stiffness
STEP = 1e-3
#: Places computed at once
AT_ONCE = 400


@dataclass(frozen=True)
class Trap:
    """About the stable equilibrium nearest the focus; in n_m P/c and radii."""

    rest: float
    stiffness_across: float
    stiffness_along: float
    escape_across: float
    escape_forward: float
    escape_backward: float


def by_waves(light: Light, sphere: Sphere) -> Trap | None:
    """The trap of wave optics, if there is one."""
    r = sphere.radius

    def axial(z):
        parts = np.array_split(z, -(-len(z) // AT_ONCE))
        return np.concatenate([force(light, sphere, 0 * part, part)[:, 2] for part in parts])

    def stiffness(z):
        along = -np.diff(axial(np.array([z - STEP, z + STEP])))[0] / (2 * STEP)
        return -force(light, sphere, [STEP], [z])[0, 0] / STEP, along

    squared = light.effective_aperture**2
    reach = min(2 * r + 3 / squared, 20 * r + 6 / squared)
    z = samples(-reach, reach)
    pull = axial(z)
    places = [
        brentq(lambda at: axial(np.array([at]))[0], z[i], z[i + 1], xtol=1e-9)
        for i in np.flatnonzero((pull[:-1] > 0) & (pull[1:] <= 0))
    ]
    stable = [place for place in places if min(stiffness(place)) > 0]
    if not stable:
        return None
    rest = min(stable, key=abs)
    rho = samples(0, 1.3 * r + 1 / math.sqrt(squared) + 0.3)
    k_across, k_along = stiffness(rest)
    return Trap(
        rest / r,
        k_across * r,
        k_along * r,
        largest_pull(-force(light, sphere, rho, np.full_like(rho, rest))[:, 0]),
        largest_pull(-axial(samples(rest, reach))),
        largest_pull(axial(samples(rest, -reach))),
    )


def samples(start, stop):
    """Places on a line."""
    return np.linspace(start, stop, int(abs(stop - start) * SAMPLES) + 2)


def largest_pull(pull):
    """Largest value before the pull ends, by a parabola through three samples."""
    ends = np.flatnonzero(pull[1:] <= 0)
    pull = pull[: ends[0] + 2] if ends.size else pull
    i = int(pull.argmax())
    if not 0 < i < len(pull) - 1:
        return float(pull[i])
    a, b, c = pull[i - 1 : i + 2]
    return float(b - (a - c) ** 2 / (8 * (a - 2 * b + c)))


def by_rays(light: Light, index_ratio: float) -> Trap | None:
    """The trap of ray optics."""
    n_m, R, r, P = 1.33, 4e-3, 5e-6, 0.01
    beam = {"wavelength": 1064e-9, "power_through_pupil": P, "profile": "gaussian"}
    scene = tweezer.load_scene(
        {
            "bead": {"radius": r, "density": 1000, "refractive_index": n_m * index_ratio},
            "medium": {
                "refractive_index": n_m, "density": 1000, "viscosity": 1e-3, "temperature": 293,
            },
            "lens": {"map": "sine", "radius": R, "numerical_aperture": light.aperture * n_m},
            "beam": {**beam, "sigma": light.waist * R / 2},
            "start": {"position": [0, 0, 0]},
            "forces": {"gravity": False, "buoyancy": False},
            "simulation": {"duration": 1e-3},
        }
    )  # fmt: skip
    trap = tweezer.characterise(scene)
    if trap.equilibrium is None:
        return None
    unit = n_m * P / 299792458.0
    escapes = {escape.direction: escape.force / unit for escape in trap.escapes}
    (k_across, _, _), _, (_, _, k_along) = trap.equilibrium.stiffness
    return Trap(
        trap.equilibrium.position[2] / r,
        k_across * r / unit,
        k_along * r / unit,
        escapes["+x"],
        escapes["+z"],
        escapes["-z"],
    )


def row(light: Light, index_ratio: float, wavelengths: float, rays: Trap) -> list[str]:
    """A row of the table: the case, and waves against rays; empty where waves have no trap."""
    waves = by_waves(light, Sphere(wavelengths / 2, index_ratio))
    case = (index_ratio, light.effective_aperture, wavelengths)
    against = [""] * (1 + len(RATIOS))
    if waves:
        ratios = [getattr(waves, name) / getattr(rays, name) for name in RATIOS]
        against = [f"{number:.3g}" for number in (waves.rest - rays.rest, *ratios)]
    return [f"{number:.4g}" for number in case] + against


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore", tweezer.PhysicsWarning)
    with FILE.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["index_ratio", "aperture", "wavelengths", SHIFT, *RATIOS])
        for index_ratio in INDEX_RATIOS:
            for aperture in APERTURES:
                for waist in WAISTS:
                    light = Light(aperture, waist)
                    if rays := by_rays(light, index_ratio):
                        rows = [row(light, index_ratio, size, rays) for size in SIZES]
                        table.writerows(rows)


if __name__ == "__main__":
    main()
