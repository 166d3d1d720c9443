"""The bounded problem on an adapted mesh: a linear program close to the exact solution.

Off the cores the force is constant in each cell; in a core it is the boundary control, so the
bound holds there exactly. The program is solved in two forms:

- kept: the core is entered on the bound with all its derivatives, a restriction of the problem;
- relaxed: the state jumps onto and off the bound by any impulses of the force, a relaxation,
  whose multipliers are a measure with a density on the core (``bounded_measure.Measure``).

Their values enclose the optimum on the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.measure import Atom, Measure
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program import Basis, Program, solve_program
from mtcommission.optimal.bounded.rows import (
    FORCE,
    Contact,
    Layout,
    Segment,
    bound_rows,
    entry_rows,
    feedback_rows,
    mesh_segments,
    off_cores,
    terminal_rows,
    terminal_scale,
)

Array = NDArray[np.float64]

FEASIBILITY = 1e-10
"""Tolerance of the simplex method: its smallest."""

MOST_ITERATIONS = 4
"""Steps of the simplex method, against rows and columns together, after which a program is given
up: twice what those that end need (measured), and an end for those that turn in circles within
the rounding."""

NEAR = 1e-2
"""Relative room below a bound within which a point is in the relaxation from the start; others
follow if they are broken. It halves the rows of that program."""
MISSED = 1e-7
"""Relative excess at which a point left out of the relaxation is broken."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshOptimum:
    """Solution of one program.

    Parameters
    ----------
    layout
        What was solved.
    segments
        In order of time.
    unknowns
        Relative force in each cell, then jumps, shape (n_unknowns,).
    reach
        α, the reached multiple of the target.
    slope
        dα/dt_f [1/s].
    measure
        The multipliers.
    contacts
        Contacts with their multipliers.
    held
        Share of the reach that the bounds carry, what it loses where all of them are smaller.
    basis
        Where the program with more contacts or another t_f may start.
    """

    layout: Layout
    segments: tuple[Segment, ...]
    unknowns: Array
    reach: float
    slope: float
    measure: Measure
    contacts: tuple[Contact, ...]
    held: float
    basis: Basis

    def state(self, ends: Array) -> Array:
        """Return a state from its affine map of shape (n, n_unknowns + 2)."""
        return np.asarray(ends @ np.concatenate([self.unknowns, [self.reach, 1.0]]))

    @property
    def sizes(self) -> Array:
        """Largest magnitude of each state at the ends of cells and cores, shape (n,)."""
        states = np.array([self.state(segment.last) for segment in self.segments])
        return np.asarray(np.abs(states).max(axis=0))


