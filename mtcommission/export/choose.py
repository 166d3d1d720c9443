"""Which numbers to type in: the nearest safe ones that keep what the record promises.

Rounding both limits down is safe for force and peaks, but it moves the ends of the ramps, and
with them the residual vibration. So every pair is taken as the control reads it back, simulated,
and if the nearest one misses a requirement, others below it are tried.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.controls.row import Key, Row, Setting, Values, unreadable
from mtcommission.export.held import Held, read_limits, write_limits
from mtcommission.export.subject import Subject, for_mode
from mtcommission.limits.judge import Candidate
from mtcommission.record.limits import ModeLimitsEntry
from mtcommission.setpoint.motion_limits import MotionLimits

SHARES = tuple(1.0 - 1e-3 * n for n in (0, 1, 2, 4, 8, 16, 32, 64))
"""Shares of each recommended limit that are tried."""

CYCLES = range(9)
"""How many whole position cycles above the recommended jerk time are tried."""

LOWER = tuple(0.98**i for i in range(30))
"""Shares of the recommended acceleration where the jerk time comes in whole cycles: the other
limit must then find the valley."""

WIDE = tuple(0.9**i for i in range(36))
"""The same where there is no jerk limit at all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chosen:
    """Limits as they are typed in, and what they do."""

    values: Values  # what the control makes of the typed numbers [SI]
    verdict: Candidate  # of the simulation with exactly these


def take(rows: Iterable[Row], values: Values) -> dict[Key, float | str]:
    """Return what a control makes of settings: each typed by its rows and read back.

    Raises
    ------
    InputError
        If two rows of the same setting end up different.
    """
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
    mode: ModeLimitsEntry | None = None,
    shapers: Sequence[Values] = (),
) -> Chosen:
    """Return the limits to type in.

    Raises
    ------
    InputError
        If the control has no number that small.
    """
    name = mode.name if mode else ""
    machine = for_mode(held.machine, mode)
    forms = {row.setting for row in rows}
    rapid = subject.fastest
    is_jerkless = not forms & {Setting.JERK, Setting.JERK_TIME}

    def judge(values: Values) -> Chosen:
        closed = replace(held, values={**held.values, **values})
        limits = read_limits(closed.values, name)
        return Chosen(values=values, verdict=closed.judge(machine, limits))

    def typed() -> Iterator[Values]:
        for limits, shaper in product(_tried(subject, forms, mode), shapers or ({},)):
            wanted = {**write_limits(limits, rapid, name), (Setting.RAPID, ""): rapid, **shaper}
            values = take((row for row in rows if row.key in wanted), wanted)
            if all(values.values()):
                yield values

    unlike = {tuple(values.items()): values for values in typed()}
    if not unlike:
        message = Message("export-too-small", acceleration=subject.limits.acceleration)
        raise InputError([Fault(where="--control", message=message)])
    nearest, *others = unlike.values()
    tried = [judge(nearest)]
    promised = mode.meets_requirements if mode else subject.record.assessment.met
    if not is_jerkless and (subject.left_out or not promised):
        return tried[0]

    def ramp(values: Values) -> float:
        limits = read_limits({**held.values, **values}, name)
        return limits.jerk_time + subject.fastest / limits.acceleration

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
    subject: Subject, forms: set[Setting], mode: ModeLimitsEntry | None
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
