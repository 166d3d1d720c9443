"""A long cruise at max_velocity, from a shorter one that is lengthened step by step.

An even grid that resolves the modes over a cruise of many periods would be too large. But what
happens at the two ends of the cruise hardly depends on its length: the sequence of a move of a
few periods is solved first; then its distance grows, the arc at max_velocity with it, and
Newton's method follows, subarcs put in and taken out on the way (``newton.exact.solve_exactly``).
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from mtcommission.errors import ComputationError
from mtcommission.machine.machine import Positioning
from mtcommission.optimal.bounded.mesh.plan import first_features
from mtcommission.optimal.bounded.newton.exact import solve_exactly
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program.grid import solve_grid_time
from mtcommission.optimal.bounded.proof.accepted import Found
from mtcommission.optimal.bounded.search import search
from mtcommission.optimal.bounded.structure.arcs import arc_piece
from mtcommission.optimal.bounded.structure.detection import place_touches
from mtcommission.optimal.bounded.structure.sequence import Sequence
from mtcommission.optimal.free.time_optimal import solve_time_optimal


def cruise_periods(problem: BoundedProblem) -> float:
    """Return how many periods of the slowest mode a rigid axis would cruise; 0 if it does not."""
    index = _velocity_limit(problem)
    if index < 0:
        return 0.0
    cruise = float(problem.target[problem.plant.position]) - _rise(problem, index)
    return max(cruise / (problem.limits[index].bound.value * slowest_period(problem)), 0.0)


def lengthened_cruise(problem: BoundedProblem) -> Found | None:
    """Return the optimum of a positioning move whose cruise lasts many periods."""
    settings = problem.settings.search
    if cruise_periods(problem) < settings.long_cruise:
        return None
    index = _velocity_limit(problem)
    for periods in settings.cruise_periods:
        velocity = problem.limits[index].bound.value
        cruise = velocity * (problem.plant.force_lag + periods * slowest_period(problem))
        short = _over(problem, _rise(problem, index) + cruise)
        first = _directly(short)
        if first is not None and not first.exact:
            # Arcs that no finite sequence explains do not get one by a longer cruise.
            return None
        found = None if first is None else _followed(problem, index, first, short)
        if found is not None:
            return found
    return None


def _rise(problem: BoundedProblem, index: int) -> float:
    """Return the distance in which a rigid axis speeds up and stops again [m or rad]."""
    velocity = problem.limits[index].bound.value
    return velocity**2 * problem.plant.moving_mass / problem.force_limit


def slowest_period(problem: BoundedProblem) -> float:
    """Return the period of the slowest mode [s]."""
    modes = problem.plant.modes
    slowest = min((mode.natural_frequency for mode in modes), default=problem.rate)
    return 2.0 * pi / slowest


def _followed(
    problem: BoundedProblem, index: int, first: Found, short: BoundedProblem
) -> Found | None:
    """Return the optimum, followed from that of a shorter move, or None."""
    settings = problem.settings.search
    plant, velocity = problem.plant, problem.limits[index].bound.value
    distance, now = float(problem.target[plant.position]), float(short.target[plant.position])
    rise, found, growth = _rise(problem, index), first, settings.cruise_growth
    while now < distance and growth > settings.least_cruise_growth:
        further = min(distance, now + (growth - 1.0) * (now - rise))
        longer = _over(problem, further)
        guess = _stretched(longer, index, found, (further - now) / velocity)
        following = solve_exactly(longer, guess)
        if following is None:
            growth = 1.0 + 0.4 * (growth - 1.0)
            continue
        found, now, growth = (
            following,
            further,
            min(settings.cruise_growth, 1.0 + 1.5 * (growth - 1.0)),
        )
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
    """Return the optimum of a move with a short cruise, or None."""
    move = Positioning(distance=float(problem.target[problem.plant.position]))
    free = solve_time_optimal(problem.plant, move, force_limit=problem.force_limit)
    try:
        return search(problem, first_features(problem, solve_grid_time(problem, t_free=free.t_f)))
    except ComputationError:
        return None


def _stretched(problem: BoundedProblem, index: int, found: Found, longer: float) -> Sequence:
    """Return the sequence of a solution with its longest arc at max_velocity lengthened [s]."""
    pieces = [arc_piece(problem, arc) for arc in found.motion.arcs]
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
