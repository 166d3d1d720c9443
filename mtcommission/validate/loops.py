"""Rows of secs. 3 and 7: the feedback loop, and the conclusions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log
from typing import Any

import numpy as np

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.condense import condense
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import sample_trajectory
from mtcommission.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.loops import settle_on_loop
from mtcommission.study.optimum import ComparedControl, compare_controls
from mtcommission.validate.paper import MECHANICS, Array, Cases
from mtcommission.validate.row import Row, claim

MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Loop:
    """The loop of a machine, tuned, and the setpoints of sec. 3 in it."""

    frequencies: Array  # Natural frequencies of base and tower [Hz]
    damping: Array  # Damping ratios of base and tower in the closed loop, shape (2,)
    limits: MotionLimits  # Recommended acceleration and jerk
    rectangular: ComparedControl  # F_max/m without jerk limit
    trapezoidal: ComparedControl  # The recommended limits
    others: tuple[ComparedControl, ...]  # Further limits


def solve_loop(machine: Machine, others: Sequence[MotionLimits] = ()) -> Loop:
    """Return the loop of a machine with its setpoints."""
    plant, tuned = build_plant(machine), settle_on_loop(machine).tuned
    chosen = choose_limits(machine, plant, tuned).limits
    compared = [
        compare_controls(machine, tuned, machine.moves[0], limits=limits, optima=())
        for limits in (chosen, *others)
    ]
    return Loop(
        frequencies=np.array([mode.natural_frequency / (2.0 * np.pi) for mode in plant.modes]),
        damping=tuned.nominal.mode_damping,
        limits=chosen,
        rectangular=compared[0][0],
        trapezoidal=compared[0][1],
        others=tuple(pair[1] for pair in compared[1:]),
    )


def with_frequencies(machine: Machine, *, base: float = 1.0, tower: float = 1.0) -> Machine:
    """Return the machine with its eigenfrequencies times these factors, damping ratios kept."""
    mechanics = replace(
        MECHANICS,
        base_stiffness=base**2 * MECHANICS.base_stiffness,
        base_damping=base * MECHANICS.base_damping,
        rotary_stiffness=tower**2 * MECHANICS.rotary_stiffness,
        rotary_damping=tower * MECHANICS.rotary_damping,
    )
    return replace(machine, mechanics=mechanics)


def loop_rows(cases: Cases) -> tuple[list[Row], list[Row]]:
    """Return the claims of sec. 3 on feedback control, and the conclusions of sec. 7."""
    machine, plant = cases.machine, cases.plant
    hints = [
        condense(
            machine.moves[0],
            sample_trajectory(plant, optimum.arcs, step=optimum.t_f / 500),
            velocity=plant.velocity,
        )
        for optimum in (cases.time, cases.bounded, cases.damping)
    ]
    loop = solve_loop(machine, hints)
    sensed = replace(machine, control=replace(machine.control, tcp_sensor=TcpSensor.POSITION))
    feedback = [
        _active_damping(cases, loop, solve_loop(sensed)),
        _overshoot(loop),
        _transfer_time(cases, loop),
        _smoothness(cases, loop),
        _frequency(machine, loop),
    ]
    return feedback, [_damping_by_bounds(cases), _hints(loop, hints)]


def _describe(limits: MotionLimits) -> Message:
    return Message("paper-limits", acceleration=limits.acceleration, jerk=limits.jerk)


def _active_damping(cases: Cases, loop: Loop, sensed: Loop) -> Row:
    own = np.array([mode.damping_ratio for mode in cases.plant.modes])
    times = [loop.rectangular.transfer_time, sensed.rectangular.transfer_time]
    return claim(
        "3",
        "active-damping",
        "possible with sensors quite near to the TCP, but the achievable damping is not sufficient",
        holds=bool(min(sensed.damping / own) > 1.0) and min(times) > MUCH_LARGER * cases.time.t_f,
        base=float(own[0]),
        tower=float(own[1]),
        base_encoder=float(loop.damping[0]),
        tower_encoder=float(loop.damping[1]),
        base_sensed=float(sensed.damping[0]),
        tower_sensed=float(sensed.damping[1]),
        encoder=times[0],
        sensed=times[1],
    )


def _overshoot(loop: Loop) -> Row:
    rough, smooth = loop.rectangular.overshoot, loop.trapezoidal.overshoot
    typical = [control.overshoot for control in loop.others]
    return claim(
        "3, (i)",
        "overshoot",
        "the terminal position is not attained precisely: overshooting",
        holds=min(rough, *typical) > 0.01,  # what a plot shows
        rough=rough,
        least=min(typical),
        most=max(typical),
        smooth=smooth,
    )


def _transfer_time(cases: Cases, loop: Loop) -> Row:
    least = cases.time.t_f
    times = [loop.trapezoidal.transfer_time, loop.rectangular.transfer_time]
    return claim(
        "3, (ii)",
        "transfer-time",
        "much larger than the minimal transfer time",
        holds=min(times) > MUCH_LARGER * least,
        refuted=min(times) <= MUCH_LARGER * least,
        smooth=times[0],
        rough=times[1],
        smooth_share=times[0] / least,
        rough_share=times[1] / least,
        least=least,
        much=MUCH_LARGER,
    )


def _smoothness(cases: Cases, loop: Loop) -> Row:
    index = cases.plant.signals.index("v_phi")
    rough, smooth = (float(x.peaks[index]) for x in (loop.rectangular, loop.trapezoidal))
    faster = loop.trapezoidal.transfer_time < loop.rectangular.transfer_time
    return claim(
        "3",
        "jerk-control",
        "optimum productivity with suitable damping for significant jerk control",
        holds=faster and smooth < rough,
        pays="yes" if faster else "no",
        limits=_describe(loop.limits),
        smooth=smooth,
        rough=rough,
    )


def _frequency(machine: Machine, loop: Loop) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    told: dict[str, Any] = {}
    jerks = []
    for i, name in enumerate(("base", "tower")):
        soft, stiff = (with_frequencies(machine, **{name: factor}) for factor in (0.8, 1.25))
        loops = (solve_loop(soft), loop, solve_loop(stiff))
        jerks.append([each.limits.jerk for each in loops])
        for each, at in zip(loops, ("_soft", "", "_stiff"), strict=True):
            told[f"{name}{at}"] = float(each.frequencies[i])
            told[f"j_{name}{at}"] = each.limits.jerk
    growth = [log(max(each) / min(each)) for each in jerks]
    leading = jerks[int(np.argmax(growth))]
    return claim(
        "3",
        "jerk-follows",
        "the eigenfrequency of the dominating mode; no commissioning rules up to now",
        holds=leading == sorted(leading) and max(growth) > 2.0 * min(growth),
        **told,
    )


def _damping_by_bounds(cases: Cases) -> Row:
    free, bounded = (cases.peak(best, "v_phi") for best in (cases.time, cases.bounded))
    return claim(
        "7",
        "bounds-damp",
        "significantly improved by suitable state constraints",
        holds=bounded < 0.5 * free,
        less=1.0 - bounded / free,
        longer=cases.bounded.t_f / cases.time.t_f - 1.0,
    )


def _hints(loop: Loop, hints: Sequence[MotionLimits]) -> Row:
    least = min(limits.jerk for limits in hints)
    soonest = min(control.transfer_time for control in loop.others)
    better = loop.trapezoidal.transfer_time < soonest
    return claim(
        "7",
        "hints",
        "concrete hints for suitable jerk limitations",
        holds=not better,
        refuted=better and loop.limits.jerk < least,
        free=hints[0].jerk,
        bounded=hints[1].jerk,
        damped=hints[2].jerk,
        soonest=soonest,
        limits=_describe(loop.limits),
        settling=loop.trapezoidal.transfer_time,
    )
