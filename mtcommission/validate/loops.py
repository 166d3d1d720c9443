"""Rows of secs. 3 and 7: the feedback loop, and the conclusions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.condense import condense
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine
from mtcommission.optimal.solution import sample_trajectory
from mtcommission.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.loops import settle_on_loop
from mtcommission.study.optimum import ComparedControl, compare_controls
from mtcommission.validate.paper import MECHANICS, Array, Cases
from mtcommission.validate.row import Row, claim

MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""
LOOP_BASIS = "our loop"


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


def _describe(limits: MotionLimits) -> str:
    return f"a = {limits.acceleration:.3g} m/s², j = {limits.jerk:.3g} m/s³"


def _active_damping(cases: Cases, loop: Loop, sensed: Loop) -> Row:
    own = np.array([mode.damping_ratio for mode in cases.plant.modes])
    ratios = [f"{a:.2g}, {b:.2g}" for a, b in (own, loop.damping, sensed.damping)]
    times = [loop.rectangular.transfer_time, sensed.rectangular.transfer_time]
    return claim(
        "sec. 3",
        "structural vibration damped by feedback",
        "possible with sensors quite near to the TCP, but the achievable damping is not sufficient",
        f"damping ratios of base and tower: {ratios[0]} without feedback, {ratios[1]} with "
        f"the encoder alone, {ratios[2]} with a second one near the tool; without jerk limit "
        f"settled within 5 µm after {1e3 * times[0]:.0f} and {1e3 * times[1]:.0f} ms",
        basis=LOOP_BASIS,
        holds=bool(min(sensed.damping / own) > 1.0) and min(times) > MUCH_LARGER * cases.time.t_f,
        reason="The loop is ours, since Fig. 2 has no numbers. The encoder alone cannot see the "
        "tower: base and tower do not couple. A second one lets the loop damp it, and still "
        "it is the setpoint that decides how soon the axis settles.",
    )


def _overshoot(loop: Loop) -> Row:
    rough, smooth = loop.rectangular.overshoot, loop.trapezoidal.overshoot
    typical = [control.overshoot for control in loop.others]
    return claim(
        "sec. 3, (i)",
        "terminal overshoot under feedback",
        "the terminal position is not attained precisely: overshooting",
        f"tool velocity overshoots by {100.0 * rough:.1f} % (rectangular), "
        f"{100.0 * min(typical):.1f} to {100.0 * max(typical):.1f} % (trapezoids as short as "
        f"the optima), {100.0 * smooth:.1f} % (trapezoid chosen for the loop)",
        basis=LOOP_BASIS,
        holds=min(rough, *typical) > 0.01,  # what a plot shows
        reason="It depends on the jerk: limits chosen for the loop avoid it almost entirely.",
    )


def _transfer_time(cases: Cases, loop: Loop) -> Row:
    least = cases.time.t_f
    times = [loop.trapezoidal.transfer_time, loop.rectangular.transfer_time]
    return claim(
        "sec. 3, (ii)",
        "transfer time under feedback",
        "much larger than the minimal transfer time",
        f"settled within 5 µm after {1e3 * times[0]:.1f} ms (trapezoid chosen for the loop) "
        f"to {1e3 * times[1]:.1f} ms (rectangular): {times[0] / least:.1f} to "
        f"{times[1] / least:.1f} times {1e3 * least:.2f} ms",
        basis=LOOP_BASIS,
        holds=min(times) > MUCH_LARGER * least,
        refuted=min(times) <= MUCH_LARGER * least,
        reason=f"Counted as much larger: {MUCH_LARGER:g} times. How far a loop comes down depends "
        "on its tuning, of which the paper says nothing.",
    )


def _smoothness(cases: Cases, loop: Loop) -> Row:
    index = cases.plant.signals.index("v_phi")
    rough, smooth = (float(x.peaks[index]) for x in (loop.rectangular, loop.trapezoidal))
    faster = loop.trapezoidal.transfer_time < loop.rectangular.transfer_time
    return claim(
        "sec. 3",
        "productivity with damping asks for jerk control",
        "optimum productivity with suitable damping for significant jerk control",
        f"{_describe(loop.limits)}: peak |v_phi| {1e3 * smooth:.1f} instead of "
        f"{1e3 * rough:.1f} mrad/s without jerk limit, and settled sooner"
        if faster
        else "the jerk limit does not pay",
        basis=LOOP_BASIS,
        holds=faster and smooth < rough,
    )


def _frequency(machine: Machine, loop: Loop) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    told, jerks = [], []
    for i, name in enumerate(("base", "tower")):
        soft, stiff = (with_frequencies(machine, **{name: factor}) for factor in (0.8, 1.25))
        loops = (solve_loop(soft), loop, solve_loop(stiff))
        jerks.append([each.limits.jerk for each in loops])
        hertz = ", ".join(f"{each.frequencies[i]:.1f}" for each in loops)
        told.append(f"{name} at {hertz} Hz: j = {', '.join(f'{j:.1f}' for j in jerks[-1])} m/s³")
    growth = [log(max(each) / min(each)) for each in jerks]
    leading = jerks[int(np.argmax(growth))]
    return claim(
        "sec. 3",
        "what the possible jerk depends on",
        "the eigenfrequency of the dominating mode; no commissioning rules up to now",
        "; ".join(told),
        basis=f"limits chosen anew for each machine; {LOOP_BASIS}",
        holds=leading == sorted(leading) and max(growth) > 2.0 * min(growth),
        reason="Here the base dominates, the mode that the encoder sees. A rule is "
        "derived in docs/commissioning-rule.md and printed on the sheet.",
    )


def _damping_by_bounds(cases: Cases) -> Row:
    free, bounded = (cases.peak(best, "v_phi") for best in (cases.time, cases.bounded))
    return claim(
        "sec. 7",
        "state constraints improve the damping",
        "significantly improved by suitable state constraints",
        f"peak |v_phi| {100.0 * (1.0 - bounded / free):.0f} % lower for "
        f"{100.0 * (cases.bounded.t_f / cases.time.t_f - 1.0):.0f} % more time",
        basis="the two certified controls",
        holds=bounded < 0.5 * free,
    )


def _hints(loop: Loop, hints: Sequence[MotionLimits]) -> Row:
    least = min(limits.jerk for limits in hints)
    soonest = min(control.transfer_time for control in loop.others)
    better = loop.trapezoidal.transfer_time < soonest
    return claim(
        "sec. 7",
        "optimal controls give hints for the jerk limit",
        "concrete hints for suitable jerk limitations",
        f"profiles closest to the optima have j = {', '.join(f'{x.jerk:.0f}' for x in hints)} "
        f"m/s³ and settle in the loop after {1e3 * soonest:.0f} ms at best; "
        f"{_describe(loop.limits)} after {1e3 * loop.trapezoidal.transfer_time:.0f} ms",
        basis=LOOP_BASIS,
        holds=not better,
        refuted=better and loop.limits.jerk < least,
        reason="An optimal force cancels vibration by its switches, which no jerk-limited profile "
        "has. So the hints are bounds from above and starting points; the limits themselves "
        "have to be searched with the loop closed.",
    )
