"""Record and traces -> what can be said: the whole of ``verify`` as a list of verbs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.measured.measurement import refuse
from mtcommission.record.read_back import read_limits
from mtcommission.record.record import Record
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.beside import Recorded, lay_out, unexplained
from mtcommission.verify.checks import Check, Verdict, judge_all, what_of, worst
from mtcommission.verify.prediction import Rebuilt, rebuild
from mtcommission.verify.promises import check_recorded
from mtcommission.verify.setpoint import find_motions
from mtcommission.verify.trace import Role, Trace

MOST_MOTIONS = 40
"""Moves of all traces together that are looked at; more say nothing new."""

SAME_DELAY = 0.25
"""Of τ, by which the shift of a setpoint that was recorded behind it may differ from it (design
choice: the columns of a recorder are some samples apart)."""

FITS_BETTER = 0.5
"""Share of what the prediction left unexplained that a setpoint behind τ leaves at most where only
a following error was recorded (design choice)."""

NOT_ASKED = ("verify-delay-not-recorded",)
"""Reasons of what a record of this kind never shows: a warning says it, the headline does not."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Verification:
    """What the traces say about the record."""

    record: Record
    rebuilt: Rebuilt
    traces: tuple[Trace, ...]
    recorded: tuple[Recorded, ...]  # moves, each beside its prediction
    checks: tuple[Check, ...]  # the worst of each promise over all repetitions, setpoint's first
    missing: tuple[int, ...]  # numbers of the record's moves that were not recorded, from 1
    verdict: Verdict  # over all checks; where a move is missing, no more than "cannot tell"
    warnings: tuple[
        Message, ...
    ]  # what explains the others first: the setpoint, other moves, the planner

    @property
    def obeyed(self) -> bool | None:
        """Whether the control sent what was entered; None: cannot be told."""
        own = [check.verdict for check in self.checks if check.key.startswith("setpoint ")]
        if Verdict.FAILS in own:
            return False
        return None if Verdict.UNKNOWN in own or not own else True

    @property
    def headline(self) -> Message:
        """The verdict in words; it names what cannot be told, unless something does not hold."""
        if self.verdict is Verdict.FAILS:
            return Message("verify-verdict-does-not-hold")
        if self.missing and judge_all(self.checks) is Verdict.HOLDS:
            known = tuple(sorted({one.number for one in self.recorded if one.number}))
            return Message("verify-verdict-in-part", known=known, missing=self.missing)
        unknown = [
            check
            for check in self.checks
            if check.verdict is Verdict.UNKNOWN and check.reason.kind not in NOT_ASKED
        ]
        # What decides; where nothing of that is open, what else is.
        unknown = [check for check in unknown if check.decides] or unknown
        open_ones = tuple(dict.fromkeys(map(what_of, unknown)))
        if not open_ones:
            return Message(f"verify-verdict-{self.verdict.value.replace(' ', '-')}")
        moved = [one for one in self.checks if one.decides and one.move]
        some = any(one.verdict is Verdict.HOLDS for one in moved)
        return Message(f"verify-verdict-{'except' if some else 'nothing'}", what=open_ones)

    @property
    def shift(self) -> float | None:
        """By which positions come later than predicted, middle of all moves [s]."""
        return _middle_shift(self.recorded)

    @property
    def unexplained(self) -> float | None:
        """Share of the deviation that the nominal prediction leaves, by RMS; None: no position."""
        return unexplained(self.recorded)

    @property
    def noise_floor(self) -> float | None:
        """Of the tool, else of the encoder: what noise adds to a largest value [m]."""
        for role in (Role.TOOL, Role.ENCODER):
            found = [one.noise for move in self.recorded if (one := move.find(role))]
            if found:
                return max(found)
        return None


