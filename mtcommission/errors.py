"""Everything that can go wrong, as one tree.

MtcommissionError
├── InputError           exit code 2: what the user gave cannot be used; all faults at once
└── ComputationError     exit code 3: a named outcome of a computation, with its remedy

A failed assessment is neither: it is a result (exit code 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One thing wrong with the input.

    Parameters
    ----------
    where
        File name, or the option of the command line; "" if neither applies.
    line
        Line in that file, counted from 1; 0 where there is no line.
    key
        The key, e.g. ``plant.base_mass`` or ``moves[1].distance``; "" for the whole file.
    message
        What was got (with its unit), what is allowed, what to do.
    """

    where: str
    line: int = 0
    key: str = ""
    message: str

    def __str__(self) -> str:
        place = f"{self.where}:{self.line}" if self.line else self.where
        return ": ".join(part for part in (place, self.key, self.message) if part)


class MtcommissionError(Exception):
    """Base of all errors that the program raises on purpose."""

    exit_code = 3


class InputError(MtcommissionError):
    """What the user gave cannot be used; carries every fault found.

    Parameters
    ----------
    faults
        At least one fault.
    """

    exit_code = 2

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class Outcome(Enum):
    """How a computation can end without a result; the value tells the remedy."""

    EQUAL_POLES = (
        "two modes have the same poles, so one force cannot bring both to rest independently; "
        "merge them into one mode (add their tcp_gain and measured_gain)"
    )
    NOT_CONTROLLABLE = (
        "the drive force does not reach every state; remove the mode that it cannot excite"
    )
    FINAL_TIME_TOO_SHORT = "no admissible force reaches the target so soon; give a longer t_f"
    BOUND_CANNOT_HOLD = "no move, however slow, keeps this bound; widen it"
    BEYOND_HORIZON = (
        "the bound can only be met by a move slower than the search horizon; widen the bound"
    )
    MODES_NOT_TOLD_APART = (
        "so strong a force makes the move so short that all modes answer alike, closer than double "
        "precision can tell; check the unit of max_force and the masses, or lower max_force"
    )
    NO_CONVERGENCE = (
        "the iteration stopped before the required accuracy was reached; "
        "report the profile, and use --method transcription meanwhile"
    )
    UNSTABLE_LOOP = (
        "the closed loop is unstable; lower velocity_gain, then position_gain, "
        "or leave them out to have them tuned"
    )
    NOT_OBSERVABLE = (
        "the sensors do not see this state, so no feedback can use it; "
        'remove the gain, or add a second encoder with tcp_sensor = "position"'
    )
    BANDWIDTH_OUT_OF_REACH = (
        "no stable loop reaches minimum_bandwidth with the required margins; "
        "shorten force_lag and the cycles, or lower minimum_bandwidth"
    )
    MARGINS_OUT_OF_REACH = (
        "no cascade, however soft, has the required margins: it takes damping from a mode that "
        "the encoder sees; check the sign of measured_gain, or add a notch to force_filters"
    )
    UNDAMPED_MODE = (
        "the encoder does not see this mode, so it would ring for ever; "
        "state its damping_ratio (measured, or a cautious 0.002)"
    )
    FEEDBACK_DESIGN_FAILED = (
        "the Riccati equation of the state feedback or of its observer has no reliable solution "
        'for these numbers; check their units, or set control.state_feedback = "off"'
    )
    NO_FORCE_LEFT = (
        "the static load takes all of the force, so the axis cannot move; "
        "raise max_force or balance the load"
    )
    MOVE_TOO_LONG = (
        "so long a motion is not followed cycle by cycle; check the unit of max_force, or state a "
        "shorter move (a smaller velocity_step, or a shorter distance at the same max_velocity: "
        "constant velocity and long constant acceleration leave no vibration, so the limits stay "
        "nearly the same; take what is cut off from max_settling_time, too)"
    )
    SETPOINT_FAILED = "Ruckig found no setpoint for these limits; check that they are in SI units"
    WORKER_LOST = (
        "processes of the sweep ended again and again, for want of memory or by force; "
        "continue with --resume, with fewer --workers"
    )
    STOPPED = "the sweep was interrupted; continue with --resume"
    PRINTING_FAILED = "the PDF could not be set; use --no-pdf and report the message"


class ComputationError(MtcommissionError):
    """A computation ended with a named outcome other than success.

    Parameters
    ----------
    outcome
        The named outcome; its value is the remedy.
    detail
        What was computed, with numbers and units.
    """

    exit_code = 3

    def __init__(self, outcome: Outcome, detail: str) -> None:
        self.outcome = outcome
        self.detail = detail
        super().__init__(f"{outcome.name.lower().replace('_', ' ')}: {detail}: {outcome.value}")
