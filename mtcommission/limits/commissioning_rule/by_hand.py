"""The commissioning rule on paper: its formulas, and the calculation step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from mtcommission.limits.commissioning_rule.estimate import (
    AxisEstimate,
    force_acceleration,
    servo_parts,
    vibrations,
)
from mtcommission.loop.model.controller import Controller
from mtcommission.machine.machine import Machine, Move, VelocityStep
from mtcommission.messages.formula import Expression, Relation, Root, Sum, call, symbol
from mtcommission.messages.message import Message
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleFormula:
    """One of the rule's formulas.

    Parameters
    ----------
    tree
        The formula.
    aside
        Where it holds; None: everywhere.
    """

    tree: Relation
    aside: Message | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleStep:
    """One line of the hand calculation.

    Parameters
    ----------
    name
        What is computed.
    formula
        How.
    value
        Result.
    unit
        SI unit of the result.
    """

    name: Message
    formula: Expression | Message
    value: float
    unit: str


def _formulas(*names: str) -> tuple[Expression, ...]:
    return tuple(symbol(name) for name in names)


a, j, t_j, m, F, v, L, Kp, Kv, Tn, T, T_p = _formulas(
    "a", "j", "t_j", "m", "F", "v", "L", "Kp", "Kv", "Tn", "T", "T_p"
)
f, g, c, i, x, C, V, omega, omega_v, zeta, eps, pi = _formulas(
    "f", "g", "c", "i", "x", "C", "V", "omega", "omega_v", "zeta", "eps", "pi"
)
C_S, C_P, C_i, V_i, g_i, c_i, omega_i = _formulas(
    "C_S", "C_P", "C_i", "V_i", "g_i", "c_i", "omega_i"
)

ECHO = call("R", f * t_j) * (1 + call("exp", -(omega * zeta * v / a)))
"""Vibration of a mode after a velocity step, whose two ramps are v/a apart."""

ECHO_OF_FOUR = ECHO * (1 + call("exp", -(omega * zeta * L / v)))
"""The same after positioning, whose velocity changes are L/v apart."""

RESIDUAL = (1.25 * j * Root(C_S**2 + C_P**2 + Sum((C_i * V_i) ** 2))).at_most(symbol("band"))
FORCE = (
    a * (1.17 * m + Kp * (T_p / 2 + Sum(m * c_i / omega_i * call("min", 1, 2 / (omega_i * t_j)))))
).at_most(F)
RAMP = call("R", x).equals(abs(1 - call("exp", 2 * pi * x * (i - zeta))))


def formulas_for(moves: Sequence[Move]) -> tuple[RuleFormula, ...]:
    """Return the rule's formulas for some moves.

    Parameters
    ----------
    moves
        Velocity steps, positioning moves, or both.

    Returns
    -------
    tuple of RuleFormula
        With the echo of four ramps and the distance where there is a positioning move.
    """
    positions = not all(isinstance(move, VelocityStep) for move in moves)
    for_step, for_positioning = Message("rule-for-velocity-step"), Message("rule-for-positioning")
    found: list[tuple[Relation, Message | None]] = [
        (RESIDUAL, None),
        (C_i.equals(m * abs(g_i) / omega_i**3), None),
        (V.equals(ECHO), for_step if positions else None),
        (RAMP, Message("rule-within-the-spread")),
        (FORCE, None),
        ((v / a).at_least(t_j), None),
        (j.equals(a / t_j), None),
    ]
    if positions:
        found.insert(3, (V.equals(ECHO_OF_FOUR), for_positioning))
        found.insert(-1, (L.at_least(2 * a * t_j**2), for_positioning))
    return tuple(RuleFormula(tree=tree, aside=aside) for tree, aside in found)


def calculate_by_hand(
    axis: AxisEstimate, limits: MotionLimits, *, ramp: Message, bound_by: Message, residual: float
) -> tuple[RuleStep, ...]:
    """Return the calculation of the limits that the rule gives, in order.

    Parameters
    ----------
    axis
        The axis.
    limits
        What the rule gives.
    ramp, bound_by
        Where the jerk time comes from, and what bounds the acceleration.
    residual
        Predicted residual deviation [m].

    Returns
    -------
    tuple of RuleStep
    """
    controller = axis.controller
    transient, drag = servo_parts(axis, limits.jerk_time)
    by_force = force_acceleration(axis, limits.jerk_time)
    impulse = call("max", 0.4 * T**2, 0.18 * T_p**2) + 0.8 * Sum(m * c / omega**2)
    pushed = call("min", Tn / (omega_v * Kv), 1.3 * t_j / (omega_v * (Kv + 1 / Tn)))
    lines: list[tuple[Message, Expression | Message, float, str]] = [
        (
            Message("rule-speed-loop"),
            Kp / m,
            controller.velocity_gain / controller.feedforward_mass,
            "1/s",
        ),
        (
            Message("rule-servo-sensitivity"),
            impulse * call("min", 1.5 / omega_v, t_j),
            transient,
            "s^3",
        ),
        (
            Message("rule-unknown-mass"),
            abs(symbol("m_ff") - m) / m,
            axis.servo.missing,
            "1",
        ),
        (Message("rule-payload-sensitivity"), eps * pushed, drag, "s^3"),
    ]
    left = vibrations(axis, limits.jerk_time, largest=by_force)
    for mode, vibration in zip(axis.modes, left, strict=True):
        name, sensitivity = mode.name, mode.jerk_sensitivity
        how = m * abs(g) / omega**3
        lines.append((Message("rule-mode-sensitivity", mode=name), how, sensitivity, "s^3"))
        widened = mode.spread - axis.machine.requirements.frequency_spread
        if widened > 0.0:
            how = m * abs(c) * call("min", 1, omega_v / omega)
            lines.append((Message("rule-mode-spread", mode=name), how, widened, "1"))
        share = vibration / sensitivity if sensitivity else 0.0
        echo = Message("rule-vibration-formula")
        lines.append((Message("rule-mode-vibration", mode=name), echo, share, "1"))
    bound = Message("rule-bound-by", what=bound_by)
    total = j * Root(C_S**2 + C_P**2 + Sum((C * V) ** 2))
    lines += [
        (Message("rule-jerk-time"), ramp, limits.jerk_time, "s"),
        (Message("rule-force-acceleration"), Message("rule-see-formula"), by_force, "m/s^2"),
        (Message("rule-acceleration"), bound, limits.acceleration, "m/s^2"),
        (Message("rule-jerk"), a / t_j, limits.jerk, "m/s^3"),
        (Message("rule-residual"), total, residual, "m"),
    ]
    return tuple(
        RuleStep(name=name, formula=formula, value=value, unit=unit)
        for name, formula, value, unit in lines
    )


def warn_outside_validity(machine: Machine, controller: Controller) -> tuple[Message, ...]:
    """Return why the rule may not hold for a machine; empty inside its range of validity."""
    needs, found = machine.requirements, []
    if controller.velocity_feedforward != 1.0:
        found.append(Message("rule-needs-velocity-feedforward"))
    if machine.control.reference_delay is not None:
        found.append(Message("rule-needs-automatic-delay"))
    if machine.control.moving_average_time > 0.0:
        found.append(Message("rule-knows-no-setpoint-filter"))
    if needs.peaks or machine.drive.continuous_force < inf:
        found.append(Message("rule-knows-no-peaks"))
    return tuple(found)
