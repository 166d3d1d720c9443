"""Rows of secs. 3 and 7: the feedback loop, and the conclusions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from mtcommission.base.messages.message import Message, Value
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.optima import condense
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.control import sample_trajectory
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_within
from mtcommission.study.loops import settle_on_loop
from mtcommission.validate.cases import Array, Cases
from mtcommission.validate.paper import Row, claim

MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ridden:
    """A velocity step with some limits, in the loop of the nominal machine."""

    transfer_time: float  # settling time [s]
    overshoot: float  # of the tool's velocity over its target, relative to it [-]
    peaks: Array  # largest magnitude of each of ``Plant.signals``


def _ride(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> Ridden:
    (loop, *_), (move, *_) = tuned.loops, machine.moves
    assert isinstance(move, VelocityStep)
    setpoint, band = plan_within(machine, limits)(move), machine.requirements.tcp_deviation
    found = simulate(loop, setpoint, drive=machine.drive, band=band)
    reached = float(np.max(found.states @ (loop.plant.row("tcp") @ loop.plant.A)))
    return Ridden(
        transfer_time=found.settling_time,
        overshoot=max(reached / move.velocity_step - 1.0, 0.0),
        peaks=found.peaks,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Loop:
    """The loop of a machine, tuned, and the setpoints of sec. 3 in it."""

    frequencies: Array  # Natural frequencies of base and tower [Hz]
    damping: Array  # Damping ratios of base and tower in the closed loop, shape (2,)
    limits: MotionLimits  # Recommended acceleration and jerk
    rectangular: Ridden  # F_max/m without jerk limit
    trapezoidal: Ridden  # The recommended limits
    others: tuple[Ridden, ...]  # Further limits


def solve_loop(machine: Machine, others: Sequence[MotionLimits] = ()) -> Loop:
    """Return the loop of a machine with its setpoints."""
    plant, tuned = build_plant(machine), settle_on_loop(machine).tuned
    chosen = choose_limits(machine, tuned).limits
    rectangular = without_jerk_limit(machine, machine.drive.motion_force / plant.moving_mass)
    return Loop(
        frequencies=np.array([mode.natural_frequency / (2.0 * np.pi) for mode in plant.modes]),
        damping=tuned.nominal.mode_damping,
        limits=chosen,
        rectangular=_ride(machine, tuned, rectangular),
        trapezoidal=_ride(machine, tuned, chosen),
        others=tuple(_ride(machine, tuned, limits) for limits in others),
    )


def loop_rows(cases: Cases) -> tuple[list[Row], list[Row]]:
    """Return the claims of sec. 3 on feedback control, and the conclusions of sec. 7."""
    machine, plant = cases.machine, cases.plant
    motions = [
        sample_trajectory(plant, optimum.arcs, step=optimum.t_f / 500)
        for optimum in (cases.time, cases.bounded, cases.damping)
    ]
    move = machine.moves[0]
    hints = [condense(move, motion, velocity=plant.velocity) for motion in motions]
    loop = solve_loop(machine, hints)
    sensed = replace(machine, control=replace(machine.control, has_tcp_sensor=True))
    feedback = [
        _active_damping(cases, loop, solve_loop(sensed)),
        *_setpoints(cases, loop),
        _frequency(cases, loop),
    ]
    free, bounded = (cases.peak(best.peaks, "v_phi") for best in (cases.time, cases.bounded))
    longer = cases.bounded.t_f / cases.time.t_f - 1.0
    damped = claim(
        "bounds-damp", {"less": 1.0 - bounded / free, "longer": longer}, holds=bounded < 0.5 * free
    )
    return feedback, [damped, _hints(loop, hints)]


def _describe(limits: MotionLimits) -> Message:
    return Message("paper-limits", acceleration=limits.acceleration, jerk=limits.jerk)


def _active_damping(cases: Cases, loop: Loop, sensed: Loop) -> Row:
    own = np.array([mode.damping_ratio for mode in cases.plant.modes])
    times = {"encoder": loop.rectangular.transfer_time, "sensed": sensed.rectangular.transfer_time}
    ratios: dict[str, Value] = {}
    for suffix, damping in (("", own), ("_encoder", loop.damping), ("_sensed", sensed.damping)):
        ratios |= {f"base{suffix}": float(damping[0]), f"tower{suffix}": float(damping[1])}
    is_slow = min(times.values()) > MUCH_LARGER * cases.time.t_f
    return claim(
        "active-damping",
        {**ratios, **times},
        holds=bool(min(sensed.damping / own) > 1.0) and is_slow,
    )


def _setpoints(cases: Cases, loop: Loop) -> list[Row]:
    """Judge what sec. 3 says of rectangular and trapezoidal accelerations."""
    rough, smooth, least = loop.rectangular, loop.trapezoidal, cases.time.t_f
    typical = [control.overshoot for control in loop.others]
    over = {"rough": rough.overshoot, "smooth": smooth.overshoot}
    times = {"smooth": smooth.transfer_time, "rough": rough.transfer_time}
    shares = {f"{name}_share": time / least for name, time in times.items()}
    is_much = min(times.values()) > MUCH_LARGER * least
    rates = {
        name: cases.peak(x.peaks, "v_phi") for name, x in (("smooth", smooth), ("rough", rough))
    }
    pays = smooth.transfer_time < rough.transfer_time
    return [
        claim(
            "overshoot",
            {**over, "least": min(typical), "most": max(typical)},
            holds=min(rough.overshoot, *typical) > 0.01,
        ),
        claim(
            "transfer-time",
            {**times, **shares, "least": least, "much": MUCH_LARGER},
            holds=is_much,
            refuted=not is_much,
        ),
        claim(
            "jerk-control",
            {"pays": "yes" if pays else "no", "limits": _describe(loop.limits), **rates},
            holds=pays and rates["smooth"] < rates["rough"],
        ),
    ]


def _frequency(cases: Cases, loop: Loop) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    told: dict[str, Value] = {}
    jerks = []
    for i, name in enumerate(("base", "tower")):
        soft, stiff = (solve_loop(_with_frequencies(cases, **{name: f})) for f in (0.8, 1.25))
        loops = {f"{name}_soft": soft, name: loop, f"{name}_stiff": stiff}
        jerks.append([each.limits.jerk for each in loops.values()])
        told |= {at: float(each.frequencies[i]) for at, each in loops.items()}
        told |= {f"j_{at}": each.limits.jerk for at, each in loops.items()}
    growth = [log(max(each) / min(each)) for each in jerks]
    leading = jerks[int(np.argmax(growth))]
    return claim(
        "jerk-follows", told, holds=leading == sorted(leading) and max(growth) > 2.0 * min(growth)
    )


def _with_frequencies(cases: Cases, *, base: float = 1.0, tower: float = 1.0) -> Machine:
    """Return the machine with its eigenfrequencies times these factors, damping ratios kept."""
    mechanics = replace(
        cases.mechanics,
        base_stiffness=base**2 * cases.mechanics.base_stiffness,
        base_damping=base * cases.mechanics.base_damping,
        rotary_stiffness=tower**2 * cases.mechanics.rotary_stiffness,
        rotary_damping=tower * cases.mechanics.rotary_damping,
    )
    return replace(cases.machine, mechanics=mechanics)


def _hints(loop: Loop, hints: Sequence[MotionLimits]) -> Row:
    free, bounded, damped = (limits.jerk for limits in hints)
    soonest = min(control.transfer_time for control in loop.others)
    settling = loop.trapezoidal.transfer_time
    jerks = {"free": free, "bounded": bounded, "damped": damped}
    return claim(
        "hints",
        {**jerks, "soonest": soonest, "limits": _describe(loop.limits), "settling": settling},
        holds=settling >= soonest,
        refuted=settling < soonest and loop.limits.jerk < min(jerks.values()),
    )
