"""Test whether the residuals of a Kalman filter are white noise."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtrc

from tweezer.tracking.filter import Filtered

#: Number of lags at which the correlation of residuals is tested
_LAGS = 10


def p_value(path: Filtered, *, sized: bool, fitted: int) -> float:
    """Return the p-value of residuals, under the hypothesis that they are white noise.

    The test uses the correlations of the residuals (G. M. Ljung and G. E. P. Box, Biometrika 65,
    297 (1978)). If `sized`, it also uses the sum of their squares, which has a chi-square
    distribution for residuals of variance 1. The degrees of freedom are the number of residuals
    minus the number of `fitted` quantities.
    """
    trusted = np.where(path.weights > 0.5, path.residuals, np.nan)
    statistic, lags = 0.0, 0
    for residuals in trusted.T:
        seen = residuals[np.isfinite(residuals)]
        if not seen.any():  # a coordinate predicted exactly has no correlation
            continue
        for lag in range(1, min(_LAGS, len(seen) // 5) + 1):
            products = residuals[lag:] * residuals[:-lag]
            pairs = int(np.isfinite(products).sum())
            if pairs:
                statistic += float(np.nansum(products)) ** 2 / pairs / float(np.mean(seen**2)) ** 2
                lags += 1
    found = float(chdtrc(lags, statistic)) if lags else 1.0
    if sized:
        seen = trusted[np.isfinite(trusted)]
        above = float(chdtrc(max(seen.size - fitted, 1), (seen**2).sum()))
        found = min(2 * min(found, 2 * min(above, 1 - above)), 1.0)
    return found
