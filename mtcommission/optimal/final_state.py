"""The state in which a bang-bang force ends, from the state space alone, without its modes."""

from __future__ import annotations

from math import ceil, log2

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from mtcommission.optimal.dual import sign_jumps
from mtcommission.plant import Plant

Array = NDArray[np.float64]

SHORT = 0.25
"""Step of the power series against the fastest pole."""
TERMS = 12
"""0.25^12 / 12! = 1e-16."""


def final_state(
    plant: Plant, switching_times: Array, *, t_f: float, first_force: float, rate: float
) -> Array:
    """Return the state at t_f under a force that changes sign at the given times.

    Parameters
    ----------
    plant
        The plant with n states, at rest at t = 0.
    switching_times
        Ascending, shape (n_switches,) [s].
    t_f
        End [s].
    first_force
        F_set on the first arc [N].
    rate
        Magnitude of the fastest pole [1/s].

    Returns
    -------
    ndarray, shape (n,)

    Source: superposition of step responses Γ(τ) = ∫_0^τ e^{As} B ds, (Γ, 1)' = [A B; 0 0] (Γ, 1);
    each from a power series over the last bit of τ and the squares of one matrix exponential.

    Examples
    --------
    >>> from mtcommission.plant import build_plant
    >>> from tests.machines import paper_machine
    >>> plant = build_plant(paper_machine())
    >>> x = final_state(plant, np.array([1.0]), t_f=2.0, first_force=750.0, rate=500.0)
    >>> [round(float(x[i]), 6) for i in (plant.position, plant.velocity)]
    [0.999994, 0.0025]
    """
    n, ends = plant.order, np.append(t_f - switching_times[::-1], t_f)
    joint = np.zeros((n + 1, n + 1))
    joint[:n, :n], joint[:n, n] = plant.A, plant.B
    bits = max(0, ceil(log2(rate * t_f / SHORT)))
    unit = t_f / 2.0**bits
    whole = np.floor(ends / unit).astype(np.int64)
    response = np.zeros((ends.size, n + 1))
    response[:, n] = 1.0
    term, rest = response, (ends - whole * unit)[:, np.newaxis]
    for power in range(1, TERMS + 1):
        term = (term @ joint.T) * (rest / power)
        response = response + term
    transition = np.asarray(expm(joint * unit)).T
    for bit in range(bits + 1):
        chosen = np.flatnonzero(whole >> bit & 1)
        response[chosen] = response[chosen] @ transition
        transition = transition @ transition
    last_sign = (-1.0) ** switching_times.size
    jumps = sign_jumps(switching_times.size, first_sign=last_sign)
    return np.asarray(first_force * (jumps @ response[:, :n]))
