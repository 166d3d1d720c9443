"""Optimal controls of an open-loop axis, whose motor follows its setpoint.

They are found on ``plant.driven_at_once``, which has no state for the acceleration: what is set
acts at once, and in the plant's own states the acceleration F is what is set. Within a jerk, that
is the control, and the acceleration a bounded state.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant, driven_at_once
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.bounded import refuse_impossible, solve_problem
from mtcommission.optimal.control import (
    Arc,
    Bang,
    Boundary,
    Optimum,
    Proof,
    Ramp,
    TimeOptimum,
    balanced_expm,
)
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.optimal.problem import all_bounds, bounded_problem

Array = NDArray[np.float64]


def optimum_on(plant: Plant, found: Optimum[Proof]) -> Optimum[Proof]:
    """Return an optimal control in the states of the plant."""
    if not plant.follows:
        return found
    proof = found.certificate
    return replace(
        found,
        terminal_error=np.append(found.terminal_error, 0.0),
        set_state=plant.force,
        certificate=replace(proof, adjoint_initial=np.append(proof.adjoint_initial, np.nan)),
    )


def least_limit(plant: Plant, force_limit: float, bounds: Iterable[SignalValue]) -> float:
    """Return the force limit, or a lower bound on the acceleration of a motor that follows."""
    return min((force_limit, *(one.value for one in bounds if not _on_state(plant, one))))


def on_states(plant: Plant, bounds: Iterable[SignalValue]) -> tuple[SignalValue, ...]:
    """Return the bounds but for those that ``least_limit`` covers."""
    return tuple(one for one in bounds if _on_state(plant, one))


def _on_state(plant: Plant, bound: SignalValue) -> bool:
    return not plant.follows or bound.name != plant.states[plant.force]


def solve_jerk_limited(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    jerk_limit: float,
    bounds: tuple[SignalValue, ...],
) -> TimeOptimum:
    """Return the fastest motion within acceleration and jerk that leaves everything at rest.

    Raises
    ------
    ComputationError
        As ``solve_bounded_time_optimal``.

    Source: docs/optimal-control.md, with the jerk for the force.

    Examples
    --------
    >>> from mtcommission.machine.plant.plant import build_plant
    >>> from mtcommission.machine.profile.shipped import read_shipped
    >>> machine = read_shipped("printer-belt").machine
    >>> found = solve_jerk_limited(build_plant(machine), VelocityStep(velocity_step=0.08),
    ...     force_limit=53.0, jerk_limit=2e4, bounds=())
    >>> round(found.t_f, 6), [arc.control.side for arc in found.arcs]
    (0.011153, [1, -1, 1, -1])
    """
    state = plant.states[plant.force]
    every = all_bounds(plant, move, (*bounds, SignalValue(name=state, value=force_limit)))
    refuse_impossible(plant, move, every)
    sooner = solve_time_optimal(driven_at_once(plant), move, force_limit=force_limit).t_f
    least = max(sooner, _least_ramps(move, jerk_limit))
    problem = bounded_problem(plant, move, force_limit=jerk_limit, bounds=every, horizon=least)
    optimum = solve_problem(problem, move, every, t_free=least)
    return replace(
        optimum,
        force_limit=force_limit,
        jerk_limit=jerk_limit,
        bounds=tuple(bound for bound in every if bound.name != state),
        arcs=_accelerations(state, optimum.arcs),
    )


def _least_ramps(move: Move, jerk: float) -> float:
    if isinstance(move, VelocityStep):
        return float(2.0 * np.sqrt(move.velocity_step / jerk))
    return float(4.0 * np.cbrt(0.5 * move.distance / jerk))


def _accelerations(state: str, arcs: tuple[Arc, ...]) -> tuple[Arc, ...]:
    """Return arcs of the jerk as arcs of the acceleration, which is its integral."""
    found, a = [], 0.0
    for arc in arcs:
        k, span = arc.initial.size, arc.t_end - arc.t_start
        generator = np.zeros((k + 1, k + 1))
        generator[:k, :k], generator[k, :k] = arc.generator, arc.output
        control = arc.control
        if isinstance(control, Bang):
            control = Ramp(control.side)
        elif isinstance(control, Boundary) and control.signal == state:
            control = Bang(control.side)
        initial, output = np.append(arc.initial, a), np.append(np.zeros(k), 1.0)
        found.append(
            replace(arc, control=control, generator=generator, initial=initial, output=output)
        )
        a = float((balanced_expm(generator * span) @ initial)[-1])
    return tuple(found)
