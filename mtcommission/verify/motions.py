"""One recorded move beside what the loop of the record makes of its setpoint."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, pi

from mtcommission.identify.measurement import FreeMode
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Setpoint
from mtcommission.verify.beside import Beside, find_shift, lay_beside
from mtcommission.verify.planner import number_of, planned
from mtcommission.verify.prediction import Prediction, Rebuilt, predict
from mtcommission.verify.ringing import find_modes
from mtcommission.verify.setpoint import Motion
from mtcommission.verify.trace import Role, Trace


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recorded:
    """One move of a trace, beside what the record says of it."""

    # trace, motion: The record and its move.
    trace: Trace
    motion: Motion
    number: int  # Which of the record's moves it is, from 1; 0 for none
    # What the control should have sent; None where that cannot be planned.
    setpoint: Setpoint | None
    prediction: Prediction  # What the loop makes of the recorded setpoint
    # shift, shift_error: By which the position comes later than predicted, and two standard errors
    # [s].
    shift: float
    shift_error: float
    applied_shift: float  # ``shift``, or 0 where it is more than columns may be recorded apart [s]
    beside: tuple[Beside, ...]  # Recorded signals beside predicted ones
    # Vibration in the dwell that belongs to each mode; None: not seen.
    modes: tuple[FreeMode | None, ...]

    def find(self, role: Role) -> Beside | None:
        """Return one signal; None if it was not recorded."""
        return next((one for one in self.beside if one.role is role), None)


def lay_out(rebuilt: Rebuilt, entered: MotionLimits, trace: Trace, motion: Motion) -> Recorded:
    """Return a recorded move beside its prediction."""
    moves = rebuilt.machine.moves
    number = number_of(motion, moves, entered)
    prediction = predict(rebuilt, motion)
    beside = lay_beside(rebuilt, trace, motion, prediction, shift=0.0)
    shift, error = 0.0, inf
    if first := next((one for one in beside if one.is_position), None):
        shift, error = find_shift(rebuilt, motion, first)
    applied = shift if abs(shift) <= allowed_shift(rebuilt, trace) else 0.0
    if applied:
        beside = lay_beside(rebuilt, trace, motion, prediction, shift=applied)
    rest = motion.end + rebuilt.controller.reference_delay + applied
    modes: tuple[FreeMode | None, ...] = tuple(None for _ in rebuilt.plant.modes)
    for one in beside:
        if one.role is Role.FORCE or motion.is_cut:
            continue
        found = find_modes(rebuilt, one, rest=rest)
        if one.role is Role.ACCELERATION:
            found = tuple(mode and _as_position(mode) for mode in found)
        if not any(modes):
            modes = found
    return Recorded(
        trace=trace,
        motion=motion,
        number=number,
        setpoint=planned(motion, moves[number - 1] if number else None, entered),
        prediction=prediction,
        shift=shift,
        shift_error=2.0 * error,
        applied_shift=applied,
        beside=beside,
        modes=modes,
    )


def _as_position(mode: FreeMode) -> FreeMode:
    """A vibration seen by an accelerometer, its amplitude as a way [m]."""
    return replace(mode, amplitude=mode.amplitude / (2.0 * pi * mode.frequency_hz) ** 2)


def allowed_shift(rebuilt: Rebuilt, trace: Trace) -> float:
    """Return by how much columns may be recorded apart from each other [s]."""
    return rebuilt.controller.position_cycle + trace.setpoint.step
