"""A long cruise at max_velocity, from a shorter one that is lengthened step by step.

An even grid that resolves the modes over a cruise of many periods would be too large. But what
happens at the two ends of the cruise hardly depends on its length: the sequence of a move of a
few periods is solved first; then its distance grows, the arc at max_velocity with it, and
Newton's method follows, dips put in and taken out on the way (``bounded_search.solve_exactly``).
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from mtcommission.errors import ComputationError
from mtcommission.machine import Positioning
from mtcommission.optimal.bounded_accept import Found
from mtcommission.optimal.bounded_arcs import Piece, Sequence
from mtcommission.optimal.bounded_grid import solve_grid_time
from mtcommission.optimal.bounded_layout import first_sight
from mtcommission.optimal.bounded_problem import BoundedProblem
from mtcommission.optimal.bounded_reading import place_touches
from mtcommission.optimal.bounded_search import search, solve_exactly
from mtcommission.optimal.time_optimal import solve_time_optimal

PERIODS = (3.0, 4.3)
"""Periods of the slowest mode in the cruise of the first move; the second where the first leads
to a length at which the sequence changes in a way that no edit knows."""
LONG = 2.5
"""Cruise, in cruises of the first move, from which on it is worth while to begin with that."""
GROWTH = 1.4
"""Largest factor on the time at max_velocity in one step."""
SMALLEST_GROWTH = 1.1
"""Factor below which the distance is not brought closer any more."""


def lengthened_cruise(problem: BoundedProblem) -> Found | None:
    """Return the optimum of a positioning move whose cruise lasts many periods.

    Parameters
    ----------
    problem
        Any bounded problem.

    Returns
    -------
    Found or None
        None if there is no such cruise, or if a step could not be followed.
    """
    index = _velocity_limit(problem)
    if index < 0:
        return None
    for periods in PERIODS:
        found = _from_short(problem, index, periods=periods)
        if found is not None:
            return found
    return None


def _from_short(problem: BoundedProblem, index: int, *, periods: float) -> Found | None:
    """Return the optimum, followed from a cruise of a few periods, or None."""
    plant, velocity = problem.plant, problem.limits[index].bound.value
    distance = float(problem.target[plant.position])
    slowest = min((mode.natural_frequency for mode in plant.modes), default=problem.rate)
    rise = velocity**2 * plant.moving_mass / problem.force_limit
    now = rise + velocity * (plant.force_lag + periods * 2.0 * pi / slowest)
    if distance - rise < LONG * (now - rise):
        return None
    found, growth = _directly(_over(problem, now)), GROWTH
    while found is not None and now < distance and growth > SMALLEST_GROWTH:
        further = min(distance, now + (growth - 1.0) * (now - rise))
        longer = _over(problem, further)
        guess = _stretched(longer, index, found, (further - now) / velocity)
        following = solve_exactly(longer, guess)
        if following is None:
            growth = 1.0 + 0.4 * (growth - 1.0)
            continue
        found, now, growth = following, further, min(GROWTH, 1.0 + 1.5 * (growth - 1.0))
    return found if now >= distance else None


def _velocity_limit(problem: BoundedProblem) -> int:
    """Return the index of the bound on the rigid velocity in a positioning move, or -1."""
    plant = problem.plant
    name = plant.states[plant.velocity]
    if plant.position not in problem.fixed:
        return -1
    return next((i for i, k in enumerate(problem.limits) if k.bound.name == name), -1)


def _over(problem: BoundedProblem, distance: float) -> BoundedProblem:
    """Return the problem over another distance."""
    target = problem.target.copy()
    target[problem.plant.position] = distance
    return replace(problem, target=target)


def _directly(problem: BoundedProblem) -> Found | None:
    """Return the optimum of a move with a short cruise, if its arcs can be solved exactly."""
    move = Positioning(distance=float(problem.target[problem.plant.position]))
    free = solve_time_optimal(problem.plant, move, force_limit=problem.force_limit)
    try:
        found = search(problem, first_sight(problem, solve_grid_time(problem, t_free=free.t_f)))
    except ComputationError:
        return None
    return found if found is not None and found.exact else None


def _stretched(problem: BoundedProblem, index: int, found: Found, longer: float) -> Sequence:
    """Return the sequence of a solution with its longest arc at max_velocity lengthened [s]."""
    names = [limit.bound.name for limit in problem.limits]
    pieces = []
    for arc in found.motion.arcs:
        kind, _, rest = arc.control.partition(":")
        held = names.index(rest.partition(":")[0]) if kind == "boundary" else -1
        side = -1 if arc.control.endswith("-") or arc.control.startswith("-") else 1
        pieces.append(Piece(limit=held, side=side, duration=arc.t_end - arc.t_start))
    cruise = [piece.duration if piece.limit == index else 0.0 for piece in pieces]
    longest = int(np.argmax(cruise))
    pieces[longest] = replace(pieces[longest], duration=pieces[longest].duration + longer)
    after = sum(piece.duration for piece in pieces[longest + 1 :])
    # Remaining times of what comes before the cruise grow with it.
    touches = tuple(
        replace(at, remaining=at.remaining + (longer if at.remaining > after else 0.0))
        for at in found.touches
    )
    return Sequence(pieces=tuple(pieces), touches=place_touches(problem, tuple(pieces), touches))
