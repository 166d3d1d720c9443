"""Limits -> the numbers that a control takes, rounded to the safe side and judged again.

Rounding both limits down is safe for force and peaks, but it moves the ends of the ramps, and
with them the residual vibration. So the pair that is typed in is simulated as it will be
read back, and if the nearest one misses a requirement, others below it are tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from enum import Enum
from itertools import product
from math import inf

from mtcommission.errors import Fault, InputError
from mtcommission.export.shaping import TypedShaper
from mtcommission.export.subject import Subject, Verdict, judge_plan
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import Plan, plan_within
from mtcommission.study.shapers import Shaper, shape_setpoint

DIGITS = 4
"""Significant digits of what is typed in: a tenth of the digits by which valleys differ."""

SAME = Decimal("1e-9")
"""A number this close to a round one (relative) is that one: 1.68/1e-3 must stay 1680."""

STEPS = (0, 1, 2, 4, 8, 16, 32, 64)
"""How many last digits below the recommendation are tried."""

CYCLES = range(9)
"""How many whole steps above the recommended jerk time are tried."""

SHARES = tuple(0.98**i for i in range(30))
"""Shares of the recommended acceleration where the jerk time comes in whole cycles: the other
limit must then find the valley."""

WIDE = tuple(0.9**i for i in range(36))
"""The same where there is no jerk limit at all."""


class AccelerationForm(Enum):
    """How a control stores the acceleration."""

    VALUE = "value"
    RISE_TIME = "time from standstill to rapid traverse"


class JerkForm(Enum):
    """How a control stores the jerk."""

    VALUE = "value"
    TIME = "time of one acceleration ramp"
    NONE = "not at all"


@dataclass(frozen=True, slots=True, kw_only=True)
class Coding:
    """How a control stores a pair of limits.

    Parameters
    ----------
    acceleration_form, jerk_form
        As a value or as a time.
    acceleration_unit, jerk_unit
        One unit of the typed number in SI [m/s², m/s³ or s].
    time_step
        Whole steps of a jerk time, in its unit.
    is_whole
        Whether the control takes the acceleration as a whole number only.
    rapid
        Velocity that a rise time belongs to [m/s].
    shapers
        Input shapers of the control, tried in order; empty for none.
    """

    acceleration_unit: float
    jerk_unit: float = 1.0
    acceleration_form: AccelerationForm = AccelerationForm.VALUE
    jerk_form: JerkForm = JerkForm.VALUE
    time_step: int = 1
    is_whole: bool = False
    rapid: float = inf
    shapers: tuple[TypedShaper, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """A pair of limits as it is typed in, and what it does.

    Parameters
    ----------
    acceleration, jerk
        In the control's own units; jerk "" where the control has none.
    limits
        What the control makes of them [SI].
    shaper
        Input shaper in the control; None without one.
    verdict
        Of the simulation with exactly these numbers.
    """

    acceleration: str
    jerk: str
    limits: MotionLimits
    shaper: TypedShaper | None
    verdict: Verdict


@dataclass(frozen=True, slots=True, kw_only=True)
class _Pair:
    """Numbers to be typed, not judged yet."""

    acceleration: str
    jerk: str
    limits: MotionLimits
    shaper: TypedShaper | None = None


def round_down(
    value: float, *, digits: int = DIGITS, steps: int = 0, is_whole: bool = False
) -> Decimal:
    """Return the number with few significant digits at or below a value.

    Parameters
    ----------
    value
        > 0.
    digits
        Significant digits.
    steps
        Last digits to go further down.
    is_whole
        Whether only a whole number will do.

    Returns
    -------
    Decimal

    Examples
    --------
    >>> round_down(1.68 / 1e-3), round_down(47.0888), round_down(47.0888, steps=2)
    (Decimal('1680'), Decimal('47.08'), Decimal('47.06'))
    >>> round_down(47.0888, is_whole=True)
    Decimal('47')
    """
    exact = Decimal(value) * (1 + SAME)
    quantum = Decimal(1).scaleb(exact.adjusted() - digits + 1)
    quantum = max(quantum, Decimal(1)) if is_whole else quantum
    return (exact / quantum).to_integral_value(ROUND_FLOOR) * quantum - steps * quantum


def round_up(value: float, *, step: int = 1) -> int:
    """Return the whole multiple of a step at or above a value.

    Examples
    --------
    >>> round_up(47.0874, step=2), round_up(48.0000000001, step=2)
    (48, 48)
    """
    exact = Decimal(value) * (1 - SAME)
    return int((exact / step).to_integral_value(ROUND_CEILING)) * step


def round_up_digits(value: float, *, digits: int = DIGITS) -> Decimal:
    """Return the number with few significant digits at or above a value > 0.

    Examples
    --------
    >>> round_up_digits(23.3601), round_up_digits(23.36)
    (Decimal('23.37'), Decimal('23.36'))
    """
    exact = Decimal(value) * (1 - SAME)
    quantum = Decimal(1).scaleb(exact.adjusted() - digits + 1)
    return (exact / quantum).to_integral_value(ROUND_CEILING) * quantum


def type_number(number: Decimal | int) -> str:
    """Return a number as it is typed: no exponent, no zeros behind the point.

    Examples
    --------
    >>> type_number(Decimal("1.680E+3")), type_number(Decimal("47.0800"))
    ('1680', '47.08')
    """
    text = format(Decimal(number), "f")
    return text.rstrip("0").rstrip(".") if "." in text else text


def type_limits(subject: Subject, coding: Coding) -> Typed:
    """Return the numbers to type in: the nearest safe pair that meets all requirements.

    Parameters
    ----------
    subject
        The axis with its recommendation.
    coding
        How the control stores limits.

    Returns
    -------
    Typed
        Where no pair meets the requirements, the nearest one, or without a jerk limit the one
        that leaves least vibration; its verdict says so.

    Raises
    ------
    InputError
        If the control has no number that small.
    """
    pairs = list(_pairs(subject, coding))
    if not pairs:
        message = Message("export-too-small", acceleration=subject.limits.acceleration)
        raise InputError([Fault(where="--control", message=message)])
    typed = _judge(subject, pairs[0])
    is_jerkless = coding.jerk_form is JerkForm.NONE
    if typed.verdict.assessment.is_met or not (subject.is_met or is_jerkless):
        return typed
    # A longer ramp settles later but for the valleys, so the first good one is about the best.
    others = sorted(pairs[1:], key=lambda pair: _ramp(subject, pair))
    tried = [typed]
    for pair in others:
        tried.append(_judge(subject, pair))
        if tried[-1].verdict.assessment.is_met:
            return tried[-1]
    # Full acceleration without a jerk limit would shake the machine most of all.
    return min(tried, key=lambda one: one.verdict.residual_deviation) if is_jerkless else typed


def _ramp(subject: Subject, pair: _Pair) -> float:
    """Duration of the change to the largest velocity [s]."""
    shaper = pair.shaper.impulses.times[-1] if pair.shaper else 0.0
    return pair.limits.jerk_time + subject.fastest / pair.limits.acceleration + shaper


def _judge(subject: Subject, pair: _Pair) -> Typed:
    plan = plan_within(subject.machine, pair.limits)
    return Typed(
        acceleration=pair.acceleration,
        jerk=pair.jerk,
        limits=pair.limits,
        shaper=pair.shaper,
        verdict=judge_plan(subject, _shaped(plan, pair.shaper.impulses) if pair.shaper else plan),
    )


def _shaped(plan: Plan, shaper: Shaper) -> Plan:
    return lambda move: shape_setpoint(plan(move), shaper)


def _pairs(subject: Subject, coding: Coding) -> Iterator[_Pair]:
    """The pairs on the safe side, the nearest first; every one read back from its numbers."""
    match coding.jerk_form:
        case JerkForm.NONE:
            return _without_jerk(subject, coding)
        case JerkForm.TIME:
            return _with_jerk_time(subject, coding)
        case JerkForm.VALUE:
            return _with_jerk(subject, coding)


def _with_jerk(subject: Subject, coding: Coding) -> Iterator[_Pair]:
    wanted = subject.limits.jerk / coding.jerk_unit
    jerks = [round_down(wanted, steps=n) for n in STEPS]
    accelerations = [
        round_down(subject.limits.acceleration / coding.acceleration_unit, steps=n) for n in STEPS
    ]
    for number, jerk in product(accelerations, jerks):
        text, a = type_number(number), float(number) * coding.acceleration_unit
        limits = MotionLimits(acceleration=a, jerk=float(jerk) * coding.jerk_unit)
        yield _Pair(acceleration=text, jerk=type_number(jerk), limits=limits)


def _with_jerk_time(subject: Subject, coding: Coding) -> Iterator[_Pair]:
    shortest = round_up(subject.limits.jerk_time / coding.jerk_unit, step=coding.time_step)
    times = [shortest + n * coding.time_step for n in CYCLES]
    for time, (text, a) in product(times, _accelerations(subject, coding, SHARES)):
        limits = MotionLimits(acceleration=a, jerk=a / (time * coding.jerk_unit))
        yield _Pair(acceleration=text, jerk=type_number(time), limits=limits)


def _without_jerk(subject: Subject, coding: Coding) -> Iterator[_Pair]:
    accelerations = _accelerations(subject, coding, WIDE)
    for (text, a), shaper in product(accelerations, coding.shapers or (None,)):
        limits = without_jerk_limit(subject.machine, a)
        yield _Pair(acceleration=text, jerk="", limits=limits, shaper=shaper)


def _accelerations(
    subject: Subject, coding: Coding, shares: tuple[float, ...]
) -> list[tuple[str, float]]:
    """What may be typed for shares of the acceleration, with what it means [m/s²]."""
    unit, found = coding.acceleration_unit, []
    for a in (share * subject.limits.acceleration for share in shares):
        if coding.acceleration_form is AccelerationForm.RISE_TIME:
            number = Decimal(round_up(coding.rapid / a / unit))
            meaning = coding.rapid / (float(number) * unit)
        else:
            number = round_down(a / unit, is_whole=coding.is_whole)
            meaning = float(number) * unit
        if number > 0:
            found.append((type_number(number), meaning))
    return list(dict.fromkeys(found))
