"""What the motion under the arcs of a control really does.

Nothing here knows how the control was found: bounds, force and target are checked on the
motion itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.settings import STANDARD, ProofSettings
from mtcommission.optimal.exponential import balanced_expm
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, joint_system
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


MOST_RADIANS = 2e6
"""Fastest rate times duration of what is followed at all: some fifteen seconds."""
BLOCK = 4096
"""Samples at a time: a long arc has millions, and their states would take gigabytes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedMotion:
    """What a control does."""

    arcs: tuple[Arc, ...]  # The control
    final: Array  # State at the end, shape (n,)
    peaks: Array  # Largest magnitude of each of ``Plant.signals``
    force_peak: float  # Largest |F_set| [N]


def follow_control(
    plant: Plant, arcs: tuple[Arc, ...], *, rate: float, settings: ProofSettings = STANDARD.proof
) -> FollowedMotion:
    """Return what the plant does under the arcs, from rest."""
    state, rows = np.zeros(plant.order), signal_rows(plant)
    peaks, force_peak = np.zeros(len(rows)), 0.0
    for arc in arcs:
        length = arc.t_end - arc.t_start
        count = int(np.ceil(length * rate / settings.radians_per_cell)) + 1
        flow = balanced_expm(joint_system(plant, arc) * (length / count))
        start = np.concatenate([state, arc.initial])
        for first in range(0, count, BLOCK):
            cells = min(BLOCK, count - first)
            joint = _samples(flow, start, cells)
            states, force = joint[:, : plant.order], joint[:, plant.order :] @ arc.output
            slopes = states @ plant.A.T + np.outer(force, plant.B)
            values, rates = states @ rows.T, slopes @ rows.T
            inside = hermite_peaks(
                np.full(cells, length / count),
                values[:-1],
                values[1:],
                start_rate=rates[:-1],
                end_rate=rates[1:],
            )
            peaks, start = np.maximum(peaks, inside), joint[-1]
            force_peak = max(force_peak, float(np.abs(force).max()))
        state = start[: plant.order]
    return FollowedMotion(arcs=arcs, final=state, peaks=peaks, force_peak=force_peak)


def require_followable(time: float, rate: float, *, most: float = MOST_RADIANS) -> None:
    """Raise MOVE_TOO_LONG before a motion is computed that takes too many samples to follow."""
    if time * rate > most:
        detail = Message("optimum-too-long", t_f=time, radians=time * rate, most=most)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)


def _samples(flow: Array, start: Array, count: int) -> Array:
    """Return start, flow start, flow² start, ..., shape (count + 1, n)."""
    samples, power = start[np.newaxis], flow
    while len(samples) <= count:
        samples = np.vstack([samples, samples @ power.T])
        power = power @ power
    return samples[: count + 1]
