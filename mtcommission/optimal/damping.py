"""Plant + move + t_f -> the damping-optimal control: the saturated linear-quadratic problem.

minimise ∫ F_set² + Σ c_i x_i² dt   subject to |F_set| <= F_max, from rest to the target
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Weight
from mtcommission.machine.moves import Move
from mtcommission.messages.message import Message
from mtcommission.optimal.motion import FollowedMotion, follow_control
from mtcommission.optimal.saturated import (
    Iterate,
    SaturatedProblem,
    scale_problem,
    solve_saturated,
)
from mtcommission.optimal.solution import (
    Arc,
    Bang,
    DampingOptimum,
    Interior,
    Law,
    Optimum,
    TimeOptimum,
    constant_arc,
    terminal_target,
)
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

MOST_RADIANS = 1e4
"""Of the fastest mode over the motion: a hundred thousand samples (empirical)."""


def solve_damping_optimal(
    plant: Plant, move: Move, *, force_limit: float, t_f: float, weights: tuple[Weight, ...]
) -> DampingOptimum:
    """Return the control that reaches the target at t_f with the least weighted squares.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE, also where t_f is below the shortest time.
    ValueError
        If a weight names no state of the plant.

    Source: Christiansen, Maurer & Zirn, eqs. (5) and (16); derived in
    docs/optimal-control.md, section 9.

    Examples
    --------
    >>> from mtcommission.plant.plant import build_plant
    >>> from mtcommission.profile.shipped import read_shipped
    >>> machine = read_shipped("milling-manipulator").machine
    >>> best = solve_damping_optimal(build_plant(machine), machine.moves[0], force_limit=2e3,
    ...     t_f=0.0522, weights=machine.damping_optimal.weights)
    >>> round(best.cost / 1e3), [arc.control for arc in best.arcs][:2]
    (449, [Bang(side=1), Interior()])
    """
    problem = scale_problem(plant, move, force_limit=force_limit, t_f=t_f, weights=weights)
    found = solve_saturated(problem, force_unit=plant.force_unit)
    arcs = _arcs(problem, found)
    target, fixed = terminal_target(plant, move)
    motion = follow_control(plant, arcs, rate=problem.rate)
    return Optimum(
        move=move,
        force_limit=force_limit,
        bounds=(),
        method="exact",
        t_f=t_f,
        weights=weights,
        arcs=arcs,
        cost_terms=cost_terms(plant, motion, weights),
        certificate=Law(
            adjoint_initial=found.z[0, 0, plant.order : -1] * problem.adjoint_scale,
            law_residual=found.violation,
        ),
        terminal_error=np.where(fixed, motion.final - target, 0.0),
        motion=motion,
    )


def _arcs(problem: SaturatedProblem, found: Iterate) -> tuple[Arc, ...]:
    """Return one arc where the force is saturated, and one for each piece where it is not."""
    F, width = problem.force_limit, 2 * problem.target.size
    generator, output = problem.generators[0, :width, :width], F * problem.control_row[:width]
    ends = np.append(found.t[1:, 0], problem.t_f).tolist()
    arcs: list[Arc] = []
    for label, start, end, z in zip(
        found.labels.tolist(), found.t[:, 0].tolist(), ends, found.z[:, 0, :width], strict=True
    ):
        if label and arcs and arcs[-1].control == Bang(label):
            start = arcs.pop().t_start
        if label:
            arcs.append(constant_arc(start, end, control=Bang(label), force=label * F))
        else:
            arcs.append(
                Arc(
                    t_start=start,
                    t_end=end,
                    control=Interior(),
                    generator=generator,
                    initial=z,
                    output=output,
                )
            )
    return tuple(arcs)


def cost_terms(plant: Plant, motion: FollowedMotion, weights: tuple[Weight, ...]) -> Array:
    """Return the parts of the cost of a motion: of F_set², then of each weight [N² s]."""
    squares = [one.value * motion.squares[plant.states.index(one.state)] for one in weights]
    return np.array([motion.effort, *squares])


def balanced_weights(plant: Plant, reference: TimeOptimum) -> tuple[Weight, ...]:
    """Return the weights with which all terms are equal along the time-optimal motion.

    c_i = ∫ F_set² dt / ∫ x_i² dt over the reference, for the deflection and the rate of each
    flexible mode. Along the damping-optimal motion itself the terms then differ: it is what
    the optimisation is free to change.

    Source: Christiansen, Maurer & Zirn, sec. 6: "all terms ... have the same magnitude". That
    the time-optimal solution of their sec. 5.1 is meant is inferred: it gives (17) to 1 ... 3 %,
    see docs/optimal-control.md, section 9.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG.
    """
    fastest = max(mode.natural_frequency for mode in plant.modes)
    radians = fastest * reference.t_f
    if radians > MOST_RADIANS:
        detail = Message("optimum-too-long", t_f=reference.t_f, radians=radians, most=MOST_RADIANS)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    motion = follow_control(plant, reference.arcs)
    places = [mode.deflection for mode in plant.modes] + [mode.rate for mode in plant.modes]
    return tuple(
        Weight(state=plant.states[i], value=motion.effort / float(motion.squares[i]))
        for i in places
    )
