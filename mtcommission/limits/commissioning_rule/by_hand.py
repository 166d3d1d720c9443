"""The commissioning rule on paper: its formulas, and the calculation step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mtcommission.limits.commissioning_rule.estimate import (
    AxisEstimate,
    count_ramps,
    passed_by_average,
    servo_sensitivity,
)
from mtcommission.machine.machine import Move, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormula:
    """One of the rule's formulas."""

    text: str  # in the field's signs, e.g. "a ≤ √(v j)"; "_" begins an index
    aside: Message | None = None  # where it holds; None: everywhere


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStep:
    """One line of the hand calculation."""

    name: Message  # what is computed
    formula: Message | str
    value: float
    unit: str  # SI unit of ``value``


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """A setpoint filter, or none, with the jerk and the acceleration that go with it."""

    name: Message  # which filter
    limits: MotionLimits  # acceleration, jerk, and the filter where it is the rule's to choose
    average: float  # length T_F of the moving average [s]; 0: none
    allowed_jerk: float  # what the band allows, however short the ramp is [m/s³]
    by_force: float  # what the force allows at that jerk [m/s²]
    bound_by: Message
    """What bounds the acceleration: the force, or the reach (a is just reached by a move)."""
    duration: float  # of the slowest move, filter included, t_e [s]
    residual_deviation: float  # predicted by the rule, worst size and corner [m]


TOGETHER = "√(C_S² + C_P² + Σ (2 n C_i W_i)²)"
"""Sensitivity of servo, payload and modes together [s³]."""

PASSED = "R(f T_F)/(ω T_F)"
"""What a moving average passes of a mode."""

FORMULAS: tuple[tuple[str, Message | None], ...] = (
    (f"1.25 j {TOGETHER} ≤ band", None),
    ("C_i = m |g_i|/ω_i³", None),
    (f"W = {PASSED}", Message("rule-within-the-spread")),
    ("R(x) = |1 − exp(2 π x (i − ζ))|", None),
    ("a (1.17 m + Kp T_p/2) + Kp Σ (m c_i/ω_i) min(a, 2 j/ω_i) ≤ F", None),
    ("a ≤ √(v j)", None),
)


def formulas_for(moves: Sequence[Move]) -> tuple[RuleFormula, ...]:
    """Return the rule's formulas for some moves, with the distance where one is positioning."""
    found = list(FORMULAS)
    if not all(isinstance(move, VelocityStep) for move in moves):
        found.append(("2 a³ ≤ L j²", Message("rule-for-positioning")))
    return tuple(RuleFormula(text=text, aside=aside) for text, aside in found)


def calculate_by_hand(axis: AxisEstimate, found: Tried) -> tuple[RuleStep, ...]:
    """Return the calculation of what the rule found for an axis, in order."""
    average, limits = found.average, found.limits
    swing = "min(2.4, 6/(ω_v T_F))" if average else "2.4"
    servo = f"(max(0.4 T², 0.18 T_p²) + 0.8 Σ m c_i/ω_i²) {swing}/ω_v"
    lines: list[tuple[Message, Message | str, float, str]] = [
        (Message("rule-ramps"), Message("rule-by-moves"), count_ramps(axis.machine.moves), "1"),
        (Message("rule-average-length"), found.name, average, "s"),
        (Message("rule-speed-loop"), "Kp/m", axis.servo.speed, "1/s"),
        (Message("rule-servo-sensitivity"), servo, servo_sensitivity(axis, average), "s^3"),
        (Message("rule-unknown-mass"), "|m_ff − m|/m", axis.servo.missing, "1"),
        (Message("rule-payload-sensitivity"), "ε Tn/(ω_v Kv)", axis.servo.drag, "s^3"),
    ]
    lowest = "f (1 − s)/√(1 + m |c| min(1, ω_v/ω))"
    share = PASSED if average else Message("rule-no-average")
    for mode in axis.modes:
        name, passed = mode.name, passed_by_average(mode, average)
        sensitivity = Message("rule-mode-sensitivity", mode=name)
        lines += [
            (Message("rule-mode-lowest", mode=name), lowest, mode.low_hz, "Hz"),
            (sensitivity, "m |g|/ω³", mode.jerk_sensitivity, "s^3"),
            (Message("rule-mode-passed", mode=name), share, passed, "1"),
        ]
    by_band = f"band/(1.25 {TOGETHER})"
    if axis.controller.jerk_feedforward:
        by_band = f"min({by_band}, F/(2 m T))"
    force, bound = Message("rule-see-formula"), Message("rule-bound-by", what=found.bound_by)
    lines += [
        (Message("rule-allowed-jerk"), by_band, found.allowed_jerk, "m/s^3"),
        (Message("rule-force-acceleration"), force, found.by_force, "m/s^2"),
        (Message("rule-acceleration"), bound, limits.acceleration, "m/s^2"),
        (Message("rule-jerk-time"), "max(a/j, T_p)", limits.jerk_time, "s"),
        (Message("rule-jerk"), "a/t_j", limits.jerk, "m/s^3"),
        (Message("rule-residual"), f"j {TOGETHER}", found.residual_deviation, "m"),
    ]
    return tuple(
        RuleStep(name=name, formula=formula, value=value, unit=unit)
        for name, formula, value, unit in lines
    )
