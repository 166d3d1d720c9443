"""A positioning move composed of two velocity steps and a cruise.

Where the exact search under a velocity limit does not end, this still is a control that keeps
the limit and ends at rest, with a proved (if coarser) lower bound. It is not optimal: the
optimum may let the modes ring while it cruises.
"""

from __future__ import annotations

from dataclasses import replace
from math import isfinite, sqrt

import numpy as np

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.machine import Positioning, VelocityStep
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.constrained import solve_bounded_time_optimal
from mtcommission.optimal.bounded.proof.motion import follow_control, require_followable
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import (
    Arc,
    Bound,
    Boundary,
    Certificate,
    Interior,
    TimeOptimum,
    constant_arc,
)
from mtcommission.plant.plant import Plant


def compose_cruise(plant: Plant, move: Positioning, *, force_limit: float) -> TimeOptimum:
    """Return the move as speeding up to max_velocity, cruising at rest, and stopping.

    Speeding up is the time-optimal velocity step (duration t_s) that keeps the limit; stopping
    is its mirror image. Both together cover V t_s, so t_f = L/V + t_s.

    Parameters
    ----------
    plant
        The axis, at rest at t = 0.
    move
        With a finite max_velocity.
    force_limit
        Force left for motion [N].

    Returns
    -------
    TimeOptimum
        ``method`` is ``"composed"``. Its lower bound is the larger of the free optimum and the
        rigid bound L/V + m V/F (both drop constraints, so no admissible control is faster);
        adjoint and switching law do not apply.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if the move is too short to reach max_velocity this way.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> move = Positioning(distance=0.02, max_velocity=0.1)
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> found = compose_cruise(plant, move, force_limit=2e3)
    >>> round(found.t_f, 6), found.certificate.t_f_lower_bound < found.t_f
    (0.24352, True)
    """
    V, L = move.max_velocity, move.distance
    name = plant.states[plant.velocity]
    if not isfinite(V):
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("cruise-needs-velocity"))
    bound = Bound(name=name, value=V)
    require_followable(L / V, plant.fastest_rate)
    rise = solve_bounded_time_optimal(
        plant, VelocityStep(velocity_step=V), force_limit=force_limit, bounds=(bound,)
    )
    cruise = L / V - rise.t_f
    if cruise <= 0.0:
        unit = plant.unit(plant.states[plant.position])
        detail = Message("too-short-to-cruise", distance=L, velocity=V, unit=unit)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    begin = rise.t_f + cruise
    hold = constant_arc(rise.t_f, begin, control=Boundary(name, 1), force=0.0)
    arcs = (*rise.arcs, hold, *(_mirrored(arc, begin) for arc in rise.arcs))
    motion = follow_control(plant, arcs, rate=plant.fastest_rate)
    error = motion.final.copy()
    error[plant.position] -= L
    t_f = begin + rise.t_f
    free = solve_time_optimal(plant, Positioning(distance=L), force_limit=force_limit)
    least = max(free.t_f, _rigid_time(L, V, force_limit / plant.moving_mass))
    return TimeOptimum(
        move=move,
        force_limit=force_limit,
        bounds=(bound,),
        method="composed",
        t_f=t_f,
        arcs=arcs,
        touch_points=(),
        terminal_error=error,
        motion=motion,
        certificate=Certificate(
            t_f_lower_bound=least,
            relative_gap=(t_f - least) / t_f,
            adjoint_initial=np.full(plant.order, np.nan),
            switching_slopes=np.zeros(0),
            switching_law_holds=False,
            terminal_jacobian_rank=-1,
            terminal_jacobian_condition=float("nan"),
        ),
    )


def _rigid_time(distance: float, velocity: float, acceleration: float) -> float:
    """Least time of a rigid mass without force lag [s]."""
    if distance * acceleration >= velocity**2:
        return distance / velocity + velocity / acceleration
    return 2.0 * sqrt(distance / acceleration)


def _mirrored(arc: Arc, later: float) -> Arc:
    """The arc with its force reversed, at a later time."""
    control = arc.control
    if not isinstance(control, Interior):
        control = replace(control, side=-control.side)
    start, end = arc.t_start + later, arc.t_end + later
    return replace(arc, t_start=start, t_end=end, control=control, output=-arc.output)
