"""The setpoint filter as the cure for moves of any size: a moving average of one period.

Behind a moving average of the length 1/f every setpoint leaves the mode f at rest, small steps
included; what it leaves of other modes and of the servo decides the acceleration.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.batch.response import simulate_limits_batched
from mtcommission.loop.batch.settling import settle
from mtcommission.loop.batch.tables import build_tables, sketch_tables
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move, moving_mass
from mtcommission.machine.variations import as_variations
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import NO_JERK_LIMIT, MotionLimits
from mtcommission.setpoint.setpoint import JerkSteps, jerk_steps, moving_average_steps
from mtcommission.study.evaluate import judge
from mtcommission.study.move_sizes import SMALLEST, SetpointWay, resize

Array = NDArray[np.float64]

ACCELERATIONS = 16
"""Tried for each period, from a tenth of F_max/m upwards, logarithmic: what takes ten times as
long is no cure (design choice)."""

LEAST_ACCELERATION = 0.1
"""The least of them, as a share of F_max/m [-]."""

SIZES = 24
"""Of each move, from ``SMALLEST`` up to the profile's own, logarithmic."""


def find_size_filter(machine: Machine, plant: Plant, tuned: TunedLoop) -> SetpointWay | None:
    """Return the moving average and acceleration that serve all smaller moves, too.

    Of the periods of all modes and of the accelerations tried, the pair that lets the
    profile's moves settle soonest while the band is kept on every smaller move.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop in every corner.

    Returns
    -------
    SetpointWay or None
        Without a jerk limit; None if no pair meets all requirements.
    """
    largest = machine.drive.motion_force / moving_mass(machine)
    accelerations = largest * np.geomspace(1.0, LEAST_ACCELERATION, ACCELERATIONS)
    shares = np.geomspace(1.0, SMALLEST, SIZES)
    places = as_variations(tuned.corners)
    candidates = []
    for mode in plant.modes:
        period = 1.0 / mode.frequency_hz
        settling, is_kept = _look(machine, tuned, accelerations, shares, period)
        candidates += [
            (float(settling[i]), period, float(accelerations[i])) for i in np.flatnonzero(is_kept)
        ]
    for _, period, a in sorted(candidates):
        limits = MotionLimits(acceleration=a, jerk=a / NO_JERK_LIMIT)
        filtered = replace(machine, control=replace(machine.control, moving_average_time=period))
        found = simulate_limits_batched(filtered, plant, tuned, limits, variations=places)
        # What saturates takes long to simulate: only what seems good is judged in full.
        if not np.all(found.meets(filtered)):
            continue
        if judge(filtered, plant, tuned, "", "", limits).assessment.is_met:
            return SetpointWay(name="moving average", limits=limits, moving_average=period)
    return None


def _look(
    machine: Machine, tuned: TunedLoop, accelerations: Array, shares: Array, period: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Settling time at the profile's own size, and whether the band is kept at every size."""
    band = machine.requirements.tcp_deviation
    settling = np.zeros(len(accelerations))
    is_kept = np.ones(len(accelerations), dtype=np.bool_)
    moves = [_all_sizes(move, accelerations, shares, period) for move in machine.moves]
    longest = max(float(steps.duration.max()) for steps in moves)
    for loop in tuned.loops:
        tables = build_tables(loop, longest=longest, filtered=True)
        rough = sketch_tables(tables, loop.plant)
        for steps in moves:
            found = settle(rough, steps, band=band)
            shape = (len(shares), len(accelerations))
            settling = np.maximum(settling, found.settling_time.reshape(shape)[0])
            is_kept &= np.all(found.residual_deviation.reshape(shape) <= band, axis=0)
    return settling, is_kept


def _all_sizes(move: Move, accelerations: Array, shares: Array, period: float) -> JerkSteps:
    """Filtered setpoints, the accelerations of the first size first."""
    each = [
        jerk_steps(
            resize(move, float(share)),
            acceleration=accelerations,
            jerk=accelerations / NO_JERK_LIMIT,
        )
        for share in shares
    ]
    steps = JerkSteps(
        times=np.vstack([item.times for item in each]),
        steps=np.vstack([item.steps for item in each]),
    )
    return moving_average_steps(steps, time=period)
