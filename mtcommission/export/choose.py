"""Which numbers to type in: the nearest safe ones that keep what the record promises.

Rounding both limits down is safe for force and peaks, but it moves the ends of the ramps, and
with them the residual vibration. So every pair is taken as the control reads it back, simulated,
and if the nearest one misses a requirement, others below it are tried.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Control, complete
from mtcommission.controls.row import Key, Row, Setting, Values, unreadable
from mtcommission.controls.syntax import Entry, type_in
from mtcommission.export.held import (
    LIMITS,
    Held,
    filter_of,
    hold,
    loop_of,
    read_limits,
    today_of,
    write_filter,
    write_limits,
)
from mtcommission.export.subject import Subject
from mtcommission.limits.judge import Candidate
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.attainable import ModeLimits

SHARES = tuple(1.0 - 1e-3 * n for n in (0, 1, 2, 4, 8, 16, 32, 64))
"""Shares of each recommended limit that are tried."""

CYCLES = range(9)
"""How many whole position cycles above the recommended jerk time are tried."""

LOWER = tuple(0.98**i for i in range(30))
"""Shares of the recommended acceleration where the jerk time comes in whole cycles: the other
limit must then find the valley."""

WIDE = tuple(0.9**i for i in range(36))
"""The same where there is no jerk limit at all."""

SHARED = {Setting.SHAPER, Setting.SHAPER_FREQUENCY, Setting.SHAPER_DAMPING, Setting.RAPID}
"""Settings that are chosen with the recommended limits, for all machining modes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """Limits as they are typed in, and what they do."""

    values: Values  # what the control makes of the typed numbers [SI]
    verdict: Candidate  # of the simulation with exactly these


@dataclass(frozen=True, slots=True, kw_only=True)
class FilledIn:
    """The rows of a control with what is typed in."""

    entries: tuple[Entry, ...]  # those that are only remarks last
    indices: frozenset[str]  # of its rows: the machining modes that it has, filters by number
    held: Held  # the loop that was judged


def fill_in(subject: Subject, target: Control) -> FilledIn:
    """Return every row with what is typed in.

    Raises InputError if the loop is unstable as typed, or the control has no number that small.
    """
    loop = loop_of(subject)
    own = list(target.rows(subject.axis, loop))
    if subject.machine.drive.follows:
        kept = filter_of(subject)
        own = [row for row in own if row.key in kept or row.key not in loop]
        loop = kept
    rows = complete(own, loop, subject.machine.axis_units)
    held = hold(subject, _take((row for row in rows if row.key in loop), loop))
    values = dict(loop)
    free = [row for row in rows if row.key not in held.values]
    shared = [row for row in free if not row.index and row.setting in LIMITS | SHARED]
    proposed = [] if subject.setpoint_filter else subject.shapers(target.shapers)
    values |= choose_limits(
        subject, held, shared, shapers=[write_filter(one) for one in proposed]
    ).values
    for mode in subject.record.limits.modes:
        of_mode = [row for row in rows if row.setting in LIMITS and row.index == mode.name]
        if of_mode and mode.meets_requirements:
            chosen = choose_limits(subject, held, of_mode, mode=mode)
            values |= chosen.values if chosen.verdict.assessment.is_met else {}
    entries = type_in(rows, values, today_of(subject))
    ordered = tuple(sorted(entries, key=lambda entry: entry.row.is_elsewhere))
    return FilledIn(entries=ordered, indices=frozenset(row.index for row in rows), held=held)


def _take(rows: Iterable[Row], values: Values) -> dict[Key, float | str]:
    """What a control makes of settings: each typed by its rows and read back."""
    taken: dict[Key, float | str] = {}
    for row in rows:
        value = row.decode(row.encode(values[row.key]))
        if taken.setdefault(row.key, value) != value:
            raise unreadable(row.name)
    return taken


def choose_limits(
    subject: Subject,
    held: Held,
    rows: Sequence[Row],
    *,
    mode: ModeLimits | None = None,
    shapers: Sequence[Values] = (),
) -> Chosen:
    """Return the limits to type in.

    Raises InputError if the control has no number that small.
    """
    name = mode.name if mode else ""
    forms, rapid = {row.setting for row in rows}, subject.fastest
    is_jerkless = not forms & {Setting.JERK, Setting.JERK_TIME}

    def limits_of(values: Values) -> MotionLimits:
        return read_limits({**held.values, **values}, name)

    def judge(values: Values) -> Chosen:
        return Chosen(values=values, verdict=held.judge(limits_of(values), mode))

    def typed() -> Iterator[Values]:
        for limits, shaper in product(_tried(subject, forms, mode), shapers or ({},)):
            wanted = {**write_limits(limits, rapid, name), (Setting.RAPID, ""): rapid, **shaper}
            values = _take((row for row in rows if row.key in wanted), wanted)
            if all(values.values()):
                yield values

    unlike = {tuple(values.items()): values for values in typed()}
    if not unlike:
        message = Message("export-too-small", acceleration=subject.limits.acceleration)
        raise InputError.at("--control", message)
    nearest, *others = unlike.values()
    tried = [judge(nearest)]
    promised = mode.meets_requirements if mode else subject.record.assessment.met
    if not is_jerkless and (subject.left_out or not promised):
        return tried[0]

    def ramp(values: Values) -> float:
        limits = limits_of(values)
        return limits.jerk_time + rapid / limits.acceleration

    # A longer ramp settles later but for the valleys, so the first good one is about the best.
    for values in sorted(others, key=ramp):
        if tried[-1].verdict.assessment.is_met:
            return tried[-1]
        tried.append(judge(values))
    if is_jerkless:
        # Full acceleration without a jerk limit would shake the machine most of all.
        return min(tried, key=lambda one: one.verdict.residual_deviation)
    return tried[-1] if tried[-1].verdict.assessment.is_met else tried[0]


def _tried(
    subject: Subject, forms: set[Setting], mode: ModeLimits | None
) -> Iterator[MotionLimits]:
    """The limits on the safe side, the nearest first."""
    a, j = subject.limits.acceleration, subject.limits.jerk
    if mode is not None and mode.acceleration is not None and mode.jerk is not None:
        a, j = mode.acceleration, mode.jerk
    cycle = subject.controller.position_cycle
    if Setting.JERK in forms:
        for one, other in product(SHARES, SHARES):
            yield MotionLimits(acceleration=one * a, jerk=other * j)
    elif Setting.JERK_TIME in forms:
        for count, share in product(CYCLES, LOWER):
            time = a / j + count * cycle
            yield MotionLimits(acceleration=share * a, jerk=share * a / time)
    else:
        a = min(a, subject.kind.largest_acceleration)
        for share in WIDE:
            yield MotionLimits(acceleration=share * a, jerk=share * a / cycle)
