"""Everything that can go wrong, as one tree.

MtcommissionError
├── InputError           exit code 2: what the user gave cannot be used; all faults at once
└── ComputationError     exit code 3: how a computation ended, with its remedy; whoever can do
                         without it says so and goes on

A failed assessment is neither: it is a result (exit code 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from mtcommission.base.messages.message import Message, printable

if TYPE_CHECKING:
    from mtcommission.base.messages.catalogue import Catalogue


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One thing wrong with the input."""

    where: str  # file, or option of the command line; "" if neither applies
    line: int = 0  # in that file, counted from 1; 0 where there is no line
    key: str = ""  # e.g. ``moves[1].distance``; "" for the whole file
    message: Message  # what was got (with its unit), what is allowed, what to do

    def text(self, catalogue: Catalogue) -> str:
        """Return the fault with its place, in the language of a catalogue."""
        where, key = printable(self.where), printable(self.key)
        place = f"{where}:{self.line}" if self.line else where
        return ": ".join(part for part in (place, key, catalogue.say(self.message)) if part)

    def __str__(self) -> str:
        return self.text(_english())


INTERRUPTED = 130
"""Exit code after Ctrl-C, as shells have it."""


class MtcommissionError(Exception):
    """Base of all errors that the program raises on purpose; ``str`` speaks English."""

    exit_code = 3

    def text(self, catalogue: Catalogue) -> str:
        """Return what went wrong, in the language of a catalogue."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.text(_english())


class InputError(MtcommissionError):
    """What the user gave cannot be used; carries every fault found, at least one."""

    exit_code = 2

    def __init__(self, faults: Sequence[Fault]) -> None:
        super().__init__(faults)
        self.faults = tuple(faults)

    @classmethod
    def at(cls, where: str, message: Message, *, line: int = 0, key: str = "") -> InputError:
        """Return the error of one fault, at its place."""
        return cls([Fault(where=where, line=line, key=key, message=message)])

    def text(self, catalogue: Catalogue) -> str:
        """Return a line for each fault."""
        return "\n".join(fault.text(catalogue) for fault in self.faults)


class Refused(ValueError):
    """A value cannot be used; whoever knows where it stands makes a fault of its message."""

    def __init__(self, message: Message) -> None:
        super().__init__(message)
        self.message = message

    def __str__(self) -> str:
        return _english().say(self.message)


class Outcome(Enum):
    """How a computation can end without a result; the text of the key tells the remedy."""

    EQUAL_POLES = "outcome-equal-poles"
    NOT_CONTROLLABLE = "outcome-not-controllable"
    FINAL_TIME_TOO_SHORT = "outcome-final-time-too-short"
    BOUND_CANNOT_HOLD = "outcome-bound-cannot-hold"
    BEYOND_HORIZON = "outcome-beyond-horizon"
    MODES_NOT_TOLD_APART = "outcome-modes-not-told-apart"
    NO_CONVERGENCE = "outcome-no-convergence"
    UNSTABLE_LOOP = "outcome-unstable-loop"
    NOT_OBSERVABLE = "outcome-not-observable"
    BANDWIDTH_OUT_OF_REACH = "outcome-bandwidth-out-of-reach"
    MARGINS_OUT_OF_REACH = "outcome-margins-out-of-reach"
    UNDAMPED_MODE = "outcome-undamped-mode"
    FEEDBACK_DESIGN_FAILED = "outcome-feedback-design-failed"
    NO_FORCE_LEFT = "outcome-no-force-left"
    MOVE_TOO_LONG = "outcome-move-too-long"
    SETPOINT_FAILED = "outcome-setpoint-failed"
    WORKER_LOST = "outcome-worker-lost"
    SCHEDULER_LOST = "outcome-scheduler-lost"
    STOPPED = "outcome-stopped"
    PRINTING_FAILED = "outcome-printing-failed"


class ComputationError(MtcommissionError):
    """A computation ended with a named outcome; ``detail``: what was computed, with numbers."""

    def __init__(self, outcome: Outcome, detail: Message) -> None:
        super().__init__(outcome, detail)
        self.outcome, self.detail = outcome, detail
        if outcome is Outcome.STOPPED:
            self.exit_code = INTERRUPTED

    @property
    def message(self) -> Message:
        """The outcome with its detail and remedy, to be told within a result."""
        return Message(self.outcome.value, detail=self.detail)

    def text(self, catalogue: Catalogue) -> str:
        """Return outcome, detail and remedy."""
        return catalogue.say(self.message)


def _english() -> Catalogue:
    """The catalogue, loaded only when an error is read: most runs need none."""
    from mtcommission.base.messages.catalogue import Catalogue

    return Catalogue()
