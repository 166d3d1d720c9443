"""Record and traces -> what can be said: the whole of ``verify`` as a list of verbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, sqrt

import numpy as np

from mtcommission.errors import Fault, InputError
from mtcommission.machine.moves import VelocityStep
from mtcommission.messages.message import Message
from mtcommission.record.read_back import read_limits
from mtcommission.record.record import Record
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.checks import Check, Verdict, judge_all, what_of, worst
from mtcommission.verify.motions import Recorded, lay_out
from mtcommission.verify.planner import number_of
from mtcommission.verify.prediction import Rebuilt, rebuild
from mtcommission.verify.promises import check_recorded
from mtcommission.verify.setpoint import Motion, find_motions
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

    # record, rebuilt: The promises, and the loop.
    record: Record
    rebuilt: Rebuilt
    traces: tuple[Trace, ...]  # As they were read
    recorded: tuple[Recorded, ...]  # Moves, each beside its prediction
    # The worst of each promise over all repetitions, the setpoint's first.
    checks: tuple[Check, ...]
    missing: tuple[int, ...]  # Numbers of the record's moves that were not recorded, from 1
    verdict: Verdict  # Over all checks; where a move is missing, no more than "cannot tell"
    # What the reader must know; the first one speaks of the planner if it did not obey.
    warnings: tuple[Message, ...]

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
        open_ones = tuple(
            dict.fromkeys(
                what_of(check)
                for check in self.checks
                if check.verdict is Verdict.UNKNOWN and check.reason.kind not in NOT_ASKED
            )
        )
        if self.verdict is Verdict.FAILS:
            return Message("verify-verdict-does-not-hold")
        if self.missing and judge_all(self.checks) is Verdict.HOLDS:
            known = tuple(sorted({one.number for one in self.recorded if one.number}))
            return Message("verify-verdict-in-part", known=known, missing=self.missing)
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
        return _unexplained(self.recorded)

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
    tau = rebuilt.controller.reference_delay
    entered = read_limits(record.limits.recommended)
    recorded: list[Recorded] = []
    behind: list[Message] = []
    warnings: list[Message] = []
    read: list[Trace] = []
    for trace in traces:
        own, more = _lay_out_all(rebuilt, entered, trace)
        if not trace.is_delayed and tau > 0.0:
            late = replace(trace, is_delayed=True)
            if (shift := _middle_shift(own)) is not None and abs(shift + tau) < SAME_DELAY * tau:
                trace = late
            elif _has_error_alone(trace):
                # No position comes earlier then: the deviation itself does.
                other, _ = _lay_out_all(rebuilt, entered, late)
                before, after = _unexplained(own), _unexplained(other)
                trace = late if (after or inf) < FITS_BETTER * (before or 0.0) else trace
            if trace is late:
                own, more = _lay_out_all(rebuilt, entered, trace)
                behind.append(Message("verify-behind-delay", file=trace.file, delay=tau))
        read.append(trace)
        warnings += more
        recorded += own
    if not recorded:
        files = tuple(trace.file for trace in traces)
        raise InputError([Fault(where=files[0], message=Message("verify-no-move"))])
    if len(recorded) > MOST_MOTIONS:
        warnings.append(Message("verify-many-moves", used=MOST_MOTIONS, found=len(recorded)))
        recorded = recorded[:MOST_MOTIONS]
    rows = [check_recorded(rebuilt, record, entered, one) for one in recorded]
    checks = _gather(rows)
    verdict, numbers = judge_all(checks), {one.number for one in recorded}
    missing = tuple(n for n in range(1, len(rebuilt.machine.moves) + 1) if n not in numbers)
    if missing:
        warnings.append(Message("verify-moves-missing", moves=missing))
        if verdict is Verdict.HOLDS:
            verdict = Verdict.UNKNOWN
    planner = [check for check in checks if check.key.startswith("setpoint ")]
    first = [_planner_says(check) for check in planner if check.verdict is Verdict.FAILS]
    remarks = [remark for trace in traces for remark in trace.remarks]
    return Verification(
        record=record,
        rebuilt=rebuilt,
        traces=tuple(read),
        recorded=tuple(recorded),
        checks=checks,
        missing=missing,
        verdict=verdict,
        warnings=tuple(dict.fromkeys([*behind, *first, *warnings, *remarks])),
    )


def _lay_out_all(
    rebuilt: Rebuilt, entered: MotionLimits, trace: Trace
) -> tuple[list[Recorded], list[Message]]:
    """Every move of a trace beside its prediction, and what was left out."""
    motions, warnings = _motions(rebuilt, entered, trace)
    return [lay_out(rebuilt, entered, trace, motion) for motion in motions], warnings


def _middle_shift(recorded: Sequence[Recorded]) -> float | None:
    """By which positions come later than predicted, middle of all moves [s]."""
    known = [one.shift for one in recorded if isfinite(one.shift_error)]
    return float(np.median(known)) if known else None


def _has_error_alone(trace: Trace) -> bool:
    """Whether only a following error tells where the axis is."""
    return trace.find(Role.ENCODER) is None and trace.find(Role.TOOL) is None


def _unexplained(recorded: Sequence[Recorded]) -> float | None:
    """Share of the deviation that the nominal prediction leaves, by RMS; None: no position."""
    missed = total = 0.0
    for move in recorded:
        for one in move.beside:
            if one.is_position:
                moving = one.after(move.motion.begin)
                apart = one.deviation - one.predicted_deviation[0]
                missed += float(np.sum(apart[moving] ** 2))
                total += float(np.sum(one.deviation[moving] ** 2))
    return sqrt(missed / total) if total > 0.0 else None


def _planner_says(check: Check) -> Message:
    above = check.reason.kind == "verify-setpoint-above"
    kind = "verify-planner-exceeds" if above else "verify-planner-below"
    return Message(
        kind, what=what_of(check), measured=check.measured, planned=check.predicted or check.limit,
        unit=check.unit,
    )  # fmt: skip


def _motions(
    rebuilt: Rebuilt, entered: MotionLimits, trace: Trace
) -> tuple[list[Motion], list[Message]]:
    """The moves of a trace that begin at rest, as the record's moves end."""
    limits, moves = entered, rebuilt.machine.moves
    kinds = {isinstance(move, VelocityStep) for move in moves}
    found: list[Motion] = []
    warnings: list[Message] = []
    begins_moving = False
    setpoint = trace.setpoint
    if trace.is_delayed:
        setpoint = replace(setpoint, start=setpoint.start - rebuilt.controller.reference_delay)
    for coasting in sorted(kinds):
        motions, begins_moving = find_motions(
            setpoint,
            acceleration=limits.acceleration,
            jerk=limits.jerk,
            coasting=coasting,
        )
        found += [one for one in motions if one.coasts or not coasting or len(kinds) == 1]
    if len(kinds) > 1:
        found = _apart(found, [number_of(one, moves, entered) for one in found])
    if begins_moving:
        warnings.append(Message("verify-begins-moving", file=trace.file))
    whole = [
        one
        for one in found
        if not any(begin < one.until and end > one.begin for begin, end in trace.gaps)
    ]
    if len(whole) < len(found):
        warnings.append(
            Message("verify-moves-with-gaps", count=len(found) - len(whole), file=trace.file)
        )
    return whole, warnings


def _apart(motions: Sequence[Motion], numbers: Sequence[int]) -> list[Motion]:
    """Each move once, where it may end at rest or at a velocity: as the record knows it."""
    known = [one for one, number in zip(motions, numbers, strict=True) if number]
    rest = [
        one
        for one in motions
        if not one.coasts and not any(abs(one.begin - other.begin) < one.blur for other in known)
    ]
    return sorted([*known, *rest], key=lambda one: one.begin)


def _gather(rows: Sequence[Sequence[Check]]) -> tuple[Check, ...]:
    """One check for each promise: the worst of its repetitions."""
    grouped: dict[str, list[Check]] = {}
    for check in (check for row in rows for check in row):
        grouped.setdefault(check.name, []).append(check)
    # A move that the record does not name tells less of the same thing.
    return tuple(worst(same) for same in grouped.values())
