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
from mtcommission.messages.formula import (
    Expression,
    Number,
    Relation,
    Root,
    Sum,
    call,
    symbol,
)
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormula:
    """One of the rule's formulas."""

    tree: Relation
    aside: Message | None = None  # where it holds; None: everywhere


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStep:
    """One line of the hand calculation."""

    name: Message  # what is computed
    formula: Expression | Message
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


def _formulas(*names: str) -> tuple[Expression, ...]:
    return tuple(symbol(name) for name in names)


a, j, t_j, m, n, F, v, L, Kp, Kv, Tn, T, T_p, T_F = _formulas(
    "a", "j", "t_j", "m", "n", "F", "v", "L", "Kp", "Kv", "Tn", "T", "T_p", "T_F"
)
f, g, c, i, s, x, C, W, omega, omega_v, zeta, eps, pi = _formulas(
    "f", "g", "c", "i", "s", "x", "C", "W", "omega", "omega_v", "zeta", "eps", "pi"
)
C_S, C_P, C_i, W_i, g_i, c_i, omega_i = _formulas(
    "C_S", "C_P", "C_i", "W_i", "g_i", "c_i", "omega_i"
)

RESIDUAL = (1.25 * j * Root(C_S**2 + C_P**2 + Sum((2 * n * C_i * W_i) ** 2))).at_most(
    symbol("band")
)
RAMP = call("R", x).equals(abs(1 - call("exp", 2 * pi * x * (i - zeta))))
FORCE = (
    a * (1.17 * m + Kp * T_p / 2) + Kp * Sum(m * c_i / omega_i * call("min", a, 2 * j / omega_i))
).at_most(F)


def formulas_for(moves: Sequence[Move]) -> tuple[RuleFormula, ...]:
    """Return the rule's formulas for some moves, with the distance where one is positioning."""
    found: list[tuple[Relation, Message | None]] = [
        (RESIDUAL, None),
        (C_i.equals(m * abs(g_i) / omega_i**3), None),
        (W.equals(call("R", f * T_F) / (omega * T_F)), Message("rule-within-the-spread")),
        (RAMP, None),
        (FORCE, None),
        (a.at_most(Root(v * j)), None),
    ]
    if not all(isinstance(move, VelocityStep) for move in moves):
        reach = (2 * a**3).at_most(L * j**2)
        found.append((reach, Message("rule-for-positioning")))
    return tuple(RuleFormula(tree=tree, aside=aside) for tree, aside in found)


def calculate_by_hand(axis: AxisEstimate, found: Tried) -> tuple[RuleStep, ...]:
    """Return the calculation of what the rule found for an axis, in order."""
    average, limits = found.average, found.limits
    impulse = call("max", 0.4 * T**2, 0.18 * T_p**2) + 0.8 * Sum(m * c / omega**2)
    swing = call("min", 2.4, 6 / (omega_v * T_F)) if average else Number("2.4")
    lines: list[tuple[Message, Expression | Message, float, str]] = [
        (Message("rule-ramps"), Message("rule-by-moves"), count_ramps(axis.machine.moves), "1"),
        (Message("rule-average-length"), found.name, average, "s"),
        (Message("rule-speed-loop"), Kp / m, axis.servo.speed, "1/s"),
        (
            Message("rule-servo-sensitivity"),
            impulse * swing / omega_v,
            servo_sensitivity(axis, average),
            "s^3",
        ),
        (Message("rule-unknown-mass"), abs(symbol("m_ff") - m) / m, axis.servo.missing, "1"),
        (Message("rule-payload-sensitivity"), eps * Tn / (omega_v * Kv), axis.servo.drag, "s^3"),
    ]
    seen = Root(1 + m * abs(c) * call("min", 1, omega_v / omega))
    share = call("R", f * T_F) / (omega * T_F) if average else Message("rule-no-average")
    for mode in axis.modes:
        name, passed = mode.name, passed_by_average(mode, average)
        lines += [
            (Message("rule-mode-lowest", mode=name), f * (1 - s) / seen, mode.low_hz, "Hz"),
            (
                Message("rule-mode-sensitivity", mode=name),
                m * abs(g) / omega**3,
                mode.jerk_sensitivity,
                "s^3",
            ),
            (Message("rule-mode-passed", mode=name), share, passed, "1"),
        ]
    total = Root(C_S**2 + C_P**2 + Sum((2 * n * C * W) ** 2))
    by_band = symbol("band") / (1.25 * total)
    if axis.controller.jerk_feedforward:
        by_band = call("min", by_band, F / (2 * m * T))
    force, bound = Message("rule-see-formula"), Message("rule-bound-by", what=found.bound_by)
    lines += [
        (Message("rule-allowed-jerk"), by_band, found.allowed_jerk, "m/s^3"),
        (Message("rule-force-acceleration"), force, found.by_force, "m/s^2"),
        (Message("rule-acceleration"), bound, limits.acceleration, "m/s^2"),
        (Message("rule-jerk-time"), call("max", a / j, T_p), limits.jerk_time, "s"),
        (Message("rule-jerk"), a / t_j, limits.jerk, "m/s^3"),
        (Message("rule-residual"), j * total, found.residual_deviation, "m"),
    ]
    return tuple(
        RuleStep(name=name, formula=formula, value=value, unit=unit)
        for name, formula, value, unit in lines
    )
