"""The fastest controls to a state from which the free motion keeps the tool within a band.

Exact rest is more than a band asks for: modes may ring, as long as the tool stays within. The band
is one more bound, on the free motion after the end, so the program on cells finds the control and
proves it. Several machines are one plant with the modes of all of them, driven by the same force: a
force that keeps the band on a whole spread is found alike. docs/optimal-control.md, sections 6, 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.cells import exchange, first_cells
from mtcommission.optimal.control import Arc, Boundary, Interior, constant_arc
from mtcommission.optimal.modes import free_peaks, free_row, in_moments
from mtcommission.optimal.problem import BoundedProblem, all_bounds, bounded_problem
from mtcommission.optimal.program import Cells
from mtcommission.optimal.proof import require_followable
from mtcommission.optimal.refine import cell_arcs, finer, finish, observe, refined

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

ENOUGH, PROGRAMS = 1e-5, 6
"""Gap at which the search ends, and programs on finer and finer cells at most."""
MACHINES, EXCHANGES, ROUNDS = 5, 30, 1
"""Of a spread in the first program; programs, in which the worst of all machines join, at most;
and how often cells become finer."""
ROUGH, MISSED = 1e-3, 1e-6
"""What they, and what comes out, may miss of the band, before its forces are divided."""
MOST_RADIANS = 1e4
"""Of the fastest vibration within a robust force, beyond which its programs, of the modes of all
machines, would take minutes (empirical)."""
MARGIN = 5e-3
"""Share of the band that a robust force keeps free for machines between those looked at."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BandForce:
    """The fastest set force found after which the tool stays within the band by itself."""

    move: Move  # What it does
    # force_limit, band: What it keeps [N, m].
    force_limit: float
    band: float
    t_f: float  # When it becomes 0, for good [s]
    arcs: tuple[Arc, ...]  # Of constant force, in order, without gaps, from 0 to t_f
    # How far the reference lies beyond the place at which the tool comes to rest [m]; for a
    # velocity step beside its steady motion.
    offset: float
    lower_bound: float  # No admissible control is faster [s]; 0 for several machines: not proved
    machines: int  # How many keep the band
    peak: float  # Largest distance of their tools from the reference after the end, at most [m]

    @property
    def gap(self) -> float:
        """Relative distance of its time from the proved bound."""
        return (self.t_f - self.lower_bound) / self.t_f


def find_band_optimum(
    plant: Plant, move: Move, *, force_limit: float, band: float, at_rest: float
) -> BandForce:
    """Return the fastest control to a state from which the free motion keeps the band for ever.

    ``at_rest``: the optimum with exact rest [s].

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a program or the exchange of its points does not end.
    """
    problem = band_problem([plant], move, force_limit=force_limit, band=band, horizon=at_rest)
    programs = islice(refined(problem, first_cells(problem, t_free=at_rest)), PROGRAMS)
    best = next(programs)
    while best.gap > ENOUGH and (seen := next(programs, None)):
        best = min(best, seen, key=lambda one: one.gap)
    force = _force(problem, move, best.cells, band=band, width=band)
    return replace(force, lower_bound=min(best.dual.lower_bound, force.t_f))


def find_robust_force(
    plants: Sequence[Plant], move: Move, *, force_limit: float, band: float, guess: float
) -> BandForce:
    """Return the fastest force after which all of some machines keep the band for ever.

    Machines that leave the band farther than their neighbours join those that it was found for.

    Raises
    ------
    ComputationError
        MOVE_TOO_LONG; NO_CONVERGENCE if a program or an exchange does not end.
    """
    room, every = (1.0 - MARGIN) * band, _every_tool(plants, band)
    chosen = np.unique(np.linspace(0, len(plants) - 1, MACHINES).round().astype(int)).tolist()

    def asked() -> BoundedProblem:
        some = [plants[i] for i in chosen]
        return band_problem(some, move, force_limit=force_limit, band=room, horizon=guess)

    problem, rounds = asked(), 0
    require_followable(guess, problem.vibration_rate, most=MOST_RADIANS)
    first = first_cells(problem, t_free=guess)
    plan, start = first.plan, first.basis
    for _ in range(EXCHANGES):
        cells = exchange(problem, plan, tolerance=ROUGH, start=start)
        if cells is None:
            break
        force = force_limit * cells.force
        peaks = every.peaks(cells.plan.edges[::-1], force, offset=cells.offset * room / band)
        beside = np.pad(peaks, 1)
        is_worst = (peaks >= beside[:-2]) & (peaks > beside[2:]) & (peaks > 1.0)
        more = [i for i in np.flatnonzero(is_worst).tolist() if i not in chosen]
        if more:
            chosen += more
            problem, plan, start = asked(), cells.plan, cells.basis
        elif rounds < ROUNDS:
            plan, rounds = finer(problem, observe(problem, cells)), rounds + 1
        else:
            found = _force(problem, move, cells, band=band, width=room)
            return replace(found, machines=len(plants), peak=float(peaks.max()) * band)
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("band-exchange-goes-on"))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Tools:
    """Free motions of the tools of some machines over the band."""

    rates: Complex  # Poles, shape (m, k) [1/s]
    gains: Complex  # Shape (m, k) [1/(N s)]

    def peaks(self, edges: Array, force: Array, *, offset: float) -> Array:
        """Return how far each gets from the reference after a force; 0 if well within the band.

        ``edges``: remaining times, falling to 0, between which each force acts.
        """
        grown = np.expm1(self.rates[..., np.newaxis] * edges) / self.rates[..., np.newaxis]
        weights = self.gains * (-np.diff(grown, axis=-1) @ force)
        machine, _, heights = free_peaks(self.rates, weights, offset=offset)
        found = np.zeros(len(self.rates))
        np.maximum.at(found, machine, heights)
        return found


