"""Pictures of the light over the pupil, for pages: hue is the phase, brightness the amplitude."""

from __future__ import annotations

import base64
import math
from io import BytesIO

import numpy as np

from tweezer.optics.beam import intensity
from tweezer.optics.waves.light import waves_on_bead
from tweezer.optics.waves.pupil import Pupil
from tweezer.scene import Scene
from tweezer.values.arrays import Array

#: Width of a picture, pixels
_WIDTH = 128
#: Number of azimuths at which the light is computed
_TURN = 720


def pupil_pictures(scene: Scene) -> list[dict[str, str]]:
    """Return a picture, as the URL of a PNG, for each beam whose pupil has a phase or a shape."""
    found = []
    for number, beam in enumerate(scene.beams, start=1):
        alone = scene.with_one_beam(beam)
        if not alone.lit or scene.theory != "waves":
            continue
        pupil = waves_on_bead(alone).pupil
        if pupil is not None:
            name = "pupil" if len(scene.beams) == 1 else f"pupil of beam {number}"
            found.append({"name": name, "image": _png(_coloured(alone, pupil))})
    return found


def _coloured(scene: Scene, pupil: Pupil) -> Array:
    """Return the colours (rows, columns, 4) of the light over the pupil, x to the right, y up."""
    from matplotlib import colormaps

    across = (np.arange(_WIDTH) + 0.5) / _WIDTH * 2 - 1
    x, y = np.meshgrid(across, -across)
    rho, phi = np.hypot(x, y), np.arctan2(y, x)
    within = rho <= 1
    light = np.zeros(rho.shape, complex)
    radii, angles = (np.arange(_WIDTH) + 0.5) / _WIDTH, 2 * math.pi * np.arange(_TURN) / _TURN
    nearest = np.minimum((rho[within] * _WIDTH).astype(int), _WIDTH - 1)
    turned = np.rint(phi[within] / (2 * math.pi) * _TURN).astype(int) % _TURN
    light[within] = pupil.factor(radii, angles)[nearest, turned]
    profile = intensity(scene.lens, scene.beam, scene.medium)
    light[within] *= np.sqrt(profile(rho[within] * scene.lens.radius))
    colours = colormaps["hsv"]((np.angle(light) / (2 * math.pi)) % 1)
    size = np.abs(light) / np.abs(light).max()
    colours[..., :3] *= size[..., None]
    colours[..., 3] = within
    return np.asarray(colours)


def _png(colours: Array) -> str:
    """Return the URL of a PNG with these colours."""
    from matplotlib.image import imsave

    buffer = BytesIO()
    imsave(buffer, colours, format="png")
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
