"""A setpoint through the loop without sampling, as a cross-check of the sampled one.

Their difference is shown by a test and on the sheet; nothing is judged by this approximation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matrix_balance

from mtcommission.loop.model.controller import Controller
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

Array = NDArray[np.float64]

STEP = 0.1e-3
"""Spacing of the samples of a continuous response [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContinuousResponse:
    """Tool deviation of the continuous loop.

    Parameters
    ----------
    t, deviation
        Shape (n_samples,) [s, m].
    settling_time, residual_deviation
        As for the sampled loop, over the time covered [s, m].
    """

    t: Array
    deviation: Array
    settling_time: float
    residual_deviation: float


def simulate_continuous(
    plant: Plant,
    controller: Controller,
    setpoint: Setpoint,
    *,
    model: Plant,
    band: float,
    until: float,
) -> ContinuousResponse:
    """Return the tool deviation of the continuous loop for a setpoint.

    Parameters
    ----------
    plant, controller, model
        The loop.
    setpoint
        From t = 0.
    band
        [m].
    until
        End of the simulation [s].
    """
    import control  # takes a second, and only this cross-check needs it

    from mtcommission.loop.model.continuous import build_continuous

    system = build_continuous(plant, controller, model=model)
    A, B, C = _balance(system.A, system.B, system.C)
    system = control.ss(A, B, C, system.D)
    t = np.arange(int(np.ceil(until / STEP)) + 1, dtype=np.float64) * STEP
    tau = controller.reference_delay
    inputs = sample_setpoint(setpoint, t - tau if controller.follows else t)
    response = control.forced_response(system, t, inputs.T, squeeze=False)
    deviation = np.asarray(response.outputs)[0] - sample_setpoint(setpoint, t - tau)[:, 0]
    end = setpoint.duration + tau
    size = np.abs(deviation)
    outside = np.flatnonzero(size > band)
    last = float(t[outside[-1]]) if outside.size else 0.0
    return ContinuousResponse(
        t=t,
        deviation=deviation,
        settling_time=max(end, last),
        residual_deviation=float(np.max(size[t >= end - 0.5 * STEP])),
    )


def _balance(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """Return the same system in states of one size.

    Padé delays beside stiff modes give entries twenty decades apart, and the matrix exponential
    then loses all digits: a stable loop was seen to grow. Powers of two scale without rounding.
    """
    balanced, (scale, _) = matrix_balance(A, permute=False, separate=True)
    return np.asarray(balanced), B / scale[:, None], C * scale