def _every_tool(plants: Sequence[Plant], band: float) -> _Tools:
    every = [in_moments(plant) for plant in plants]
    rows = [plant.row("tcp") @ one.back / band for plant, one in zip(plants, every, strict=True)]
    gains = [one.functions.modal(row) for one, row in zip(every, rows, strict=True)]
    return _Tools(rates=np.array([one.functions.rates for one in every]), gains=np.array(gains))


def band_problem(
    plants: Sequence[Plant], move: Move, *, force_limit: float, band: float, horizon: float
) -> BoundedProblem:
    """Return the problem whose free motion keeps the band [m] on all of some machines."""
    plant, tools = side_by_side(plants)
    bounds = all_bounds(plant, move, ())
    problem = bounded_problem(plant, move, force_limit=force_limit, bounds=bounds, horizon=horizon)
    # Momentum is what is wanted; the reference of positioning lies beside the place of rest.
    ends, offsets = in_moments(plant).rows[-2:], np.array([0.0, plant.moving_mass * band])
    count = 1 if isinstance(move, VelocityStep) else 2
    return replace(
        problem,
        ends=ends[:count],
        offsets=offsets[:count],
        tails=np.array([free_row(plant, tool) for tool in tools]) / band,
    )


def side_by_side(plants: Sequence[Plant]) -> tuple[Plant, list[Array]]:
    """Return the plant with the modes of all, which differ in nothing else, and each one's tool."""
    first = plants[0]
    modal = [i for mode in first.modes for i in (mode.deflection, mode.rate)]
    lagged = list(range(*first.lagged.indices(first.order)))
    size = 2 + len(modal) * len(plants) + len(lagged)
    A, B, tools, modes = np.zeros((size, size)), np.zeros(size), [], []
    names = [first.states[first.position], first.states[first.velocity]]
    for number, plant in enumerate(plants):
        start = 2 + len(modal) * number
        place = np.zeros(plant.order, dtype=np.intp)
        place[plant.velocity] = 1
        place[modal] = start + np.arange(len(modal))
        place[lagged] = size - 1
        A[np.ix_(place, place)], B[place] = plant.A, plant.B
        tool = np.zeros(size)
        tool[place] = plant.row("tcp")
        tools.append(tool)
        names += [f"{plant.states[i]} {number}" for i in modal]
        modes += [
            replace(mode, deflection=int(place[mode.deflection]), rate=int(place[mode.rate]))
            for mode in plant.modes
        ]
    joined = replace(
        first,
        states=(*names, *(first.states[i] for i in lagged)),
        A=A,
        B=B,
        outputs=(),
        C=np.empty((0, size)),
        modes=tuple(modes),
        position=0,
        velocity=1,
    )
    return joined, tools


def _force(
    problem: BoundedProblem, move: Move, cells: Cells, *, band: float, width: float
) -> BandForce:
    found = finish(problem, cells, tolerance=MISSED)
    if found is None:
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("band-program-gave-up"))
    arcs = cell_arcs(problem, found)
    return BandForce(
        move=move,
        force_limit=problem.force_limit,
        band=band,
        t_f=arcs[-1].t_end,
        arcs=tuple(_constant(arc) for arc in arcs),
        offset=found.offset / found.reach * width,
        lower_bound=0.0,
        machines=1,
        peak=band,
    )


def _constant(arc: Arc) -> Arc:
    """Return an arc on which the rigid velocity is held as one without force, which it is."""
    if isinstance(arc.control, Boundary):
        return constant_arc(arc.t_start, arc.t_end, control=Interior(), force=0.0)
    return arc
