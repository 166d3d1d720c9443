"""What Klipper's calibrate_shaper would choose from the same measurement.

Its criterion, computed anew in SI from what its source states: klippy/extras/shaper_calibrate.py at
commit 84104bbb (7 August 2026), with the choice among shapers of 19 October 2025 (c339bb0c). Each
shaper is tried at every 0.2 Hz. Judged are the share of the power that it leaves above a twentieth
of the peak, for the worst of three damping ratios and of all measurements, and the smoothing: how
far it rounds a corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.measurement import AllDirections
from mtcommission.machine.identified import ShaperProposal
from mtcommission.machine.shapers import TOLERANCE, shape

Array = NDArray[np.float64]

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
    found: Array = one.density / shifted * fade
    return found


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Tried:
    """A shaper at every frequency, from the highest downwards; shape (n_frequencies,)."""

    shaper: str
    frequency_hz: Array
    vibration: Array
    smoothing: Array
    max_acceleration: Array

    @property
    def score(self) -> Array:
        """Smoothing times a function of the vibration, as its source states it."""
        v = self.vibration
        found: Array = self.smoothing * (v**1.5 + 0.2 * v + 0.01)
        return found

    def at(self, place: int) -> ShaperProposal:
        return ShaperProposal(
            shaper=self.shaper,
            frequency_hz=float(self.frequency_hz[place]),
            vibration=float(self.vibration[place]),
            smoothing=float(self.smoothing[place]),
            max_acceleration=float(self.max_acceleration[place]),
        )


def propose_shapers(measured: Sequence[AllDirections]) -> tuple[ShaperProposal, ...]:
    """Return each shaper at the frequency that Klipper's calibrate_shaper would give it."""
    if not measured:
        return ()
    proposals: list[ShaperProposal] = []
    best, best_score = 0, np.inf
    for kind, least in LEAST_FREQUENCIES_HZ.items():
        tried = _try(kind, least, measured)
        place = _best_frequency(tried)
        found, score = tried.at(place), float(tried.score[place])
        number = len(proposals)
        if number == 0 or _is_better(found, score, proposals[best], best_score):
            best, best_score, leader = number, score, found
        else:
            leader = proposals[best]
        # Any frequency of this shaper that leaves less and smooths less than the leader.
        for i in range(tried.frequency_hz.size - 1, -1, -1):
            if tried.vibration[i] < leader.vibration and tried.smoothing[i] < leader.smoothing:
                found = leader = tried.at(i)
                best, best_score = number, float(tried.score[i])
        proposals.append(found)
    if proposals[best].shaper == "zv":
        less = [n for n, one in enumerate(proposals) if _leaves_less(one, proposals[best])]
        best = less[0] if less else best
    proposals[best] = replace(proposals[best], is_recommended=True)
    return tuple(proposals)


def _is_better(
    found: ShaperProposal, score: float, leader: ShaperProposal, leader_score: float
) -> bool:
    """A fifth better by score, or a twentieth with a tenth less smoothing."""
    much = 1.2 * score < leader_score
    return much or (1.05 * score < leader_score and 1.1 * found.smoothing < leader.smoothing)


def _leaves_less(one: ShaperProposal, zv: ShaperProposal) -> bool:
    return one.shaper != "zv" and 1.1 * one.vibration < zv.vibration


def _best_frequency(tried: _Tried) -> int:
    """The best score among the frequencies that leave nearly as little as the best one."""
    v, score = tried.vibration, tried.score
    chosen = int(np.argmin(v))
    good = np.flatnonzero(v < 1.1 * v[chosen] + 0.0005)
    for i in good[::-1].tolist():
        if score[i] < score[chosen]:
            chosen = i
    return chosen


def _try(kind: str, least: float, measured: Sequence[AllDirections]) -> _Tried:
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

    def smoothing(a: float) -> Array:
        corner = sqrt(2.0) * (CORNER_VELOCITY * step + 0.5 * a * bend)
        found: Array = np.maximum(corner, 0.5 * a * whole_bend)
        return found

    corner = 2.0 * (TARGET_SMOOTHING / sqrt(2.0) - CORNER_VELOCITY * step) / bend
    turn = 2.0 * TARGET_SMOOTHING / whole_bend
    return _Tried(
        shaper=kind,
        frequency_hz=frequencies,
        vibration=vibration,
        smoothing=smoothing(USUAL_ACCELERATION),
        max_acceleration=np.maximum(np.minimum(corner, turn), 0.0),
    )


def _left(delays: Array, shares: Array, ratios: Array, zeta: float) -> Array:
    """Vibration at the last impulse by that of a single one, for ratios of frequency."""
    pole = 2.0 * np.pi * complex(-zeta, sqrt(1.0 - zeta**2))
    total = np.zeros(ratios.shape, dtype=np.complex128)
    for delay, share in zip(delays, shares, strict=True):
        total += share * np.exp(pole * ratios * (delays[-1] - delay))
    return np.abs(total)
