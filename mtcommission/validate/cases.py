"""The paper's problems, solved once for all rows and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mtcommission.choose import choose_limits
from mtcommission.comparison import ComparedControl, compare_controls
from mtcommission.limits import MotionLimits, condense
from mtcommission.loop.response import LoopResponse, simulate
from mtcommission.loop_choice import Settings, settle_on_loop
from mtcommission.machine import Machine, Weight
from mtcommission.optimal.constrained import solve_bounded_time_optimal
from mtcommission.optimal.damping_optimal import solve_damping_optimal
from mtcommission.optimal.solution import (
    Arc,
    Bound,
    DampingOptimum,
    TimeOptimum,
    sample_trajectory,
)
from mtcommission.optimal.time_optimal import solve_time_optimal
from mtcommission.optimal.weights import balanced_weights
from mtcommission.plant import Plant, build_plant
from mtcommission.rules import without_jerk_limit
from mtcommission.setpoint import plan_setpoint
from mtcommission.validate.paper import (
    BOUNDED_T_F,
    FORCE_LIMIT,
    RATE_BOUND,
    WEIGHTS,
    paper_machine,
)

Progress = Callable[[str], None]

CONDENSING_SAMPLES = 500
"""Samples of an optimum for the jerk-limited profile closest to it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopCase:
    """A setpoint of sec. 3 in the feedback loop.

    Parameters
    ----------
    limits
        Acceleration and jerk of the setpoint.
    response
        What the nominal machine does.
    measured
        The same, measured as the optimal controls are.
    """

    limits: MotionLimits
    response: LoopResponse
    measured: ComparedControl


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cases:
    """Solutions of everything that the paper solves.

    Parameters
    ----------
    machine, plant
        Of Table 1.
    time
        Sec. 5.1.
    bounded
        Sec. 5.2.
    damping
        Sec. 6, with the weights (17).
    balanced
        Our balanced weights.
    rectangular, trapezoidal
        Sec. 3: F_max/m without jerk limit, and our recommended limits.
    condensed
        The jerk-limited profile closest to each optimum, in the loop: time-optimal, bounded,
        damping-optimal.
    """

    machine: Machine
    plant: Plant
    time: TimeOptimum
    bounded: TimeOptimum
    damping: DampingOptimum
    balanced: tuple[Weight, ...]
    rectangular: LoopCase
    trapezoidal: LoopCase
    condensed: tuple[LoopCase, ...]


def solve_cases(progress: Progress = lambda _: None) -> Cases:
    """Return the solutions of the paper's problems.

    Parameters
    ----------
    progress
        Called with the name of each stage as it begins.

    Returns
    -------
    Cases
    """
    machine = paper_machine()
    plant, move = build_plant(machine), machine.moves[0]
    progress("time-optimal control")
    time = solve_time_optimal(plant, move, force_limit=FORCE_LIMIT)
    progress("time-optimal control under the bound on the tower's rate")
    bound = Bound(name="v_phi", value=RATE_BOUND)
    bounded = solve_bounded_time_optimal(plant, move, force_limit=FORCE_LIMIT, bounds=(bound,))
    progress("damping-optimal control")
    damping = solve_damping_optimal(
        plant, move, force_limit=FORCE_LIMIT, t_f=BOUNDED_T_F, weights=WEIGHTS
    )
    progress("feedback loop")
    optima = (time.arcs, bounded.arcs, damping.arcs)
    loops = _loop_cases(machine, plant, optima)
    return Cases(
        machine=machine,
        plant=plant,
        time=time,
        bounded=bounded,
        damping=damping,
        balanced=balanced_weights(plant, time),
        rectangular=loops[0],
        trapezoidal=loops[1],
        condensed=loops[2:],
    )


def _loop_cases(
    machine: Machine, plant: Plant, optima: tuple[tuple[Arc, ...], ...]
) -> tuple[LoopCase, ...]:
    settings, move = Settings(), machine.moves[0]
    tuned = settle_on_loop(machine, plant, settings).tuned
    closest = [
        condense(
            move,
            sample_trajectory(plant, arcs, step=arcs[-1].t_end / CONDENSING_SAMPLES),
            velocity=plant.velocity,
        )
        for arcs in optima
    ]
    chosen = choose_limits(machine, plant, tuned, starts=closest, settings=settings.search)
    a = machine.drive.motion_force / plant.moving_mass
    rectangular = without_jerk_limit(machine, a)
    cases = []
    for limits in (rectangular, chosen.limits, *closest):
        response = simulate(
            tuned.loops[0],
            tuned.lifted[0],
            plan_setpoint(move, limits),
            drive=machine.drive,
            band=machine.requirements.tcp_deviation,
        )
        measured = compare_controls(machine, plant, tuned, move, limits=limits, optima=())[1]
        cases.append(LoopCase(limits=limits, response=response, measured=measured))
    return tuple(cases)
