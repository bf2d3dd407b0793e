"""A bead that diffuses freely, seen by a camera: drawn exactly.

Over an exposure W a Brownian path that ends at d has the mean d/2 + a Gaussian of variance
2 D W/12, which is independent of d: the area under a Brownian bridge.
"""

from __future__ import annotations

import numpy as np


def free(time_step, samples, diffusion, seed, *, exposure=0.0, noise=0.0, drift=0.0, count=1):
    """Positions (count, samples), m: means over an exposure that begins at each time.

    noise: standard deviation, m; drift: m/s.
    """
    rng = np.random.default_rng(seed)

    def gaussians(variance):
        return np.sqrt(variance) * rng.standard_normal((count, samples))

    exposed = gaussians(2 * diffusion * exposure)
    dark = gaussians(2 * diffusion * (time_step - exposure))
    after = np.cumsum(exposed + dark, axis=1)
    start = np.concatenate([np.zeros((count, 1)), after[:, :-1]], axis=1)
    seen = start + exposed / 2 + gaussians(2 * diffusion * exposure / 12) + gaussians(noise**2)
    return seen + drift * time_step * np.arange(samples)
