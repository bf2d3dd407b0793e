"""Mean times until a bead leaves a ball: in closed form, and by a matrix on a square grid."""

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve


def of_spring(depth, radius, diffusion):
    """From the centre of a spring that is `depth` k_B T at the radius: all directions alike, s."""
    r = np.linspace(0, radius, 200_001)[1:]
    u = depth * (r / radius) ** 2
    within = r[0] ** 3 / 3 + cumulative_trapezoid(r**2 * np.exp(-u), r, initial=0)
    return np.trapezoid(np.exp(u) / r**2 * within, r) / diffusion


def along_a_line(z, force, diffusion, thermal, start, *, wall):
    """From `start` until the bead is at the last z, or at the first, if no wall is there.

    force, N, and diffusion at z, (n,) each.
    """
    u = -cumulative_trapezoid(force, z, initial=0) / thermal
    u -= u.min()
    weight = cumulative_trapezoid(np.exp(-u), z, initial=0)
    up = cumulative_trapezoid(np.exp(u) / diffusion * weight, z, initial=0)
    resistance = cumulative_trapezoid(np.exp(u) / diffusion, z, initial=0)
    back = 1.0 if wall else resistance / resistance[-1]
    return np.interp(start, z, up[-1] * back - up)


def on_a_square_grid(force, diffusion, thermal, radius, step, start):
    """In the half plane of the axis, in the ball; force(places) N. Of short times only."""
    n = int(radius / step)
    rho, z = (np.arange(n) + 0.5) * step, (np.arange(-n, n) + 0.5) * step
    inside = np.hypot(rho[:, None], z) < radius
    number = np.where(inside, np.cumsum(inside).reshape(inside.shape) - 1, -1)
    total = int(inside.sum())
    rows, columns, rates = [], [], []
    for dr, dz in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        i, j = np.nonzero(inside)
        if dr < 0:
            i, j = i[i > 0], j[i > 0]
        face = rho[i] + dr * step / 2
        places = np.stack([face, 0 * face, z[j] + dz * step / 2], axis=1)
        pushed = force(places) @ [dr, 0, dz] * step / thermal
        there_i, there_j = i + dr, j + dz
        beyond = (there_i >= n) | (there_j < 0) | (there_j >= 2 * n)
        there = np.where(beyond, -1, number[np.minimum(there_i, n - 1), there_j % (2 * n)])
        # half the distance: the drift is of second order beside it
        rate = diffusion / step**2 * np.exp(pushed / 2) * face / rho[i]
        here = number[i, j]
        rows += [here, here[there >= 0]]
        columns += [here, there[there >= 0]]
        rates += [-rate, rate[there >= 0]]
    matrix = coo_matrix(
        (np.concatenate(rates), (np.concatenate(rows), np.concatenate(columns))), (total, total)
    )
    times = spsolve(matrix.tocsc(), -np.ones(total))
    column = number[0]
    return np.interp(start, z[column >= 0], times[column[column >= 0]])
