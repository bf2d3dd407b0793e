"""The thesis's chapter 3 as a user would write it in NumPy: angles, arctangents and all.

With the corrections of the errata: cos(alpha) = -u.P_PC/|P_PC| (3.11) and the force along n
opposite to (3.21).
"""

from __future__ import annotations

import numpy as np

SPEED_OF_LIGHT = 299792458.0


def lens_squares(radius, divisions):
    """Centres of the squares that lie wholly inside the lens, one by one (3.1)."""
    side = 2 * radius / divisions
    centres = []
    for i in range(divisions):
        for j in range(divisions):
            x, y = (i + 0.5) * side - radius, (j + 0.5) * side - radius
            farthest = max(np.hypot(x + a * side / 2, y + b * side / 2)
                           for a in (-1, 1) for b in (-1, 1))  # fmt: skip
            if farthest <= radius * (1 + 1e-12):
                centres.append((x, y))
    return np.array(centres), side**2


def force_and_moment(scene, position):
    """(3.2)-(3.26) for the tan map and averaged reflectance; position from the focus."""
    lens, beam = scene.lens, scene.beam
    n_m, n_p, r = scene.medium.refractive_index, scene.bead.refractive_index, scene.bead.radius
    squares, area = lens_squares(lens.radius, beam.divisions)
    origins = np.column_stack([squares, np.full(len(squares), -lens.focal_length)])
    u = -origins / np.linalg.norm(origins, axis=1, keepdims=True)
    rho2 = (squares**2).sum(axis=1)
    powers = area * beam.power / (2 * np.pi * beam.sigma**2) * np.exp(-rho2 / (2 * beam.sigma**2))

    P_PO = origins - np.asarray(position)
    discriminant = (u * P_PO).sum(1) ** 2 - (P_PO**2).sum(1) + r**2
    hit = discriminant > 0
    u, P_PO, powers = u[hit], P_PO[hit], powers[hit]
    d = -(u * P_PO).sum(1) - np.sqrt(discriminant[hit])
    P_PC = P_PO + d[:, None] * u
    cos_a = -(u * P_PC).sum(1) / r
    sin_a = np.linalg.norm(np.cross(u, P_PC), axis=1) / r
    alpha = np.arctan2(sin_a, cos_a)
    sin_b = n_m * sin_a / n_p
    beta = np.arctan2(sin_b, np.sqrt(1 - sin_b**2))
    ca, cb = np.cos(alpha), np.cos(beta)
    R = (
        ((n_m * ca - n_p * cb) / (n_m * ca + n_p * cb)) ** 2
        + ((n_m * cb - n_p * ca) / (n_m * cb + n_p * ca)) ** 2
    ) / 2
    T = 1 - R
    D = 1 + R**2 + 2 * R * np.cos(2 * beta)
    a = T**2 * (np.cos(2 * alpha - 2 * beta) + R * np.cos(2 * alpha)) / D
    b = T**2 * (np.sin(2 * alpha - 2 * beta) + R * np.sin(2 * alpha)) / D
    Q_sc = 1 + R * np.cos(2 * alpha) - a
    Q_gr = R * np.sin(2 * alpha) - b
    n = P_PO - (u * P_PO).sum(1, keepdims=True) * u
    n_hat = n / np.linalg.norm(n, axis=1, keepdims=True)
    forces = (n_m * powers / SPEED_OF_LIGHT)[:, None] * (Q_sc[:, None] * u - Q_gr[:, None] * n_hat)
    return forces.sum(0), np.cross(P_PC, forces).sum(0)
