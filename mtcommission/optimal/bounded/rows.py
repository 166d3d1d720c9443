"""What a mesh means: states as affine maps of the unknowns, and the rows of its linear program."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.measure import Core
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import step_response, transition

Array = NDArray[np.float64]

FORCE = -1
"""Index by which a contact means the force limit, which boundary control keeps there."""
LOOSE = 1e-6
"""Distance of a relative force from ±1 above which it may be corrected."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """A point where a bound is imposed.

    Parameters
    ----------
    remaining
        Remaining time [s].
    limit
        Index of the bound; ``FORCE`` inside a core where boundary control is limited.
    side
        +1 or -1.
    weight
        Multiplier, >= 0.
    """

    remaining: float
    limit: int
    side: int
    weight: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Layout:
    """Cells, cores and points of a program.

    Parameters
    ----------
    t_f
        [s].
    mesh
        Remaining times between cells, ascending, shape (n_points,) [s].
    cores
        In order of time.
    contacts
        Where bounds are imposed off the cores.
    margin
        Relative distance kept from the bounds.
    """

    t_f: float
    mesh: Array
    cores: tuple[Core, ...]
    contacts: tuple[Contact, ...]
    margin: float

    @property
    def effort(self) -> float:
        """What its program costs the simplex method, rows times columns times both together."""
        cells, points = float(self.mesh.size), float(len(self.contacts))
        return cells * points * (cells + points)

    def stretched(self, t_f: float) -> Layout:
        """Return the same layout over another t_f [s], every place at the same share of it."""
        share = t_f / self.t_f
        return replace(
            self,
            t_f=t_f,
            mesh=self.mesh * share,
            cores=tuple(
                replace(core, start=core.start * share, end=core.end * share) for core in self.cores
            ),
            contacts=tuple(replace(at, remaining=at.remaining * share) for at in self.contacts),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segment:
    """A cell or a core, with the states at its ends as affine functions of the unknowns.

    Parameters
    ----------
    start, end
        Remaining times [s].
    limit
        Index of the bound held; -1 in a cell.
    column
        Unknown that is the cell's force; -1 in a core.
    arrived, first, last
        Where the motion arrives, where it starts (on the bound in a core) and where it ends,
        shapes (n, n_unknowns + 2); the last columns belong to the reach and the constant.
    """

    start: float
    end: float
    limit: int
    column: int
    arrived: Array
    first: Array
    last: Array


def off_cores(
    problem: BoundedProblem, contacts: tuple[Contact, ...], cores: tuple[Core, ...]
) -> tuple[Contact, ...]:
    """Return the contacts that may carry an atom: off the cores, or of a higher order inside one.

    An atom inside a core jumps Λ by a multiple of c. On a core of order r that leaves σ = 0 if
    c B = ... = c A^(r-1) B = 0; on others it would end the core.
    """
    return tuple(
        at
        for at in contacts
        if not any(
            core.holds(at.remaining)
            and problem.limits[at.limit].order <= problem.limits[core.limit].order
            for core in cores
        )
    )


def mesh_segments(problem: BoundedProblem, layout: Layout, *, relaxed: bool) -> tuple[Segment, ...]:
    """Return cells and cores in order of time, their states as maps of the unknowns.

    Parameters
    ----------
    problem
        The bounded problem.
    layout
        Mesh and cores.
    relaxed
        Whether the state may jump onto and off the cores; the jumps are further unknowns.

    Returns
    -------
    tuple of Segment
    """
    plant, cores = problem.plant, layout.cores
    ends = [end for core in cores for end in (core.start, core.end)]
    points = np.unique(np.concatenate([[0.0, layout.t_f], layout.mesh, ends]))[::-1]
    spans = [
        (start, end, next((core for core in cores if core.holds(0.5 * (start + end))), None))
        for start, end in pairwise(points.tolist())
    ]
    cells = sum(core is None for *_, core in spans)
    jumps = sum(problem.limits[core.limit].order for core in cores) if relaxed else 0
    lengths = np.array([start - end for start, end, _ in spans])
    flows = transition(plant, lengths)
    pushes = step_response(plant, lengths) * problem.force_limit
    state, column, jump = np.zeros((plant.order, cells + jumps + 2)), 0, cells
    segments: list[Segment] = []
    for i, (start, end, core) in enumerate(spans):
        arrived = first = state
        if core is None:
            state = flows[i] @ state
            state[:, column] += pushes[i]
        else:
            limit = problem.limits[core.limit]
            # The restriction arrives on the bound by its own equations. Without this its small
            # misses of them would grow over the core, and the program would lose all digits.
            first = _projected(problem, layout, core, arrived)
            state = limit.boundary_flow.over(float(lengths[i])) @ first
            if relaxed:
                state[:, jump : jump + limit.order] += limit.force_chain
                jump += limit.order
        segments.append(
            Segment(
                start=start,
                end=end,
                limit=-1 if core is None else core.limit,
                column=column if core is None else -1,
                arrived=arrived,
                first=first,
                last=state,
            )
        )
        column += core is None
    return tuple(segments)


def _level(problem: BoundedProblem, layout: Layout, limit: int, width: int) -> Array:
    """Return a level as a row over all columns: the constant, or the reach if it follows."""
    row = np.zeros(width)
    if limit == FORCE:
        row[-1] = 1.0
        return row
    held = problem.limits[limit]
    # A bound that the target itself meets has no room for a margin.
    margin = 0.0 if abs(float(held.row @ problem.target)) > 1.0 - LOOSE else layout.margin
    row[-2 if held.follows else -1] = 1.0 - margin
    return row


def _projected(problem: BoundedProblem, layout: Layout, core: Core, state: Array) -> Array:
    """Return the state moved onto the bound by impulses of the force."""
    limit = problem.limits[core.limit]
    moved = state - limit.impulses @ (limit.output_chain @ state)
    level = core.side * _level(problem, layout, core.limit, state.shape[1])
    return np.asarray(moved + np.outer(limit.impulses[:, 0], level))


def bound_rows(
    problem: BoundedProblem, layout: Layout, segments: tuple[Segment, ...]
) -> tuple[Array, Array]:
    """Return rows and rooms of the bounds at the contacts, rows x <= rooms.

    Parameters
    ----------
    problem
        The bounded problem.
    layout
        Cells, cores and contacts.
    segments
        With their affine maps.

    Returns
    -------
    tuple of ndarray, shapes (n_contacts, n_unknowns + 1) and (n_contacts,)
    """
    starts = -np.array([segment.start for segment in segments])
    rows = np.zeros((len(layout.contacts), segments[-1].last.shape[1]))
    for i, contact in enumerate(layout.contacts):
        index = max(int(np.searchsorted(starts, -contact.remaining, side="right")) - 1, 0)
        segment = segments[index]
        row = _bounded_row(problem, contact.limit, segment)
        if contact.remaining == segment.start and index > 0:
            rows[i] = row @ segments[index - 1].last
            continue
        since = np.array(segment.start - contact.remaining)
        if segment.limit >= 0:
            flow = problem.limits[segment.limit].boundary_flow.over(float(since))
            rows[i] = row @ flow @ segment.first
            continue
        rows[i] = row @ transition(problem.plant, since) @ segment.first
        push = step_response(problem.plant, since) @ row
        rows[i, segment.column] += push * problem.force_limit
    sides = np.array([contact.side for contact in layout.contacts], dtype=np.float64)
    rows *= sides[:, np.newaxis]
    for i, contact in enumerate(layout.contacts):
        rows[i] -= _level(problem, layout, contact.limit, rows.shape[1])
    return rows[:, :-1], -rows[:, -1]


def _bounded_row(problem: BoundedProblem, limit: int, segment: Segment) -> Array:
    """Return the row of a bounded signal, or of the boundary control held on a segment."""
    if limit == FORCE:
        return problem.limits[segment.limit].feedback / problem.force_limit
    return problem.limits[limit].row


def feedback_rows(problem: BoundedProblem, segments: tuple[Segment, ...]) -> tuple[Array, Array]:
    """Return rows and rooms that keep the boundary control within the force limit at its ends.

    Parameters
    ----------
    problem
        The bounded problem.
    segments
        With their affine maps.

    Returns
    -------
    tuple of ndarray, shapes (4 n_cores, n_unknowns + 1) and (4 n_cores,)
    """
    rows = [np.empty((0, segments[-1].last.shape[1]))]
    for segment in segments:
        if segment.limit >= 0:
            gain = problem.limits[segment.limit].feedback / problem.force_limit
            ends = np.array([gain @ segment.first, gain @ segment.last])
            rows += [ends, -ends]
    stacked = np.vstack(rows)
    return stacked[:, :-1], 1.0 - stacked[:, -1]


def terminal_scale(
    problem: BoundedProblem, segments: tuple[Segment, ...], *, sizes: Array | None = None
) -> Array:
    """Return the scale of the terminal equations.

    Parameters
    ----------
    problem
        The bounded problem.
    segments
        With their affine maps.
    sizes
        Of the fixed states, shape (n_fixed,); else what all cells together may reach.

    Returns
    -------
    ndarray, shape (n_fixed,)
    """
    if sizes is not None:
        return 1.0 / sizes
    sizes = np.abs(segments[-1].last[problem.fixed]).sum(axis=1)
    return np.asarray(1.0 / np.maximum(sizes, np.abs(problem.target[problem.fixed])))


def terminal_rows(
    problem: BoundedProblem, segments: tuple[Segment, ...], *, sizes: Array | None = None
) -> tuple[Array, Array]:
    """Return the scaled equations by which the motion ends at the reached multiple of the target.

    Parameters
    ----------
    problem
        The bounded problem.
    segments
        With their affine maps.
    sizes
        Of the fixed states, shape (n_fixed,); else what all cells together may reach.

    Returns
    -------
    tuple of ndarray, shapes (n_fixed, n_unknowns + 1) and (n_fixed,)
    """
    final, scale = segments[-1].last[problem.fixed], terminal_scale(problem, segments, sizes=sizes)
    rows = final[:, :-1].copy()
    rows[:, -1] -= problem.target[problem.fixed]
    return rows * scale[:, np.newaxis], -final[:, -1] * scale


def entry_rows(
    problem: BoundedProblem, layout: Layout, segments: tuple[Segment, ...]
) -> tuple[Array, Array]:
    """Return the equations by which the motion arrives on the bounds of the cores.

    Parameters
    ----------
    problem
        The bounded problem.
    layout
        Cells, cores and contacts.
    segments
        With their affine maps.

    Returns
    -------
    tuple of ndarray, shapes (n_equations, n_unknowns + 1) and (n_equations,)
    """
    rows = [np.empty((0, segments[-1].last.shape[1]))]
    for segment in segments:
        if segment.limit >= 0:
            core = next(core for core in layout.cores if core.start == segment.start)
            held = problem.limits[core.limit].output_chain @ segment.arrived
            held[0] -= core.side * _level(problem, layout, core.limit, held.shape[1])
            rows.append(held)
    stacked = np.vstack(rows)
    return stacked[:, :-1], -stacked[:, -1]
