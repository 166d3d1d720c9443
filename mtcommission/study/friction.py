"""Whether the stated friction breaks what the linear search and its verdict promise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf

import numpy as np

from mtcommission.limits.judge import MoveResult
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.nonlinear import drive_loop, find_friction
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

FOLLOWED = 1.0
"""Time after the setpoint in which an axis must have settled with friction [s] (empirical: what
creeps for longer, an engineer calls standing off)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FrictionEffect:
    """One move with the recommended limits and friction, worst over the corners."""

    number: int  # of the move, from 1
    settling_time: float  # [s]; inf: not settled within ``FOLLOWED`` after the setpoint
    without_friction: float  # [s]
    residual_deviation: float  # [m]
    max_force: float  # set force, friction included [N]
    is_kept: bool  # band, settling time and force


def examine_friction(
    machine: Machine, tuned: TunedLoop, moves: Sequence[MoveResult]
) -> tuple[FrictionEffect, ...]:
    """Return what friction does to each move with the recommended limits; nothing if unstated."""
    if not machine.drive.has_friction:
        return ()
    needs, drive = machine.requirements, machine.drive
    effects = []
    for number, result in enumerate(moves, start=1):
        rows = [_follow(machine, loop, result.setpoint) for loop in tuned.loops]
        settling, residual, force = (max(column) for column in zip(*rows, strict=True))
        kept = residual <= needs.tcp_deviation and settling <= needs.max_settling_time
        effects.append(
            FrictionEffect(
                number=number,
                settling_time=settling,
                without_friction=max(one.settling_time for one in result.responses),
                residual_deviation=residual,
                max_force=force,
                is_kept=kept and force < drive.usable_force,
            )
        )
    return tuple(effects)


def _follow(machine: Machine, loop: SampledLoop, setpoint: Setpoint) -> tuple[float, float, float]:
    """Settling time, residual deviation and largest set force of one move."""
    drive, band = machine.drive, machine.requirements.tcp_deviation
    controller = loop.controller
    tau, step, cycle = (
        controller.reference_delay,
        controller.velocity_cycle,
        controller.position_cycle,
    )
    friction = find_friction(
        loop.plant, coulomb=drive.coulomb_friction, viscous=drive.viscous_friction, step=step
    )
    until = setpoint.duration + tau
    count = ceil((until + FOLLOWED) / cycle)
    references = sample_setpoint(setpoint, cycle * np.arange(count, dtype=np.float64))
    outputs = drive_loop(loop, references, force_limit=drive.usable_force, friction=friction)
    t = step * np.arange(len(outputs), dtype=np.float64)
    deviation = np.abs(outputs[:, 0] - sample_setpoint(setpoint, t - tau)[:, 0])
    after = t >= until - 1e-12
    outside = np.flatnonzero(deviation[after] > band)
    settling = until
    if outside.size:
        settled = outside[-1] + 1 < after.sum()
        settling = float(t[after][outside[-1] + 1]) if settled else inf
    force = float(np.abs(outputs[:, 2]).max())
    return settling, float(deviation[after].max()), force
