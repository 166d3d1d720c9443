"""Whether the control sent what was entered: the recorded setpoint against the planned one."""

from __future__ import annotations

from math import inf

import numpy as np

from mtcommission.base.errors import MtcommissionError
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits
from mtcommission.identify.measurement import Array
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Setpoint, plan_setpoint, sample_setpoint
from mtcommission.verify.checks import Check, Verdict
from mtcommission.verify.setpoint import Motion, Reached

SAME_SIZE = 0.02
"""Relative difference of travel and velocity up to which a move is the record's."""

ABOVE, BELOW = 1.05, 0.9
"""Shares of what was planned between which the setpoint obeys (values are rounded at entry)."""

CRUISE, CRUISE_SHARE = 0.998, 0.15
"""A velocity this near to the largest one, for this share of a move, is one that was set."""

TELLING = 0.1
"""Uncertainty, as share of what was planned, above which nothing is said for the planner."""

PHASES = 16
"""Places of the samples within a step at which the plan is looked at."""


def number_of(motion: Motion, moves: tuple[Move, ...], entered: MotionLimits) -> int:
    """Return which of the record's moves was recorded, from 1; 0 for none of them."""
    for number, move in enumerate(moves, start=1):
        if isinstance(move, VelocityStep):
            if motion.coasts and _alike(abs(motion.final_velocity), move.velocity_step):
                return number
        elif not motion.coasts and _alike(abs(motion.travel), move.distance):
            top = _peaks(plan_setpoint(move, entered), 1, motion.velocity).max()
            slower = motion.velocity.value < (1.0 - SAME_SIZE) * top - motion.velocity.uncertainty
            faster = motion.velocity.value > (1.0 + SAME_SIZE) * move.max_velocity
            # With a lower feed it is another move; one that is slower all along is this one.
            if not faster and not (slower and _cruises(motion)):
                return number
    return 0


def _cruises(motion: Motion) -> bool:
    """Whether a move stays at its largest velocity."""
    speed = np.abs(motion.sample(np.linspace(motion.begin, motion.end, 400))[:, 1])
    return float(np.mean(speed > CRUISE * speed.max())) > CRUISE_SHARE


def _alike(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_SIZE * other


def planned(motion: Motion, move: Move | None, entered: MotionLimits) -> Setpoint | None:
    """Return what the control should have sent; None where that cannot be planned."""
    if move is None and motion.coasts:
        move = VelocityStep(velocity_step=abs(motion.final_velocity))
    elif move is None:
        velocity = motion.velocity.value + motion.velocity.uncertainty
        move = Positioning(distance=abs(motion.travel), max_velocity=velocity)
    try:
        return plan_setpoint(move, entered)
    except MtcommissionError:
        return None


def _peaks(setpoint: Setpoint, order: int, reached: Reached) -> Array:
    """Largest difference quotient of a plan over the width of the recorded one, at each phase."""
    width = reached.width / order
    times = np.arange(-order, setpoint.duration / width + order + 1, dtype=np.float64) * width
    phases = width * np.arange(PHASES, dtype=np.float64)[:, None] / PHASES
    x: Array = sample_setpoint(setpoint, (times + phases).ravel())[:, 0].reshape(PHASES, -1)
    return np.asarray(np.abs(np.diff(x, n=order, axis=1)).max(axis=1) / width**order)


def check_planner(
    motion: Motion, setpoint: Setpoint | None, entered: MotionLimits, units: AxisUnits
) -> list[Check]:
    """Return velocity, acceleration and jerk of a recorded move against what was entered."""
    top = inf
    if setpoint is not None:
        move = setpoint.move
        top = move.max_velocity if isinstance(move, Positioning) else move.velocity_step
    rows = (
        ("velocity", motion.velocity, top, units.velocity.si),
        ("acceleration", motion.acceleration, entered.acceleration, units.acceleration.si),
        ("jerk", motion.jerk, entered.jerk, units.jerk.si),
    )
    return [
        _check(key, reached, limit, unit, _peaks(setpoint, order, reached) if setpoint else None)
        for order, (key, reached, limit, unit) in enumerate(rows, start=1)
    ]


def _check(key: str, reached: Reached, limit: float, unit: str, plan: Array | None) -> Check:
    """What was measured against the plan's means over the same width; without one, the limit."""
    value, error = reached.value, reached.uncertainty
    predicted = low = high = None
    verdict, kind = Verdict.UNKNOWN, "coarse" if plan is not None else "no-plan"
    above, below = ABOVE * limit, -inf
    if plan is not None:
        # The samples of the record lie at one phase, which nobody knows.
        predicted = float(plan.max())
        low, high = below, above = BELOW * float(plan.min()), ABOVE * predicted
    if value - error > above or value + error < below:
        verdict, kind = Verdict.FAILS, "above" if value > above else "below"
    elif predicted is not None and error <= TELLING * predicted:
        verdict, kind = Verdict.HOLDS, "obeyed"
    return Check(
        key=f"setpoint {key}",
        unit=unit,
        predicted=predicted,
        low=low,
        high=high,
        limit=limit if plan is None and limit < inf else None,
        measured=value,
        uncertainty=error,
        verdict=verdict,
        reason=Message(f"verify-setpoint-{kind}", width=reached.width, entered=limit, unit=unit),
        decides=key != "jerk",
    )
