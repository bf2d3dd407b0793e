"""Exact forces, torques and absorbed powers to test faster code with: tests/data/waves.json.

`python -m tests.reference.waves_table` makes the file from `tests.reference.plane_waves`. Every row
is computed twice, the second time with twice the nodes; `ERROR` is the largest difference allowed.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from tests.reference.plane_waves import SPEED_OF_LIGHT, Light, Sphere, lens, push

FILE = Path(__file__).parents[1] / "data" / "waves.json"
#: Largest part of a force by which twice the nodes may change it
ERROR = 1e-11

ABOUT = """\
1 W through the pupil. SI units. exp(-i w t): (1, i)/sqrt2 is helicity +1, Im(n) > 0 absorbs. \
place: of the sphere's centre from the (nominal) focus. force, torque about the centre, absorbed. \
layers: [outer radius, Re n, Im n] from the core outwards. pupil: intensity \
(rho/R)^(2 ring) exp(-2 (rho/(waist R))^2), null for no Gaussian. polarisation: a name, or the \
Jones vector [Re a, Im a, Re b, Im b]. vortex: l of exp(i l phi). half_angle: of the cone, before \
the face if there is a cover: [index before the face, depth of the nominal focus behind it].\
"""

LEFT = [math.sqrt(0.5), 0, 0, math.sqrt(0.5)]
RIGHT = [math.sqrt(0.5), 0, 0, -math.sqrt(0.5)]
X = [1, 0, 0, 0]
ELLIPTIC = [0.6, 0, 0.48, 0.64]
PS, SILICA, GOLD, DYED = (1.59, 0.0), (1.45, 0.0), (0.26, 6.97), (1.59, 0.01)
INSIDE, EDGE, OUTSIDE, AXIS = (0.4, -0.3, 0.5), (0.6, 0.7, -0.4), (1.5, -1.2, 1.0), (0, 0, 0.8)
FAR = (-6, 4, 5)


def ball(radius, index):
    """Layers of a homogeneous sphere, radius in um."""
    return [[radius * 1e-6, *index]]


def shone(polarisation, NA=1.2, waist=1.0, ring=0, vortex=0, cover=None, **other):
    """Light of a lens of the sine condition, by default; a vortex brings its own ring."""
    before = 1.33 if cover is None else cover[0]
    light = {
        "medium": 1.33,
        "wavelength": 1.064e-6,
        "lens": "sine",
        "half_angle": math.asin(NA / before),
        "waist": waist,
        "ring": ring or abs(vortex),
        "polarisation": polarisation,
        "vortex": vortex,
        "cover": cover,
    }
    return {**light, **other}


def thesis(polarisation):
    """Light of the 500 nm bead of the thesis: a lens of the tan map, sigma 2.5 mm of 2.6 mm."""
    angle = math.atan(2.6 / 2)
    return shone(polarisation, waist=5 / 2.6, wavelength=0.8e-6, lens="tan", half_angle=angle)


HOLLOW = [[0.35e-6, 1.0, 0.0], [0.5e-6, 1.45, 0.0]]
COATED = [[0.4e-6, *PS], [0.5e-6, 1.9, 0.0]]
METAL_CORE = [[0.1e-6, *GOLD], [0.4e-6, *SILICA]]
DYED_CORE = [[0.2e-6, 1.59, 0.05], [0.3e-6, 1.4, 0.0], [0.5e-6, *PS]]
OIL_5, OIL_20 = [1.518, 5e-6], [1.518, 20e-6]

