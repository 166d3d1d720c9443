"""Least squares with standard errors that know that residuals of a record are no white noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.measurement import correlation_length

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Regression:
    """What explains a signal by some columns."""

    values: Array  # one for each column
    sigma: Array  # their standard errors
    variance: float  # of the rest, as often larger as samples are correlated
    rest: Array  # of the signal, shape (n,)


def regress(columns: Array, signal: Array, *, correlated: float = 0.0) -> Regression:
    """Return the least-squares solution.

    ``correlated``: how many samples count as one; 0: as what is left shows.
    """
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    A = columns / scale
    found = np.linalg.lstsq(A, signal, rcond=None)[0]
    rest = signal - A @ found
    length = correlated or correlation_length(rest)
    variance = length * float(rest @ rest) / max(rest.size - scale.size, 1)
    spread = np.maximum(np.diag(np.linalg.pinv(A.T @ A)), 0.0)
    sigma = np.sqrt(variance * spread) / scale
    return Regression(values=found / scale, sigma=sigma, variance=variance, rest=rest)
