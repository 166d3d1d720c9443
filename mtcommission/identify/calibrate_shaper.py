"""What Klipper's calibrate_shaper would choose from the same measurement.

Its criterion, computed anew in SI from what its source states: klippy/extras/shaper_calibrate.py at
commit 84104bbb (7 August 2026), with the choice among shapers of 19 October 2025 (c339bb0c). Each
shaper is tried at every 0.2 Hz. Judged are the share of the power that it leaves above a twentieth
of the peak, for the worst of three damping ratios and of all measurements, and the smoothing: how
far it rounds a corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from mtcommission.machine.identified import ShaperProposal
from mtcommission.machine.setpoint_filter import TOLERANCE, shape
from mtcommission.measured.measurement import AllDirections, Array

LEAST_FREQUENCIES_HZ = {"zv": 21.0, "mzv": 23.0, "ei": 29.0, "2hump_ei": 39.0, "3hump_ei": 48.0}
"""Shapers that it tries, in its order, and from which frequency."""
MOST_FREQUENCY_HZ = 150.0
STEP_HZ = 0.2
HIGHEST_LINE_HZ = 200.0
DESIGN_DAMPING = 0.1
"""Damping ratio of its shapers; what the control assumes unless told otherwise."""
TESTED_DAMPING = (0.075, 0.1, 0.15)
"""Damping ratios of the vibrations."""
USUAL_ACCELERATION = 5.0
"""At which the smoothing is stated [m/s^2]."""
CORNER_VELOCITY = 5e-3
"""square_corner_velocity [m/s]: Klipper's default."""
TARGET_SMOOTHING = 0.12e-3
"""Largest smoothing; max_accel follows from it [m]."""
LOWEST_LINE_HZ = 5.0


def _by_frequency(one: AllDirections) -> Array:
    """Its density divided by frequency, without what is below twice 5 Hz."""
    if one.is_divided:
        return one.density
    shifted = one.frequency_hz + 0.1
    low = one.frequency_hz < 2.0 * LOWEST_LINE_HZ
    fade = np.where(low, np.exp(1.0 - (2.0 * LOWEST_LINE_HZ / shifted) ** 2), 1.0)
    return np.asarray(one.density / shifted * fade)


def _score(one: ShaperProposal) -> float:
    """Smoothing times a function of the vibration, as its source states it."""
    return float(one.smoothing * (one.vibration**1.5 + 0.2 * one.vibration + 0.01))


def propose_shapers(measured: Sequence[AllDirections]) -> tuple[ShaperProposal, ...]:
    """Return each shaper at the frequency that Klipper's calibrate_shaper would give it."""
    if not measured:
        return ()
    proposals: list[ShaperProposal] = []
    leader: ShaperProposal | None = None
    for kind, least in LEAST_FREQUENCIES_HZ.items():
        tried = _try(kind, least, measured)
        found = _best(tried)
        if leader is None or _is_better(found, leader):
            leader = found
        # Any frequency of this shaper that leaves less and smooths less than the leader.
        for one in reversed(tried):
            if one.vibration < leader.vibration and one.smoothing < leader.smoothing:
                found = leader = one
        proposals.append(found)
    best = leader or proposals[0]
    if best.shaper == "zv":
        less = (one for one in proposals[1:] if 1.1 * one.vibration < best.vibration)
        best = next(less, best)
    return tuple(replace(one, is_recommended=one is best) for one in proposals)


def _is_better(found: ShaperProposal, leader: ShaperProposal) -> bool:
    """A fifth better by score, or a twentieth with a tenth less smoothing."""
    much = 1.2 * _score(found) < _score(leader)
    less = 1.1 * found.smoothing < leader.smoothing
    return much or (1.05 * _score(found) < _score(leader) and less)


def _best(tried: Sequence[ShaperProposal]) -> ShaperProposal:
    """The best score among the frequencies that leave nearly as little as the best one."""
    chosen = min(tried, key=lambda one: one.vibration)
    most = 1.1 * chosen.vibration + 0.0005
    return min((one for one in reversed(tried) if one.vibration < most), key=_score)


def _try(kind: str, least: float, measured: Sequence[AllDirections]) -> list[ShaperProposal]:
    """A shaper at every frequency, from the highest downwards."""
    frequencies = np.arange(least, MOST_FREQUENCY_HZ, STEP_HZ)[::-1]
    unit = shape(kind, frequency_hz=1.0, damping_ratio=DESIGN_DAMPING)
    delays, shares = np.array(unit.delays), np.array(unit.shares)
    vibration = np.zeros(frequencies.size)
    for one in measured:
        kept = one.frequency_hz <= HIGHEST_LINE_HZ
        lines, power = one.frequency_hz[kept], _by_frequency(one)[kept]
        threshold = TOLERANCE * float(power.max())
        whole = float(np.maximum(power - threshold, 0.0).sum())
        for zeta in TESTED_DAMPING:
            left = _left(delays, shares, lines[None, :] / frequencies[:, None], zeta)
            share = np.maximum(left * power - threshold, 0.0).sum(axis=1) / whole
            vibration = np.maximum(vibration, share)
    # Kernel about its centre: sums over T - T_mean and over its later half.
    T = delays - float(delays @ shares)
    late = np.maximum(T, 0.0)
    step, bend = float(shares @ late) / frequencies, float(shares @ late**2) / frequencies**2
    whole_bend = float(shares @ T**2) / frequencies**2
    corner = sqrt(2.0) * (CORNER_VELOCITY * step + 0.5 * USUAL_ACCELERATION * bend)
    smoothing = np.maximum(corner, 0.5 * USUAL_ACCELERATION * whole_bend)
    by_corner = 2.0 * (TARGET_SMOOTHING / sqrt(2.0) - CORNER_VELOCITY * step) / bend
    most = np.maximum(np.minimum(by_corner, 2.0 * TARGET_SMOOTHING / whole_bend), 0.0)
    rows = np.array([frequencies, vibration, smoothing, most]).T.tolist()
    return [
        ShaperProposal(
            shaper=kind, frequency_hz=f, vibration=left, smoothing=rounded, max_acceleration=a
        )
        for f, left, rounded, a in rows
    ]


def _left(delays: Array, shares: Array, ratios: Array, zeta: float) -> Array:
    """Vibration at the last impulse by that of a single one, for ratios of frequency."""
    pole = 2.0 * np.pi * complex(-zeta, sqrt(1.0 - zeta**2))
    total = np.zeros(ratios.shape, dtype=np.complex128)
    for delay, share in zip(delays, shares, strict=True):
        total += share * np.exp(pole * ratios * (delays[-1] - delay))
    return np.abs(total)