def verify(record: Record, traces: Sequence[Trace]) -> Verification:
    """Return what traces say about a record.

    Raise InputError where no trace holds a move from rest.
    """
    rebuilt = rebuild(record)
    entered = read_limits(record.limits.recommended)
    recorded: list[Recorded] = []
    warnings: list[Message] = []
    for trace in traces:
        own, more = _lay_out_all(rebuilt, entered, trace)
        recorded += own
        warnings += more
    if not recorded:
        raise refuse(traces[0].file, "verify-no-move")
    if len(recorded) > MOST_MOTIONS:
        warnings.append(Message("verify-many-moves", used=MOST_MOTIONS, found=len(recorded)))
        recorded = recorded[:MOST_MOTIONS]
    by_name: dict[str, list[Check]] = {}
    for one in recorded:
        for check in check_recorded(rebuilt, record, entered, one):
            by_name.setdefault(check.name, []).append(check)
    checks = tuple(map(worst, by_name.values()))
    verdict, numbers = judge_all(checks), {one.number for one in recorded}
    missing = tuple(n for n in range(1, len(rebuilt.machine.moves) + 1) if n not in numbers)
    if missing:
        warnings.append(Message("verify-moves-missing", moves=missing))
        if verdict is Verdict.HOLDS:
            verdict = Verdict.UNKNOWN
    first = [one for one in warnings if one.kind == "verify-behind-delay"]
    first += [one for trace in traces for one in _unknown_moves(trace, recorded, rebuilt)]
    remarks = [remark for trace in traces for remark in trace.remarks]
    return Verification(
        record=record,
        rebuilt=rebuilt,
        traces=tuple(traces),
        recorded=tuple(recorded),
        checks=checks,
        missing=missing,
        verdict=verdict,
        warnings=tuple(dict.fromkeys([*first, *_planner_says(checks), *warnings, *remarks])),
    )


def _unknown_moves(
    trace: Trace, recorded: Sequence[Recorded], rebuilt: Rebuilt
) -> Iterable[Message]:
    """That a trace holds moves which are none of the record's: it may be of another axis."""
    units = rebuilt.machine.axis_units
    if own := [one.motion for one in recorded if not one.number and one.trace.file == trace.file]:
        size, unit = own[0].travel, units.length.si
        if own[0].coasts:
            size, unit = own[0].final_velocity, units.velocity.si
        yield Message(
            "verify-moves-unknown", file=trace.file, moves=len(own), size=abs(size), unit=unit
        )


def _planner_says(checks: Iterable[Check]) -> Iterable[Message]:
    for check in checks:
        if check.key.startswith("setpoint ") and check.verdict is Verdict.FAILS:
            above = check.reason.kind == "verify-setpoint-above"
            yield Message(
                f"verify-planner-{'exceeds' if above else 'below'}",
                what=what_of(check),
                measured=check.measured,
                planned=check.predicted or check.limit,
                unit=check.unit,
            )


def _lay_out_all(
    rebuilt: Rebuilt, entered: MotionLimits, trace: Trace
) -> tuple[list[Recorded], list[Message]]:
    """Every move of a trace beside its prediction, and what there is to say about them.

    A setpoint that was recorded behind τ is taken for what it is.
    """
    tau = rebuilt.controller.reference_delay
    own, warnings = _moves_of(rebuilt, entered, trace)
    if trace.is_delayed or tau <= 0.0:
        return own, warnings
    has_error_alone = not trace.channels.keys() & {Role.ENCODER, Role.TOOL}
    shift = _middle_shift(own)
    is_late = shift is not None and abs(shift + tau) < SAME_DELAY * tau
    if not is_late and not has_error_alone:
        return own, warnings
    other, more = _moves_of(rebuilt, entered, replace(trace, is_delayed=True))
    if not is_late:
        # No position comes earlier then: the deviation itself does.
        before, after = unexplained(own), unexplained(other)
        if (after or inf) >= FITS_BETTER * (before or 0.0):
            return own, warnings
    return other, [Message("verify-behind-delay", file=trace.file, delay=tau), *more]


def _moves_of(
    rebuilt: Rebuilt, entered: MotionLimits, trace: Trace
) -> tuple[list[Recorded], list[Message]]:
    """The moves of a trace that begin at rest, as the record's moves end."""
    setpoint, warnings = trace.setpoint, list[Message]()
    if trace.is_delayed:
        setpoint = replace(setpoint, start=setpoint.start - rebuilt.controller.reference_delay)
    found, begins_moving = find_motions(setpoint, rebuilt.machine.moves, entered)
    if begins_moving:
        warnings.append(Message("verify-begins-moving", file=trace.file))
    whole = [
        one
        for one in found
        if not any(begin < one.until and end > one.begin for begin, end in trace.gaps)
    ]
    if lost := len(found) - len(whole):
        warnings.append(Message("verify-moves-with-gaps", count=lost, file=trace.file))
    return [lay_out(rebuilt, trace, motion) for motion in whole], warnings


def _middle_shift(recorded: Sequence[Recorded]) -> float | None:
    known = [one.shift for one in recorded if isfinite(one.shift_error)]
    return float(np.median(known)) if known else None
