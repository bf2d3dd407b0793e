"""Makes tweezer/optics/ray_optics_worth.csv: forces and traps of ray optics against those of waves.

`python -m tests.benchmarks.worth` takes some minutes. Unpolarised light, sine condition, light
alone. Both forces are tweezer's. That of rays does not depend on the wavelength, so it is computed
once for every size.
"""

from __future__ import annotations

import csv
import functools
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import tweezer
from tests.reference.waves import Light, Sphere
from tweezer.optics import light_force as light_of
from tweezer.optics.worth import ERRORS, RATIOS, RAY_TRAP, SHIFT

FILE = Path(tweezer.__file__).parent / "optics" / "ray_optics_worth.csv"

INDEX_RATIOS = (0.76, 0.9, 1.05, 1.09, 1.195, 1.3, 1.5, 1.8)
APERTURES = (0.25, 0.45, 0.65, 0.8, 0.9, 0.98)
#: of the beam, in radii of the pupil: as wide as it, and evenly lit
WAISTS = (1.0, 100.0)
#: diameters in wavelengths in the medium
SIZES = 2 ** np.append(np.arange(-2, 4.01, 0.25), [4.5, 5])

N_M, WAVELENGTH = 1.33, 1064e-9

#: Samples per wavelength on lines
SAMPLES = 14
#: Half the distance, in wavelengths, of the difference that gives a stiffness
STEP = 1e-3
#: Distances of the focus, radii: inside up to the first, at the edge up to the second
INSIDE, EDGE = 0.7, 1.6
#: Distance of the places, radii, at which forces are compared
SPACING = 0.07

#: The force (n, 3) n_m P/c at (rho, 0, z), in wavelengths in the medium
Force = Callable[..., np.ndarray]


@dataclass(frozen=True)
class Trap:
    """About the stable equilibrium nearest the focus; in n_m P/c and radii."""

    rest: float
    stiffness_across: float
    stiffness_along: float
    escape_across: float
    escape_forward: float
    escape_backward: float


def scene_of(light: Light, sphere: Sphere, theory: str) -> tweezer.Scene:
    """The scene of that light on that sphere."""
    R, radius = 4e-3, sphere.radius * WAVELENGTH / N_M
    return tweezer.load_scene(
        {
            "bead": {
                "radius": radius, "density": 1000, "refractive_index": N_M * sphere.index_ratio,
            },
            "medium": {
                "refractive_index": N_M, "density": 1000, "viscosity": 1e-3, "temperature": 293,
            },
            "lens": {"map": "sine", "radius": R, "numerical_aperture": light.aperture * N_M},
            "beam": {
                "wavelength": WAVELENGTH, "power_through_pupil": 0.01, "profile": "gaussian",
                "sigma": f"{1e3 * light.waist * R / 2} mm", "polarisation": "unpolarised",
            },
            "optics": {"theory": theory, "evaluator": "quadrature"},
            "start": {"position": [0, 0, 0]},
            "forces": {"gravity": False, "buoyancy": False},
            "simulation": {
                "duration": 1e-3, "loss_distance": farthest(light, sphere.radius) * WAVELENGTH / N_M
            },
        }
    )  # fmt: skip


def farthest(light: Light, radius: float) -> float:
    """Half the length of the axis on which a trap is looked for, wavelengths."""
    squared = light.effective_aperture**2
    return min(2 * radius + 3 / squared, 20 * radius + 6 / squared)


def force_of(light: Light, sphere: Sphere, theory: str) -> Force:
    """The force of tweezer."""
    bound = light_of(scene_of(light, sphere, theory))
    unit, strength = WAVELENGTH / N_M, bound.light.strength

    def force(rho, z):
        rho, z = np.broadcast_arrays(np.asarray(rho, float), np.asarray(z, float))
        return bound.field(unit * np.stack([rho, 0 * rho, z], axis=1)).force / strength

    return force


def by_waves(light: Light, sphere: Sphere, force: Force) -> Trap | None:
    """The trap of a force of waves, if there is one."""
    r = sphere.radius

    def axial(z):
        return force(0 * z, z)[:, 2]

    def stiffness(z):
        along = -np.diff(axial(np.array([z - STEP, z + STEP])))[0] / (2 * STEP)
        return -force([STEP], [z])[0, 0] / STEP, along

    reach = farthest(light, r)
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
    rho = samples(0, 1.3 * r + 1 / light.effective_aperture + 0.3)
    k_across, k_along = stiffness(rest)
    return Trap(
        rest / r,
        k_across * r,
        k_along * r,
        largest_pull(-force(rho, rest)[:, 0]),
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
    """The trap of ray optics, if there is one."""
    scene = scene_of(light, Sphere(6.0, index_ratio), "rays")
    r, unit = scene.bead.radius, light_of(scene).light.strength
    trap = tweezer.characterise(scene)
    if trap.equilibrium is None:
        return None
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


@functools.cache
def places() -> tuple[np.ndarray, np.ndarray]:
    """rho and z (n,) up to the edge, radii."""
    steps = np.arange(0.0, EDGE + SPACING / 2, SPACING)
    rho, z = (each.ravel() for each in np.meshgrid(steps, np.concatenate([-steps[:0:-1], steps])))
    near = np.hypot(rho, z) <= EDGE
    return rho[near], z[near]


def errors(force: Force, radius: float, rays: np.ndarray) -> tuple[float, ...]:
    """Errors of the forces of rays at the `places`, of the largest: see `ERRORS`."""
    rho, z = places()
    off = np.linalg.norm(force(radius * rho, radius * z) - rays, axis=1)
    off /= np.linalg.norm(rays, axis=1).max()
    inside = np.hypot(rho, z) <= INSIDE
    volume = rho[inside]
    rms = math.sqrt(float(volume @ off[inside] ** 2 / volume.sum()))
    return rms, float(off[inside].max()), float(off[~inside].max())


def rows(light: Light, index_ratio: float) -> Iterator[list[str]]:
    """Rows of the table: the case, and rays against waves; empty where waves have no trap."""
    by_ray = force_of(light, Sphere(1.0, index_ratio), "rays")(*places())
    rays = by_rays(light, index_ratio)
    for size in SIZES:
        sphere = Sphere(size / 2, index_ratio)
        force = force_of(light, sphere, "waves")
        waves = by_waves(light, sphere, force) if rays else None
        case = (index_ratio, light.effective_aperture, size, rays is not None)
        row = [f"{number:.4g}" for number in case]
        row += [f"{error:.3g}" for error in errors(force, sphere.radius, by_ray)]
        ratios = [""] * (1 + len(RATIOS))
        if rays and waves:
            against = [getattr(waves, name) / getattr(rays, name) for name in RATIOS]
            ratios = [f"{number:.3g}" for number in (waves.rest - rays.rest, *against)]
        yield row + ratios


def main() -> None:
    """Write the table."""
    warnings.simplefilter("ignore", tweezer.PhysicsWarning)
    found = [
        row
        for index_ratio in INDEX_RATIOS
        for aperture in APERTURES
        for waist in WAISTS
        for row in rows(Light(aperture, waist), index_ratio)
    ]
    with FILE.open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            ["index_ratio", "aperture", "wavelengths", RAY_TRAP, *ERRORS, SHIFT, *RATIOS]
        )
        table.writerows(found)


if __name__ == "__main__":
    main()
