"""What the machines of a batch do not share, and what they do: their plants, and one setpoint.

The plants are discretised in one go (Taylor series, scaled and squared where a pole is faster than
the velocity cycle).
"""

from __future__ import annotations

from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Variations
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

Array = NDArray[np.float64]

TAYLOR_TERMS, LARGEST_ANGLE = 18, 2.0
"""Of the matrix exponential: up to a pole times the step of 2 its series ends below 2^18/18! <
1e-10; typical axes (below 0.5) reach rounding. Longer steps are halved, and the result squared."""


def discretise_variations(
    machine: Machine, plant: Plant, step: float, *, variations: Variations, part: slice
) -> tuple[Array, Array]:
    """Return the zero-order-hold discretisations (A, B) of varied plants over one step.

    Parameters
    ----------
    machine, plant
        Nominal.
    step
        [s].
    variations
        The machines.
    part
        Which of them.

    Returns
    -------
    (A, B)
        Shapes (n_samples, n, n), (n_samples, n).
    """
    payload = variations.payload[part]
    s, d = variations.frequency_factor[part], variations.damping_factor[part]
    n, radius = plant.order, machine.requirements.payload_radius
    joint = np.zeros((len(payload), n + 1, n + 1))
    joint[:, :n, :n], joint[:, :n, n] = plant.A, plant.B
    joint[:, plant.velocity, plant.force] = 1.0 / (plant.moving_mass + payload)
    for mode in plant.modes:
        loosened = machine.mechanics.inertia_ratio(mode.name, payload, radius)
        joint[:, mode.rate, mode.deflection] *= s**2 * loosened
        joint[:, mode.rate, mode.rate] *= s * d * loosened
        joint[:, mode.rate, plant.force] *= loosened
    squares = [np.abs(joint[:, mode.rate, mode.deflection]).max() for mode in plant.modes]
    fastest = max([np.sqrt(max(squares, default=0.0)), *(-rate for rate in plant.lag_rates)])
    halvings = max(ceil(log2(max(fastest * step / LARGEST_ANGLE, 1.0))), 0)
    joint *= step / 2.0**halvings
    eye = np.eye(n + 1)
    result = np.broadcast_to(eye, joint.shape)
    for k in range(TAYLOR_TERMS, 0, -1):
        result = eye + (joint / k) @ result
    for _ in range(halvings):
        result = result @ result
    return result[:, :n, :n], result[:, :n, n]


def hand_down_setpoint(loop: SampledLoop, setpoint: Setpoint, cycles: int) -> Array:
    """Return what the setpoint alone hands down at each position cycle.

    Parameters
    ----------
    loop
        In one corner.
    setpoint
        What the control sends; before t = 0 it rests.
    cycles
        How many position cycles.

    Returns
    -------
    ndarray
        Shape (cycles, n_held), in the units of ``loop.handed_down``.
    """
    rows = loop.handed_down[:, loop.own_size :]
    kept = (rows.shape[1] - 4) // 4
    T_p = loop.controller.position_cycle
    times = np.arange(-kept, cycles, dtype=np.float64) * T_p
    references = sample_setpoint(setpoint, times)
    now = references[kept:] @ rows[:, -4:].T
    for back in range(1, kept + 1):
        columns = rows[:, 4 * (back - 1) : 4 * back]
        now += references[kept - back : len(references) - back] @ columns.T
    return np.asarray(now)
