"""The motor force over a window: one quadrature for one response and for thousands.

Each sample stands for the velocity cycle about it; the window, which ends between two samples,
cuts the last one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import LiftedLoop

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForceSums:
    """Integrals of the motor force and of its square.

    Parameters
    ----------
    first, square
        Shape (n_setpoints,) [N s, N² s].
    """

    first: Array
    square: Array


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


def sum_free_force(lifted: LiftedLoop, transients: Array, left: Array, *, cycles: int) -> ForceSums:
    """Return the integrals over what is left of the window once the setpoints have ended.

    The free motion of N position cycles is summed in log2(N) products, since the sum over 2 N
    cycles is that over N plus the same from N cycles later.

    Parameters
    ----------
    lifted
        The loop; the last of its outputs per velocity cycle is the motor force.
    transients
        Loop state less that of rest or coasting, shape (n, n_setpoints).
    left
        What is left of the window, shape (n_setpoints,) [s]; none where negative.
    cycles
        Velocity cycles in a position cycle.
    """
    step, Z, power = lifted.dt / cycles, transients.copy(), lifted.A
    force = lifted.C.reshape(cycles, -1, len(Z))[:, -1]
    # Whole position cycles in which every sample counts in full; one more holds the rest.
    whole = np.maximum(np.floor(np.floor(left / step + 0.5) / cycles), 0.0).astype(np.int64)
    first, square = np.zeros((2, Z.shape[1]))
    row, gram = force.sum(axis=0), force.T @ force
    for bit in range(int(whole.max()).bit_length()):
        own = np.flatnonzero(whole >> bit & 1)
        first[own] += step * (row @ Z[:, own])
        square[own] += step * np.einsum("ij,ij->j", Z[:, own], gram @ Z[:, own])
        Z[:, own] = power @ Z[:, own]
        row, gram = row + row @ power, gram + power.T @ gram @ power
        power = power @ power
    times = whole * lifted.dt + step * np.arange(cycles)[:, None]
    share, last = window_shares(times, left, step=step), force @ Z
    first += (share * last).sum(axis=0)
    square += (share * last**2).sum(axis=0)
    return ForceSums(first=first, square=square)
