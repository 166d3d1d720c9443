"""The linear program: a force, constant on cells of the remaining time, that reaches farthest.

The tool's free motion after the end must keep the band at some instants, and the velocity its
limit at the ends of the cells; which instants matter is found by exchange.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.machine.moves import Move, Positioning
from mtcommission.messages.message import Message
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.optimal.band.tail import Tail, find_tail_peaks
from mtcommission.optimal.free.moments import moment_problem
from mtcommission.optimal.linear_program import Basis, Program, solve_program
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

COMB = 8
"""Instants that stand for a cell."""
TOLERANCE = 1e-9
"""Of the simplex method, against bounds of 1."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Question:
    """What a force must do."""

    plant: Plant  # Nominal
    tails: tuple[Tail, ...]  # Free motions that must keep the band
    move: Move  # From rest; the reference of a velocity step may lie beside it
    # force_limit, band: [N, m].
    force_limit: float
    band: float
    margin: float  # Share of the band kept free
    velocity_margin: float  # Share of max_velocity kept free
    settings: BandSettings  # Of the search

    @property
    def room(self) -> float:
        """The band without the part kept free [m]."""
        return self.band * (1.0 - self.margin)

    @property
    def target(self) -> float:
        """∫ ψ F_set dτ of the move [N s or N s²]."""
        return moment_problem(self.plant, self.move).target

    @property
    def degree(self) -> int:
        """ψ = τ^degree."""
        return moment_problem(self.plant, self.move).degree

    @property
    def max_velocity(self) -> float:
        """Of the move; inf without a limit [m/s]."""
        return self.move.max_velocity if isinstance(self.move, Positioning) else inf

    @property
    def velocity_room(self) -> float:
        """max_velocity without the part kept free [m/s]."""
        return self.max_velocity * (1.0 - self.velocity_margin)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contacts:
    """Instants at which free motions must keep the band."""

    machine: NDArray[np.intp]  # Index of the tail of each, shape (k,)
    s: Array  # Time after the end, shape (k,) [s]

    def joined(self, others: Contacts, *, which: NDArray[np.bool_]) -> Contacts:
        """Return these and some of others."""
        return Contacts(
            machine=np.concatenate((self.machine, others.machine[which])),
            s=np.concatenate((self.s, others.s[which])),
        )

    def extended(self, machine: int, s: Array) -> Contacts:
        """Return these and others of one machine."""
        return Contacts(
            machine=np.concatenate((self.machine, np.full(s.size, machine))),
            s=np.concatenate((self.s, s)),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CellForce:
    """The force that reaches farthest, with its multipliers."""

    edges: Array  # Remaining times, ascending from 0 to t_f, shape (n_cells + 1,) [s]
    force: Array  # In each cell, shape (n_cells,) [N]
    offset: float  # y: the reference beside the place of rest [m]
    reach: float  # What it reaches, against the target [-]
    contacts: Contacts  # Rows of the program
    # Remaining times over each of whose rows the velocity's mean is bounded, shape (k, p)
    # [s].
    watched: Array
    # λ: gain of ∫ ψ F_set per distance added to the band at each contact, signed by the side
    # that is touched, shape (n_contacts,) [N s/m or N s²/m].
    multipliers: Array
    # The same for max_velocity in each row of ``watched``, shape (k,), empty without one [N
    # s²/m per m/s].
    velocity_multipliers: Array
    # κ of a positioning move: gain per momentum left at the end [s]; 0 for a velocity step.
    momentum_multiplier: float
    basis: Basis  # Where a program like it may start

    @property
    def t_f(self) -> float:
        """Final time [s]."""
        return float(self.edges[-1])


def first_contacts(question: Question) -> Contacts:
    """Return instants over the first two periods of the slowest mode of each machine."""
    found = Contacts(machine=np.zeros(0, dtype=np.intp), s=np.zeros(0))
    count = question.settings.first_contacts
    for machine, tail in enumerate(question.tails):
        modes = tail.swinging.imag
        period = 2.0 * np.pi / float(modes.min()) if modes.size else question.plant.force_lag
        found = found.extended(machine, np.linspace(0.0, 2.0 * period, 2 * count + 1))
    return found


def reach_farthest(
    question: Question, edges: Array, contacts: Contacts, *, start: Basis | None = None
) -> CellForce:
    """Return the force that reaches farthest, with peaks of the free motion as further contacts.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if the simplex method or the exchange does not end.
    """
    settings = question.settings
    band = question.band
    for _ in range(settings.exchanges):
        cells = solve_cells(question, edges, contacts, watched=points(edges), start=start)
        more, start = contacts, cells.basis
        for machine, tail in enumerate(question.tails):
            moments = tail.moments(edges) @ cells.force
            peaks = find_tail_peaks(
                tail, moments, offset=cells.offset, level=band, settings=settings
            )
            if peaks.peak > band:
                more = more.extended(machine, peaks.places)
        if more is contacts:
            return cells
        contacts = more
    raise ComputationError(Outcome.NO_CONVERGENCE, Message("band-exchange-goes-on"))


def solve_cells(
    question: Question,
    edges: Array,
    contacts: Contacts,
    *,
    watched: Array,
    start: Basis | None = None,
) -> CellForce:
    """Return the force that reaches farthest with given rows.

    The unknowns are the forces over F and, last, y over the room.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if the simplex method gives up.
    """
    plant, F, room, degree = (
        question.plant,
        question.force_limit,
        question.room,
        question.degree,
    )
    target, m = question.target, plant.moving_mass
    n, rows = edges.size - 1, np.empty((contacts.s.size, edges.size))
    for machine, tail in enumerate(question.tails):
        own = contacts.machine == machine
        responses = tail.responses(contacts.s[own]) @ tail.moments(edges)
        rows[own, :n] = responses.real * (F / room)
    rows[:, n] = -1.0
    velocity = np.empty((0, n + 1))
    if isfinite(question.velocity_room):
        velocity = np.zeros((len(watched), n + 1))
        rates = velocity_rows(plant, edges, watched.ravel()).reshape(*watched.shape, n)
        velocity[:, :n] = rates.mean(axis=1) * (F / question.velocity_room)
    momentum, position = np.diff(edges), np.diff(0.5 * edges**2)
    gain = np.append(F * (position if degree else momentum), degree * m * room) / target
    all_rows = np.vstack([velocity, rows])
    ones = np.ones(len(all_rows))
    solution = solve_program(
        Program(
            cost=-gain,
            rows=all_rows,
            rooms=ones,
            floors=-ones,
            equal=np.append(momentum / edges[-1], 0.0)[np.newaxis][:degree],
            right=np.zeros(degree),
            lower=-np.ones(n + 1),
            upper=np.ones(n + 1),
        ),
        steps=question.settings.steps,
        tolerance=TOLERANCE,
        start=start,
        is_solvable=True,
    )
    if solution is None:
        raise ComputationError(Outcome.NO_CONVERGENCE, Message("band-program-gave-up"))
    kept = len(velocity)
    return CellForce(
        edges=edges,
        force=F * np.clip(solution.unknowns[:n], -1.0, 1.0),
        offset=room * float(solution.unknowns[n]),
        reach=float(gain @ solution.unknowns),
        contacts=contacts,
        watched=watched,
        multipliers=-solution.rows[kept:] * target / room,
        velocity_multipliers=-solution.rows[:kept] * target / question.velocity_room,
        momentum_multiplier=-float(solution.equal.sum()) * target / (F * float(edges[-1])),
        basis=solution.basis,
    )


def points(edges: Array) -> Array:
    """Return late end and middle of each cell as instants of their own, shape (2 n_cells, 1) [s].

    With the ends alone a force that swings from cell to cell would exceed a velocity between them.
    """
    return np.concatenate((edges[:-1], 0.5 * (edges[1:] + edges[:-1])))[:, np.newaxis]


def combs(edges: Array) -> Array:
    """Return instants spread over each cell, shape (n_cells, COMB) [s].

    A bound on the mean over a cell asks for less than one at its points, and its multipliers are
    spread over the cell: what they prove does not suffer from σ rippling between atoms.
    """
    shares = (np.arange(COMB) + 0.5) / COMB
    return np.asarray(edges[:-1, np.newaxis] + np.outer(np.diff(edges), shares))


def velocity_rows(plant: Plant, edges: Array, tau: Array) -> Array:
    """Return the rigid velocity at some remaining times that a force of 1 N in each cell makes.

    Source: v(τ) = ∫ (1 - e^{-(τ' - τ)/T}) F_set dτ' / m over τ' > τ.
    """
    T = plant.force_lag
    covered = np.maximum(edges - tau[:, np.newaxis], 0.0)
    if T:
        covered = covered + T * np.expm1(-covered / T)
    return np.asarray(np.diff(covered, axis=1) / plant.moving_mass)
