"""The motor force over a window: one quadrature for one response and for thousands.

Each sample stands for the velocity cycle about it; the window, which ends between two samples,
cuts the last one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def window_shares(times: Array, window: Array | float, *, step: float) -> Array:
    """Return how much of a window from t = 0 each sample stands for [s].

    Parameters
    ----------
    times
        Of the samples [s].
    window
        Its end [s], to be broadcast against ``times``.
    step
        Velocity cycle [s].

    Examples
    --------
    >>> window_shares(np.array([0.0, 1.0, 2.0, 3.0]), 1.7, step=1.0)
    array([1. , 1. , 0.2, 0. ])
    """
    return np.asarray(step * np.clip((window - times) / step + 0.5, 0.0, 1.0))


def rms_force(first: Array, square: Array, *, window: Array | float, static_load: float) -> Array:
    """Return the RMS force over a window, the static load in its worse direction [N].

    Parameters
    ----------
    first, square
        Integrals of the force and of its square over the window [N s, N² s].
    window
        Its length [s].
    static_load
        [N]; the motion may go either way against it.

    Examples
    --------
    >>> round(float(rms_force(np.array(2.0), np.array(8.0), window=2.0, static_load=-1.0)), 6)
    2.645751
    """
    load = abs(static_load)
    return np.asarray(np.sqrt(square / window + load**2 + 2.0 * load * np.abs(first / window)))