#: name, layers, light, and places in radii
SCENES = [
    ("PS 0.1 um", ball(0.05, PS), shone(LEFT), (INSIDE, (3, -4, 5), (30, 10, -20))),
    ("PS 0.2 um", ball(0.1, PS), shone(LEFT), (INSIDE, OUTSIDE)),
    ("PS 0.5 um", ball(0.25, PS), shone(LEFT), (INSIDE, EDGE, OUTSIDE, AXIS, FAR)),
    ("PS 0.5 um, right", ball(0.25, PS), shone(RIGHT), (EDGE,)),
    ("PS 0.5 um, linear", ball(0.25, PS), shone(X, waist=None), (INSIDE, EDGE)),
    ("PS 1 um", ball(0.5, PS), shone(LEFT), (INSIDE, EDGE, OUTSIDE, AXIS, FAR)),
    ("PS 1 um, elliptic", ball(0.5, PS), shone(ELLIPTIC, waist=0.7), (INSIDE, EDGE)),
    ("PS 1 um, NA 1.3", ball(0.5, PS), shone(ELLIPTIC, NA=1.3, waist=None), (EDGE, OUTSIDE)),
    ("PS 1 um, NA 0.3", ball(0.5, PS), shone(X, NA=0.3), (EDGE, AXIS)),
    ("PS 2 um", ball(1, PS), shone(RIGHT, NA=1.0), (INSIDE, EDGE)),
    ("PS 5 um", ball(2.5, PS), shone("unpolarised"), (INSIDE, EDGE, AXIS)),
    ("thesis 0.5 um", ball(0.25, (1.57773, 0)), thesis("unpolarised"), (INSIDE, EDGE, FAR)),
    ("silica 1 um", ball(0.5, SILICA), shone("unpolarised"), (INSIDE, EDGE, OUTSIDE)),
    ("silica 1 um, radial", ball(0.5, SILICA), shone("radial", ring=1), (INSIDE, EDGE)),
    ("silica 1 um, azimuthal", ball(0.5, SILICA), shone("azimuthal", ring=1), (INSIDE, AXIS)),
    ("silica 1 um, vortex 1", ball(0.5, SILICA), shone(X, vortex=1), (INSIDE, EDGE)),
    ("silica 1 um, vortex -2", ball(0.5, SILICA), shone(X, vortex=-2), (INSIDE, OUTSIDE)),
    ("gold 0.1 um", ball(0.05, GOLD), shone(LEFT), (INSIDE, (4, -3, 2), AXIS)),
    ("gold 0.1 um, linear", ball(0.05, GOLD), shone(X), ((2, 3, -1),)),
    ("gold 1 um", ball(0.5, GOLD), shone(ELLIPTIC), (EDGE,)),
    ("dyed 1 um", ball(0.5, DYED), shone(LEFT), (INSIDE, EDGE, AXIS)),
    ("dyed 1 um, unpolarised", ball(0.5, DYED), shone("unpolarised"), (EDGE,)),
    ("dyed 1 um, radial", ball(0.5, DYED), shone("radial", ring=1), (EDGE,)),
    ("dyed 1 um, azimuthal", ball(0.5, DYED), shone("azimuthal", ring=1), (INSIDE,)),
    ("dyed 1 um, vortex 1", ball(0.5, DYED), shone(LEFT, vortex=1), (EDGE, AXIS)),
    ("dyed 1 um, vortex -2", ball(0.5, DYED), shone(ELLIPTIC, vortex=-2), (EDGE,)),
    ("hollow 1 um", HOLLOW, shone(ELLIPTIC), (INSIDE, EDGE)),
    ("coated 1 um", COATED, shone(LEFT), (INSIDE, EDGE, AXIS)),
    ("metal core", METAL_CORE, shone(LEFT), (INSIDE, OUTSIDE)),
    ("dyed core", DYED_CORE, shone(X), (INSIDE,)),
    ("PS 1 um, 5 um deep", ball(0.5, PS), shone(LEFT, cover=OIL_5), ((0.4, -0.3, -2), (1, 1, -3))),
    ("dyed 1 um, 20 um deep", ball(0.5, DYED), shone(X, cover=OIL_20), ((0.4, -0.3, -6),)),
    (
        "PS 0.5 um, NA 1.4, 5 um deep",
        ball(0.25, PS),
        shone("unpolarised", NA=1.4, cover=OIL_5),
        ((1, -0.5, -4),),
    ),
    (
        "dyed 1 um, vortex 1, 5 um deep",
        ball(0.5, DYED),
        shone(ELLIPTIC, vortex=1, cover=OIL_5),
        ((0.6, 0.7, -2), (0, 0, -2)),
    ),
    (
        "silica 1 um, radial, 20 um deep",
        ball(0.5, SILICA),
        shone("radial", ring=1, cover=OIL_20),
        ((0.4, -0.3, -6),),
    ),
]


def exact(row, finer=1.0):
    """The push of a row's light on its sphere."""
    waist = math.inf if row["waist"] is None else row["waist"]
    polarisation = row["polarisation"]
    if not isinstance(polarisation, str):
        re_a, im_a, re_b, im_b = polarisation
        polarisation = (complex(re_a, im_a), complex(re_b, im_b))
    light = Light(
        row["medium"],
        row["wavelength"],
        row["half_angle"],
        lens(row["half_angle"], waist, row["ring"], row["lens"]),
        polarisation,
        row["vortex"],
        row["cover"] and tuple(row["cover"]),
    )
    sphere = Sphere(tuple((radius, complex(*index)) for radius, *index in row["layers"]))
    return push(light, sphere, row["place"], finer)


def rows():
    """The rows of the file."""
    return json.loads(FILE.read_text())["rows"]


def make():
    """Compute every row, and write the file."""
    made, worst = [], 0.0
    for name, layers, light, places in SCENES:
        for place in places:
            at = [float(f"{x * layers[-1][0]:.12g}") for x in place]
            row = {"name": name, "layers": layers, **light, "place": at}
            found, again = exact(row), exact(row, finer=2)
            size = np.linalg.norm(again.force)
            changes = [
                np.linalg.norm(found.force - again.force) / size,
                # what turns or heats is at most as strong as what pushes
                np.linalg.norm(found.torque - again.torque)
                * light["medium"]
                * 2
                * math.pi
                / light["wavelength"]
                / size,
                abs(found.absorbed - again.absorbed) * light["medium"] / SPEED_OF_LIGHT / size,
            ]
            print(f"{name:34} {place} {max(changes):.1e}")
            worst = max(worst, *changes)
            row["force"], row["torque"] = again.force.tolist(), again.torque.tolist()
            row["absorbed"] = float(again.absorbed)
            made.append(row)
    if worst > ERROR:
        raise SystemExit(f"twice the nodes change a row by {worst:.1e} of its force")
    lines = ",\n  ".join(json.dumps(row) for row in made)
    FILE.write_text(f'{{\n"about": {json.dumps(ABOUT)},\n"rows": [\n  {lines}\n]}}\n')
    print(f"{len(made)} rows, changed by {worst:.1e} at most")


if __name__ == "__main__":
    make()
