"""What the motion under the arcs of a control really does.

Nothing here knows how the control was found: bounds, force and target are checked on the
motion itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.settings import STANDARD, ProofSettings
from mtcommission.optimal.exponential import balanced_expm
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, joint_system
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedMotion:
    """What a control does.

    Parameters
    ----------
    arcs
        The control.
    final
        State at the end, shape (n,).
    peaks
        Largest magnitude of each of ``Plant.signals``.
    force_peak
        Largest |F_set| [N].
    """

    arcs: tuple[Arc, ...]
    final: Array
    peaks: Array
    force_peak: float


def follow_control(
    plant: Plant, arcs: tuple[Arc, ...], *, rate: float, settings: ProofSettings = STANDARD.proof
) -> FollowedMotion:
    """Return what the plant does under the arcs, from rest.

    Parameters
    ----------
    plant
        Plant with n states.
    arcs
        In order, without gaps, from t = 0.
    rate
        Fastest angular frequency [rad/s].
    settings
        Knows how closely peaks are looked for.

    Returns
    -------
    FollowedMotion
    """
    state, rows = np.zeros(plant.order), signal_rows(plant)
    peaks, force_peak = np.zeros(len(rows)), 0.0
    for arc in arcs:
        length = arc.t_end - arc.t_start
        count = int(np.ceil(length * rate / settings.radians_per_cell)) + 1
        flow = balanced_expm(joint_system(plant, arc) * (length / count))
        samples = [np.concatenate([state, arc.initial])]
        for _ in range(count):
            samples.append(flow @ samples[-1])
        joint = np.array(samples)
        states, force = joint[:, : plant.order], joint[:, plant.order :] @ arc.output
        values, rates = states @ rows.T, (states @ plant.A.T + np.outer(force, plant.B)) @ rows.T
        inside = hermite_peaks(
            np.full(count, length / count),
            values[:-1],
            values[1:],
            start_rate=rates[:-1],
            end_rate=rates[1:],
        )
        peaks, state = np.maximum(peaks, inside), states[-1]
        force_peak = max(force_peak, float(np.abs(force).max()))
    return FollowedMotion(arcs=arcs, final=state, peaks=peaks, force_peak=force_peak)
