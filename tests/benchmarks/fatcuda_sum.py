"""The force by fatcuda, another program of wave optics.

It is the extra `fatcuda`, and needs Python 3.12. It sums plane waves from the midpoints of a grid
over the pupil, here `NODES` in each direction.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tweezer.scene import Scene

Array = NDArray[np.float64]

NODES = 64


def force(scene: Scene, positions: Array) -> Array:
    """Force (n, 3) N of circular light, by a lens of the sine condition, on a homogeneous bead."""
    from fatcuda import (
        ForceTorque,
        GaussianBeam,
        OpticalSystem,
        PositionAxis,
        PupilGrid,
        Sphere,
        SweepSpec,
        solve,
    )  # fmt: skip

    lens, beam, n_m = scene.lens, scene.beam, scene.medium.refractive_index
    radius, k = scene.bead.radius, 2 * np.pi * n_m / beam.wavelength
    x = k * radius
    system = OpticalSystem(
        lambda0=beam.wavelength, NA=lens.numerical_aperture, nm=n_m,
        f=lens.radius * n_m / lens.numerical_aperture, grid=PupilGrid(Nphi=NODES, Nr=NODES),
        power=beam.power_through_pupil,
    )  # fmt: skip
    found = solve(
        beam=GaussianBeam(Ex0=1.0, Ey0=1j, w0=2 * beam.sigma), position=None, system=system,
        particle=Sphere(
            radius=radius, n_p=scene.bead.index.real, L=int(x + 4 * x ** (1 / 3) + 4)
        ),
        task=SweepSpec(ForceTorque(), (PositionAxis(positions),)), device="cpu",
    )  # fmt: skip
    return np.asarray(found.force)
