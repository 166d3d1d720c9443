"""The loops of thousands of machines at once, which differ in their plants alone.

The plants are discretised in one go (Taylor series, converged to rounding at the velocity
cycle) and lifted to the position cycle; the controller's rows are the same for all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.sampled import SampledLoop
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Variations
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

Array = NDArray[np.float64]

TAYLOR_TERMS = 18
"""Of the matrix exponential: poles times velocity cycle stay below 2, and 2^18/18! < 1e-10;
typical axes (below 0.5) reach rounding."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedLoops:
    """Loops of many samples at the position cycle, without the kept setpoint samples.

    Parameters
    ----------
    rows
        Shape (n_samples, n + (n_signals + 1) cycles, n). The first n rows are A in X⁺ = A X plus
        what the setpoint hands down; then each signal at each velocity cycle, as rows over X;
        then the tool position. One product is faster than three.
    """

    rows: Array


def build_loops(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    *,
    variations: Variations,
    part: slice,
    signals: Array,
) -> VariedLoops:
    """Return the loops of some samples.

    Parameters
    ----------
    machine, plant, tuned
        The nominal machine, its plant and its loop; the controller is the same on all samples.
    variations
        The machines.
    part
        Which of them.
    signals
        Rows over the loop's state (``own_size`` columns), shape (n_signals, n).

    Returns
    -------
    VariedLoops
    """
    loop = tuned.loops[0]
    n, z, size = plant.order, loop.integrator, own_size(loop)
    A, B = _discretise_all(machine, plant, tuned, variations, part)
    cycle = np.repeat(loop.step[None, :size, :size], len(A), axis=0)
    cycle[:, :n, :n], cycle[:, :n, z + 1] = A, B
    cycle[:, z] += loop.integration[:size]
    cycle[:, z + 1] = loop.demand[:size]
    seen = np.vstack([signals, loop.observation[:1, :size]])
    rows = np.repeat(seen[None], len(A), axis=0)
    pieces = []
    for _ in range(loop.controller.cycles):
        pieces.append(rows)
        rows = rows @ cycle
    lifted = np.linalg.matrix_power(cycle, loop.controller.cycles)
    lifted[:, loop.held :] = loop.handed_down[:, :size]
    seen_rows = np.stack(pieces, axis=2).reshape(len(A), -1, size)
    return VariedLoops(rows=np.concatenate([lifted, seen_rows], axis=1))


def _discretise_all(
    machine: Machine, plant: Plant, tuned: TunedLoop, variations: Variations, part: slice
) -> tuple[Array, Array]:
    """Zero-order-hold plants of the samples over a velocity cycle, (n_samples, n, n), (…, n)."""
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
    joint *= tuned.controller.velocity_cycle
    eye = np.eye(n + 1)
    result = np.broadcast_to(eye, joint.shape)
    for k in range(TAYLOR_TERMS, 0, -1):
        result = eye + (joint / k) @ result
    return result[:, :n, :n], result[:, :n, n]


def own_size(loop: SampledLoop) -> int:
    """Return the number of loop states without the kept setpoint samples, which end it."""
    return loop.held + len(loop.handed_down)


def hand_down(loop: SampledLoop, setpoint: Setpoint, cycles: int) -> Array:
    """Return what the setpoint alone hands down at each position cycle, shape (cycles, 3).

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
        Shape (cycles, 3), in the units of ``loop.handed_down``.
    """
    rows = loop.handed_down[:, own_size(loop) :]
    kept = (rows.shape[1] - 4) // 4
    T_p = loop.controller.position_cycle
    times = np.arange(-kept, cycles, dtype=np.float64) * T_p
    references = sample_setpoint(setpoint, times)
    now = references[kept:] @ rows[:, -4:].T
    for back in range(1, kept + 1):
        columns = rows[:, 4 * (back - 1) : 4 * back]
        now += references[kept - back : len(references) - back] @ columns.T
    return np.asarray(now)