def solve_mesh(
    problem: BoundedProblem,
    layout: Layout,
    *,
    relaxed: bool,
    start: Basis | None = None,
    solvable: bool = False,
    sizes: Array | None = None,
) -> MeshOptimum | None:
    """Return the best control on a mesh, or None if the cores cannot be held.

    Parameters
    ----------
    problem
        The bounded problem.
    layout
        Mesh, cores and contacts.
    relaxed
        Which of the two forms.
    start
        Basis of the same form on the same cells, with fewer contacts or another t_f.
    solvable
        Whether the program is known to have a solution.
    sizes
        Of the fixed states, shape (n_fixed,): what a miss of the target is relative to. A tight
        bound leaves peaks far below what all cells together may reach, the default.

    Returns
    -------
    MeshOptimum or None
    """
    if relaxed:
        # What may not carry an atom is left out of the relaxation.
        layout = replace(layout, contacts=off_cores(problem, layout.contacts, layout.cores))
    segments = mesh_segments(problem, layout, relaxed=relaxed)
    size = segments[-1].last.shape[1] - 2
    rows, rooms = bound_rows(problem, layout, segments)
    if not relaxed:
        held_rows, held_rooms = feedback_rows(problem, segments)
        rows, rooms = np.vstack([held_rows, rows]), np.append(held_rooms, rooms)
    equal, right = terminal_rows(problem, segments, sizes=sizes)
    if not relaxed:
        held, levels = entry_rows(problem, layout, segments)
        equal, right = np.vstack([equal, held]), np.append(right, levels)
    cells = sum(segment.limit < 0 for segment in segments)
    program = Program(
        cost=np.append(np.zeros(size), -1.0),
        rows=rows,
        rooms=rooms,
        equal=equal,
        right=right,
        lower=np.concatenate([-np.ones(cells), np.full(size - cells, -np.inf), [0.0]]),
        upper=np.append(np.ones(cells), np.full(size - cells + 1, np.inf)),
    )
    steps = MOST_ITERATIONS * (sum(program.rows.shape) + right.size)
    answer = solve_program(
        program, steps=steps, tolerance=FEASIBILITY, start=start, solvable=solvable
    )
    if answer is None:
        return None
    weights = -answer.rows[rooms.size - len(layout.contacts) :]
    terminal = np.zeros(problem.plant.order)
    scale = terminal_scale(problem, segments, sizes=sizes)
    terminal[problem.fixed] = answer.equal[: scale.size] * scale
    contacts = tuple(
        Contact(remaining=at.remaining, limit=at.limit, side=at.side, weight=float(max(w, 0.0)))
        for at, w in zip(layout.contacts, weights, strict=True)
    )
    atoms = tuple(
        Atom(remaining=at.remaining, limit=at.limit, weight=at.side * at.weight)
        for at in contacts
        if at.weight > 0.0 and at.limit != FORCE
    )
    return MeshOptimum(
        layout=layout,
        segments=segments,
        unknowns=answer.unknowns[:-1],
        reach=float(answer.unknowns[-1]),
        slope=_slope(segments, answer.bounds),
        measure=Measure(t_f=layout.t_f, terminal=terminal, atoms=atoms, cores=layout.cores),
        contacts=contacts,
        held=float(answer.unknowns[-1] - np.abs(answer.bounds[:cells]).sum()),
        basis=answer.basis,
    )


def solve_relaxation(problem: BoundedProblem, kept: MeshOptimum) -> MeshOptimum | None:
    """Return the relaxation on the mesh of a control.

    It begins with the points that the control comes near; those that its own motion breaks follow,
    each once, so the loop ends.

    Parameters
    ----------
    problem
        The bounded problem.
    kept
        Solution of the kept form.

    Returns
    -------
    MeshOptimum or None
    """
    every = off_cores(problem, kept.layout.contacts, kept.layout.cores)
    layout = replace(kept.layout, contacts=every, margin=0.0)
    left_out = _room(problem, layout, kept) >= NEAR
    found: MeshOptimum | None = None
    while True:
        # The points so far come first, so that the basis fits.
        before = () if found is None else found.layout.contacts
        known = set(before)
        new = tuple(
            at
            for at, out in zip(every, left_out.tolist(), strict=True)
            if not out and at not in known
        )
        found = solve_mesh(
            problem,
            replace(layout, contacts=(*before, *new)),
            relaxed=True,
            start=None if found is None else found.basis,
        )
        if found is None:
            return None
        broken = left_out & (_room(problem, layout, found) < -MISSED)
        if not broken.any():
            return found
        left_out &= ~broken


def _room(problem: BoundedProblem, layout: Layout, found: MeshOptimum) -> Array:
    """Return how far a motion stays from its bounds at the contacts of a layout, shape (k,)."""
    rows, rooms = bound_rows(problem, layout, found.segments)
    return np.asarray(rooms - rows @ np.append(found.unknowns, found.reach))


def _slope(segments: tuple[Segment, ...], marginals: Array) -> float:
    """Return dα/dt_f = F |σ(t_f)|, extrapolated from the means of F |σ| over the first cells."""
    first, second = segments[:2]
    lengths = np.array([first.start - first.end, second.start - second.end])
    if first.column < 0 or second.column < 0:
        return float(abs(marginals[0]) / lengths[0])
    here, beside = np.abs(marginals[:2]) / lengths
    return float(max(here + (here - beside) * lengths[0] / lengths.sum(), 0.5 * here))
