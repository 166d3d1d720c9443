"""The paper's problems, solved once for all rows and figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.choose import choose_limits
from mtcommission.limits.condense import condense
from mtcommission.loop.simulate import LoopResponse, simulate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.control import TcpSensor
from mtcommission.machine.machine import Machine, Weight
from mtcommission.optimal.bounded.constrained import solve_bounded_time_optimal
from mtcommission.optimal.damping.damping_optimal import solve_damping_optimal
from mtcommission.optimal.damping.weights import balanced_weights
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import (
    Arc,
    Bound,
    DampingOptimum,
    TimeOptimum,
    sample_trajectory,
)
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.study.loops import settle_on_loop
from mtcommission.study.optimum import ComparedControl, compare_controls
from mtcommission.validate.paper import (
    BOUNDED_T_F,
    FORCE_LIMIT,
    MECHANICS,
    RATE_BOUND,
    WEIGHTS,
    paper_machine,
)

Array = NDArray[np.float64]
Progress = Callable[[str], None]

CONDENSING_SAMPLES = 500
"""Samples of an optimum for the jerk-limited profile closest to it."""
FREQUENCY_FACTORS = (0.8, 1.25)
"""By what each eigenfrequency is changed to see what the jerk depends on [-]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopCase:
    """A setpoint of sec. 3 in the feedback loop."""

    limits: MotionLimits  # Acceleration and jerk of the setpoint
    response: LoopResponse  # What the nominal machine does
    measured: ComparedControl  # The same, measured as the optimal controls are


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedLoop:
    """The loop of a machine that differs from Table 1 in one thing, tuned anew."""

    frequencies: Array  # Natural frequencies of base and tower [Hz]
    limits: MotionLimits  # Recommended acceleration and jerk
    damping: Array  # Damping ratios of base and tower in the closed loop, shape (2,)
    rectangular_time: float  # Settling time of the setpoint without jerk limit [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cases:
    """Solutions of everything that the paper solves."""

    # machine, plant: Of Table 1.
    machine: Machine
    plant: Plant
    time: TimeOptimum  # Sec. 5.1.
    bounded: TimeOptimum  # Sec. 5.2.
    damping: DampingOptimum  # Sec. 6, with the weights (17).
    balanced: tuple[Weight, ...]  # Our balanced weights
    # rectangular, trapezoidal: Sec. 3: F_max/m without jerk limit, and our recommended
    # limits.
    rectangular: LoopCase
    trapezoidal: LoopCase
    # The jerk-limited profile closest to each optimum, in the loop: time-optimal, bounded,
    # damping-optimal.
    condensed: tuple[LoopCase, ...]
    as_printed: VariedLoop  # The loop behind ``rectangular`` and ``trapezoidal``
    # softer_base, stiffer_base, softer_tower, stiffer_tower: One eigenfrequency changed by
    # ``FREQUENCY_FACTORS``, its damping ratio kept.
    softer_base: VariedLoop
    stiffer_base: VariedLoop
    softer_tower: VariedLoop
    stiffer_tower: VariedLoop
    sensed: VariedLoop  # With a second encoder near the tool


def solve_cases(progress: Progress = lambda _: None) -> Cases:
    """Return the solutions of the paper's problems."""
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
    loops = _loop_cases(machine, plant, (time.arcs, bounded.arcs, damping.arcs))
    progress("feedback loops of machines with other frequencies and sensors")
    soft, stiff = FREQUENCY_FACTORS
    near_tool = replace(machine, control=replace(machine.control, tcp_sensor=TcpSensor.POSITION))
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
        as_printed=_vary(machine),
        softer_base=_vary(_rescale(machine, base=soft)),
        stiffer_base=_vary(_rescale(machine, base=stiff)),
        softer_tower=_vary(_rescale(machine, tower=soft)),
        stiffer_tower=_vary(_rescale(machine, tower=stiff)),
        sensed=_vary(near_tool),
    )


def _rescale(machine: Machine, *, base: float = 1.0, tower: float = 1.0) -> Machine:
    """Return the machine with its eigenfrequencies times these factors."""
    mechanics = replace(
        MECHANICS,
        base_stiffness=base**2 * MECHANICS.base_stiffness,
        base_damping=base * MECHANICS.base_damping,
        rotary_stiffness=tower**2 * MECHANICS.rotary_stiffness,
        rotary_damping=tower * MECHANICS.rotary_damping,
    )
    return replace(machine, mechanics=mechanics)


def _vary(machine: Machine) -> VariedLoop:
    plant = build_plant(machine)
    tuned = settle_on_loop(machine).tuned
    chosen = choose_limits(machine, plant, tuned)
    rough = without_jerk_limit(machine, machine.drive.motion_force / plant.moving_mass)
    return VariedLoop(
        frequencies=np.array([mode.natural_frequency / (2.0 * np.pi) for mode in plant.modes]),
        limits=chosen.limits,
        damping=tuned.nominal.mode_damping,
        rectangular_time=_respond(machine, tuned, rough).settling_time,
    )


def _loop_cases(
    machine: Machine, plant: Plant, optima: tuple[tuple[Arc, ...], ...]
) -> tuple[LoopCase, ...]:
    move = machine.moves[0]
    tuned = settle_on_loop(machine).tuned
    closest = [
        condense(
            move,
            sample_trajectory(plant, arcs, step=arcs[-1].t_end / CONDENSING_SAMPLES),
            velocity=plant.velocity,
        )
        for arcs in optima
    ]
    chosen = choose_limits(machine, plant, tuned)
    a = machine.drive.motion_force / plant.moving_mass
    rectangular = without_jerk_limit(machine, a)
    cases = []
    for limits in (rectangular, chosen.limits, *closest):
        response = _respond(machine, tuned, limits)
        measured = compare_controls(machine, tuned, move, limits=limits, optima=())[1]
        cases.append(LoopCase(limits=limits, response=response, measured=measured))
    return tuple(cases)


def _respond(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> LoopResponse:
    return simulate(
        tuned.loops[0],
        plan_setpoint(machine.moves[0], limits),
        drive=machine.drive,
        band=machine.requirements.tcp_deviation,
    )
