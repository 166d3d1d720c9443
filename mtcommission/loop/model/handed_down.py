"""What the position cycle hands down to the velocity cycle, one position cycle later.

Held: the position controller's output, the velocity and the force fed forward. Interpolated: the
wanted motion and the force as polynomials, which the velocity cycle advances. What is handed down
is the only difference between the three position loops, and no list is longer than need be: every
entry is a state of the loop.

The force by the wanted state of a state feedback is interpolated even where the rest is held: a
held wanted position would make the state feedback ripple even while coasting.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.model.controller import Controller, reference_state
from mtcommission.loop.model.interpolation import delay_weights, kept_samples, motion_between
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

MOST_KEPT = 500
"""Setpoints that the loop keeps at most: each is four of its states (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HandedDown:
    """What is handed down, how it is computed, and how the velocity cycle reads it."""

    names: tuple[str, ...]  # n states that hold it
    by_setpoint: Array  # the setpoint now, then the kept samples, newest first, (n, 4 (kept + 1))
    by_encoder: Array  # the encoder's position now, (n,)
    advance: Array  # what is held one velocity cycle later, (n, n)
    correction: Array
    """Output of the position controller, as a row over what is held, (n,); the encoder's share is
    already in what is held, or ``drive_gain`` times its position now."""
    velocity: Array  # fed forward, (n,)
    force: Array  # fed forward, (n,)
    drive_gain: float  # Kv where the position loop closes at the velocity cycle, else 0 [1/s]


def hand_down(controller: Controller, model: Plant) -> HandedDown:
    """Return what the position cycle hands down.

    ``model``: the machine as the controller believes it to be, for its reference state.

    Raises
    ------
    ComputationError
        DELAY_TOO_LONG where the loop would keep more than ``MOST_KEPT`` setpoints.
    """
    kept = kept_samples(controller)
    if kept > MOST_KEPT:
        cycle = controller.position_cycle
        detail = Message("loop-keeps-many", kept=kept, cycle=cycle, most=MOST_KEPT)
        raise ComputationError(Outcome.DELAY_TOO_LONG, detail)
    if controller.position_loop is PositionLoop.CONTROL:
        return _held(controller, model)
    return _interpolated(controller, model)


def _held(controller: Controller, model: Plant) -> HandedDown:
    T_p, T_v = controller.position_cycle, controller.velocity_cycle
    count, Kv = kept_samples(controller), controller.position_gain
    late = delay_weights(controller.reference_age, cycle=T_p, delays=count)
    wanted = controller.state_gains @ reference_state(model, controller)
    # Setpoint and state belong to the middle of the cycle; the first sample comes earlier.
    rate = wanted[:3] @ late[1:]
    force = _fed_forward(controller, count) + wanted @ late - 0.5 * (T_p - T_v) * rate
    names = ["correction", "velocity", "force"]
    rows = [
        Kv * delay_weights(controller.reference_delay, cycle=T_p, delays=count)[0],
        delay_weights(controller.velocity_age, cycle=T_p, delays=count)[1],
        force,
    ]
    if controller.state_gains.any():
        names.append("force_rate")
        rows.append(rate)
    unit, advance = np.eye(len(names)), np.eye(len(names))
    advance[2, 3:] = T_v
    return HandedDown(
        names=tuple(f"held_{name}" for name in names),
        by_setpoint=np.array(rows),
        by_encoder=-Kv * unit[0],
        advance=advance,
        correction=unit[0],
        velocity=controller.velocity_feedforward * unit[1],
        force=unit[2],
        drive_gain=0.0,
    )


def _interpolated(controller: Controller, model: Plant) -> HandedDown:
    T_p, T_v = controller.position_cycle, controller.velocity_cycle
    count, Kv = kept_samples(controller), controller.position_gain
    in_drive = controller.position_loop is PositionLoop.DRIVE
    age, ahead = controller.reference_age, _fed_forward(controller, count)
    start = delay_weights(age + T_p, cycle=T_p, delays=count)
    end = delay_weights(age, cycle=T_p, delays=count)
    motion = motion_between(start, end, cycle=T_p)
    wanted = controller.state_gains @ reference_state(model, controller)
    before = np.roll(ahead, 4) + wanted @ start
    rise = (ahead + wanted @ end - before) / T_p
    if in_drive:
        first = motion[0]
    else:
        first = Kv * delay_weights(controller.reference_delay, cycle=T_p, delays=count)[0]
    unit, advance = np.eye(6), np.eye(6)
    chain = slice(0, 4) if in_drive else slice(1, 4)
    powers = np.array([1.0, T_v, T_v**2 / 2, T_v**3 / 6])
    for i in range(chain.start, chain.stop):
        advance[i, i : chain.stop] = powers[: chain.stop - i]
    advance[4, 5] = T_v
    return HandedDown(
        names=(
            "held_position" if in_drive else "held_correction",
            "held_velocity",
            "held_acceleration",
            "held_jerk",
            "held_force",
            "held_force_rate",
        ),
        by_setpoint=np.vstack([first, motion[1:], before, rise]),
        by_encoder=np.zeros(6) if in_drive else -Kv * unit[0],
        advance=advance,
        correction=Kv * unit[0] if in_drive else unit[0],
        # The mean over the past velocity cycle, as the encoder's difference is.
        velocity=controller.velocity_feedforward
        * np.array([0.0, 1.0, -T_v / 2, T_v**2 / 6, 0.0, 0.0]),
        force=unit[4],
        drive_gain=Kv if in_drive else 0.0,
    )


def _fed_forward(controller: Controller, count: int) -> Array:
    """Force by acceleration and jerk of the setpoint now."""
    m, row = controller.feedforward_mass, np.zeros(4 * (count + 1))
    row[2] = controller.acceleration_feedforward * m
    row[3] = controller.jerk_feedforward * m * controller.force_lag
    return row
