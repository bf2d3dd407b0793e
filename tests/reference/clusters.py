"""Random clusters of spheres near contact, and whether their mobility is positive.

`python -m tests.reference.clusters` tries 1,000 and prints the smallest eigenvalue.
"""

from __future__ import annotations

import numpy as np

from tweezer.fluid.many import many_mobility


def cluster(rng, radii, gaps=(1e-3, 0.3)):
    """Centres and radii of spheres, each with a random gap to another one and no smaller gap."""
    centres, radii = [np.zeros(3)], np.asarray(radii, float)
    while len(centres) < len(radii):
        own, to = radii[len(centres)], rng.integers(len(centres))
        line = rng.standard_normal(3)
        gap = np.exp(rng.uniform(*np.log(gaps)))
        place = centres[to] + line / np.linalg.norm(line) * (radii[to] + own + gap)
        away = np.linalg.norm(np.array(centres) - place, axis=1) - radii[: len(centres)] - own
        if away.min() >= gaps[0]:
            centres.append(place)
    return np.array(centres), radii


def smallest_eigenvalue(rng):
    """Smallest eigenvalue of the resistance of a random cluster, over that of separate spheres."""
    radii = rng.choice([1.0, 0.5, 0.25], rng.integers(3, 9))
    centres, radii = cluster(rng, radii)
    matrix = many_mobility(centres, radii, 1 / (6 * np.pi)).matrix
    sizes = np.sqrt(np.concatenate([np.repeat(radii, 3), np.repeat(radii**3 / 0.75, 3)]))
    spread = np.linalg.eigvalsh(sizes[:, None] * sizes * matrix)
    assert spread[0] > 0
    return 1 / spread[-1]


def main():
    """Try 1,000 clusters of 3 to 8 spheres."""
    rng = np.random.default_rng(42)
    found = [smallest_eigenvalue(rng) for _ in range(1000)]
    print(f"smallest eigenvalue of {len(found)} clusters: {min(found):.3f}")


if __name__ == "__main__":
    main()
