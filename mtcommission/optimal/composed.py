"""A control that does the move whatever the machine, where the optimum is not found.

Force steps of a rigid axis, shaped by two impulses for every mode and for the force lag, leave
nothing behind: exact, without a search or a mesh. It is not optimal; a proved lower bound says how
far from it. docs/optimal-control.md, section 8, derives it.
"""

from __future__ import annotations

from math import exp, isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError
from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.shapers import shape
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.proof import follow_control, require_followable
from mtcommission.optimal.solution import (
    Arc,
    Bound,
    Certificate,
    Interior,
    TimeOptimum,
    constant_arc,
)
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

LAG_TIMES = 8.0
"""Distance of the impulses for the force lag, in lags: 3e-4 of force and velocity are left over."""

MOST_RADIANS = 3e5
"""Fastest rate times duration of what is composed: some two seconds to follow (measured)."""

COARSE = 0.15
"""Peaks of what is not optimal: to a millionth."""


def compose_time_optimum(plant: Plant, move: Move, *, force_limit: float) -> TimeOptimum:
    """Return full force on and off, shaped so that the axis ends at rest.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG where it would have too many samples to follow.

    Source: shaping by two impulses: Singer and Seering 1990, here with a pair for a real pole.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.plant.plant import build_plant
    >>> move = Positioning(distance=0.02, max_velocity=0.1)
    >>> plant = build_plant(read_shipped("milling-manipulator").machine)
    >>> found = compose_time_optimum(plant, move, force_limit=2e3)
    >>> found.certificate.t_f_lower_bound < found.t_f < 0.4
    True
    """
    most = force_limit / plant.moving_mass
    times, shares = _impulses(plant)
    forward = float(shares[shares > 0.0].sum())  # what the velocity swings up to
    acceleration = most / float(np.abs(shares).sum())
    if isinstance(move, Positioning):
        length = min(move.max_velocity / forward / acceleration, sqrt(move.distance / acceleration))
        apart = move.distance / (acceleration * length)
        base = np.array([0.0, length, apart, apart + length])
        signs = np.array([1.0, -1.0, -1.0, 1.0])
        least = _rigid_time(move.distance, move.max_velocity, most)
    else:
        base, signs = np.array([0.0, move.velocity_step / acceleration]), np.array([1.0, -1.0])
        least = move.velocity_step / most
    require_followable(float(base[-1] + times.max()), plant.fastest_rate, most=MOST_RADIANS)
    force = acceleration * plant.moving_mass
    arcs = _arcs(
        np.add.outer(base, times).ravel(), force * np.multiply.outer(signs, shares).ravel()
    )
    motion = follow_control(plant, arcs, radians=COARSE)
    error = motion.final.copy()
    if isinstance(move, Positioning):
        error[plant.position] -= move.distance
    else:
        error[plant.position] = 0.0
        error[plant.velocity] -= move.velocity_step
    least = max(least, _free_time(plant, move, force_limit))
    return TimeOptimum(
        move=move,
        force_limit=force_limit,
        bounds=_velocity_bound(plant, move),
        method="composed",
        t_f=arcs[-1].t_end,
        arcs=arcs,
        touch_points=(),
        terminal_error=error,
        motion=motion,
        certificate=Certificate(
            t_f_lower_bound=least,
            relative_gap=(arcs[-1].t_end - least) / arcs[-1].t_end,
            adjoint_initial=np.full(plant.order, np.nan),
            switching_slopes=np.zeros(0),
            switching_law_holds=False,
            terminal_jacobian_rank=-1,
            terminal_jacobian_condition=float("nan"),
        ),
    )


def _impulses(plant: Plant) -> tuple[Array, Array]:
    """Times [s] and shares of impulses that no pole but the rigid ones answers.

    A ZV shaper for each mode, and for the pole of the force lag its counterpart, 1 and -e^{-d/T};
    the shares add up to 1, so the rigid motion stays.
    """
    modes = (
        shape("zv", frequency_hz=mode.frequency_hz, damping_ratio=mode.damping_ratio)
        for mode in plant.modes
    )
    pairs = [(np.array(item.delays), np.array(item.shares)) for item in modes]
    if plant.force_lag:
        both = np.array([1.0, -exp(-LAG_TIMES)])
        pairs.append((LAG_TIMES * plant.force_lag * np.arange(2), both / both.sum()))
    times, shares = np.zeros(1), np.ones(1)
    for delays, parts in pairs:
        times = np.add.outer(times, delays).ravel()
        shares = np.multiply.outer(shares, parts).ravel()
    return times, shares


def _arcs(times: Array, steps: Array) -> tuple[Arc, ...]:
    """Arcs of constant force from the times [s] and heights [N] of its steps."""
    order = np.argsort(times, kind="stable")
    times, force = times[order], np.cumsum(steps[order])
    return tuple(
        constant_arc(start, end, control=Interior(), force=height)
        for start, end, height in zip(
            times[:-1].tolist(), times[1:].tolist(), force[:-1].tolist(), strict=True
        )
        if end > start
    )


def _velocity_bound(plant: Plant, move: Move) -> tuple[Bound, ...]:
    if not isinstance(move, Positioning) or not isfinite(move.max_velocity):
        return ()
    return (Bound(name=plant.states[plant.velocity], value=move.max_velocity),)


def _free_time(plant: Plant, move: Move, force_limit: float) -> float:
    """Proved lower bound of the optimum without max_velocity; 0 where it is not found [s]."""
    try:
        return solve_time_optimal(
            plant,
            Positioning(distance=move.distance) if isinstance(move, Positioning) else move,
            force_limit=force_limit,
        ).certificate.t_f_lower_bound
    except ComputationError:
        return 0.0


def _rigid_time(distance: float, velocity: float, acceleration: float) -> float:
    """Least time of a rigid mass without force lag [s]."""
    if distance * acceleration >= velocity**2:
        return distance / velocity + velocity / acceleration
    return 2.0 * sqrt(distance / acceleration)
