"""The makers' and textbooks' rules of thumb for acceleration and jerk, for comparison.

None of them is a recommendation of this tool: each is entered as its source states it, runs
through the same simulation, and is judged by the same requirements.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import peak_velocity
from mtcommission.machine.plant.plant import Plant, dominant_mode
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleOfThumb:
    """One rule, applied to a machine."""

    name: Message  # short, for the table
    source: Message  # who says so
    limits: MotionLimits  # what it gives here


def apply_rules_of_thumb(machine: Machine, plant: Plant) -> tuple[RuleOfThumb, ...]:
    """Return the rules of thumb applied to the nominal machine.

    Source: the makers' manuals named in each rule; Biagiotti & Melchiorri 2008 for j = a f.
    """
    a = machine.drive.motion_force / moving_mass(machine)
    mode = dominant_mode(plant)
    f, omega = mode.frequency_hz, mode.natural_frequency
    stiff = min(a, machine.requirements.tcp_deviation * omega**2)
    rules = [
        _rule("no-jerk-limit", "naive", without_jerk_limit(machine, a)),
        _rule("period", "zero-vibration", _with_jerk_time(a, 1.0 / f), mode=mode.name, frequency=f),
        _rule("stiffness", "static-deflection", _with_jerk_time(stiff, 1.0 / f)),
        _rule("ten", "grblhal", _with_jerk_time(a, 0.1)),
        _rule("hundred", "linuxcnc", _with_jerk_time(a, 0.01)),
    ]
    velocity = max(peak_velocity(move, a) for move in machine.moves)
    if isfinite(velocity):
        limits = MotionLimits(acceleration=a, jerk=a**2 / velocity)
        rules.append(_rule("velocity", "heidenhain", limits))
    return tuple(rules)


def _rule(name: str, source: str, limits: MotionLimits, **values: float | str) -> RuleOfThumb:
    return RuleOfThumb(
        name=Message(f"rule-of-thumb-{name}", **values),
        source=Message(f"source-{source}"),
        limits=limits,
    )


def _with_jerk_time(acceleration: float, jerk_time: float) -> MotionLimits:
    return MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
