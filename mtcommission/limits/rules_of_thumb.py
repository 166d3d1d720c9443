"""The makers' and textbooks' rules of thumb for acceleration and jerk, for comparison.

None of them is a recommendation of this tool: each is entered as its source states it, runs
through the same simulation, and is judged by the same requirements.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.rigid_body import peak_velocity
from mtcommission.plant.plant import Plant, PlantMode, dominant_mode
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleOfThumb:
    """One rule, applied to a machine.

    Parameters
    ----------
    name
        Short, for the table.
    source
        Who says so.
    limits
        What it gives here.
    """

    name: str
    source: str
    limits: MotionLimits


def apply_rules_of_thumb(machine: Machine, plant: Plant) -> tuple[RuleOfThumb, ...]:
    """Return the rules of thumb applied to a machine.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.

    Returns
    -------
    tuple of RuleOfThumb

    Source: the makers' manuals named in each rule; Biagiotti & Melchiorri 2008 for j = a f.
    """
    a = machine.drive.motion_force / moving_mass(machine)
    mode = dominant_mode(plant)
    f, omega = mode.frequency_hz, mode.natural_frequency
    stiff = min(a, machine.requirements.tcp_deviation * omega**2)
    rules = [
        RuleOfThumb(
            name="a = F_max/m, no jerk limit",
            source="naive",
            limits=without_jerk_limit(machine, a),
        ),
        _ramp_of_periods(mode, a, periods=1),
        RuleOfThumb(
            name="a = e ω², j = a f",
            source="static deflection within the band (textbook)",
            limits=_with_jerk_time(stiff, 1.0 / f),
        ),
        RuleOfThumb(
            name="j = 10 a",
            source="grblHAL; lower end of LinuxCNC",
            limits=_with_jerk_time(a, 0.1),
        ),
        RuleOfThumb(
            name="j = 100 a",
            source="upper end of LinuxCNC",
            limits=_with_jerk_time(a, 0.01),
        ),
    ]
    velocity = max(peak_velocity(move, a) for move in machine.moves)
    if isfinite(velocity):
        rules.append(
            RuleOfThumb(
                name="j = a²/v_max",
                source="HEIDENHAIN, MANUALplus 620: least axPathJerk",
                limits=MotionLimits(acceleration=a, jerk=a**2 / velocity),
            )
        )
    return tuple(rules)


SLOWER_RAMPS = (2, 3)
"""Periods of the dominant mode that a ramp may take besides one."""


def apply_slower_ramps(machine: Machine, plant: Plant) -> tuple[RuleOfThumb, ...]:
    """Return j = a f / k, the later zeros of the vibration, applied to a machine.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.

    Returns
    -------
    tuple of RuleOfThumb
        With a = F_max/m, one for each of ``SLOWER_RAMPS``.

    Source: Biagiotti & Melchiorri 2008, as j = a f.
    """
    a = machine.drive.motion_force / moving_mass(machine)
    mode = dominant_mode(plant)
    return tuple(_ramp_of_periods(mode, a, periods=k) for k in SLOWER_RAMPS)


def _ramp_of_periods(mode: PlantMode, a: float, *, periods: int) -> RuleOfThumb:
    """Return j = a f / k: a ramp of k periods of a mode."""
    f = mode.frequency_hz
    formula = "j = a f" if periods == 1 else f"j = a f / {periods}"
    return RuleOfThumb(
        name=f"{formula} ({mode.name}, {f:.3g} Hz)",
        source="zero residual vibration of an undamped mode (Biagiotti & Melchiorri)",
        limits=_with_jerk_time(a, periods / f),
    )


def _with_jerk_time(acceleration: float, jerk_time: float) -> MotionLimits:
    return MotionLimits(acceleration=acceleration, jerk=acceleration / jerk_time)
