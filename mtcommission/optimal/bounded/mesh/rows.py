"""What a mesh means: states as affine maps of the unknowns, and the rows of its linear program."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.bounded.places import FORCE, ArcInterior, ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import step_response, transition

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshPlan:
    """Cells, interiors and points of a program."""

    t_f: float  # [s]
    mesh: Array  # Remaining times between cells, ascending, shape (n_points,) [s]
    interiors: tuple[ArcInterior, ...]  # In order of time
    points: tuple[ConstraintPoint, ...]  # Where bounds are imposed off the interiors
    margin: float  # Relative distance kept from the bounds

    @property
    def effort(self) -> float:
        """What its program costs the simplex method, rows times columns times both together."""
        cells, points = float(self.mesh.size), float(len(self.points))
        return cells * points * (cells + points)

    def stretched(self, t_f: float) -> MeshPlan:
        """Return the same plan over another t_f [s], every place at the same share of it."""
        share = t_f / self.t_f
        return replace(
            self,
            t_f=t_f,
            mesh=self.mesh * share,
            interiors=tuple(one.stretched(share) for one in self.interiors),
            points=tuple(at.stretched(share) for at in self.points),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segment:
    """A cell or an interior, with the states at its ends as affine functions of the unknowns."""

    # start, end: Remaining times [s].
    start: float
    end: float
    limit: int  # Index of the bound held; -1 in a cell
    column: int  # Unknown that is the cell's force; -1 in an interior
    # arrived, first, last: Where the motion arrives, where it starts (on the bound in an
    # interior) and where it ends, shapes (n, n_unknowns + 2); the last columns belong to the
    # reach and the constant.
    arrived: Array
    first: Array
    last: Array


def off_interiors(
    problem: BoundedProblem, points: tuple[ConstraintPoint, ...], interiors: tuple[ArcInterior, ...]
) -> tuple[ConstraintPoint, ...]:
    """Return the points that may carry an atom: off the interiors, or of a higher order inside one.

    An atom inside an interior jumps Λ by a multiple of c. With order r that leaves σ = 0 if
    c B = ... = c A^(r-1) B = 0; on others it would end the interior.
    """
    return tuple(
        at
        for at in points
        if not any(
            interior.holds(at.remaining)
            and problem.limits[at.limit].order <= problem.limits[interior.limit].order
            for interior in interiors
        )
    )


def mesh_segments(problem: BoundedProblem, plan: MeshPlan, *, relaxed: bool) -> tuple[Segment, ...]:
    """Return cells and interiors in order of time, their states as maps of the unknowns."""
    plant, interiors = problem.plant, plan.interiors
    ends = [end for interior in interiors for end in (interior.start, interior.end)]
    points = np.unique(np.concatenate([[0.0, plan.t_f], plan.mesh, ends]))[::-1]
    spans = [
        (
            start,
            end,
            next((interior for interior in interiors if interior.holds(0.5 * (start + end))), None),
        )
        for start, end in pairwise(points.tolist())
    ]
    cells = sum(interior is None for *_, interior in spans)
    jumps = sum(problem.limits[interior.limit].order for interior in interiors) if relaxed else 0
    lengths = np.array([start - end for start, end, _ in spans])
    if len(spans) > problem.settings.mesh.most_cells:
        detail = Message("mesh-too-fine", cells=len(spans), most=problem.settings.mesh.most_cells)
        raise ComputationError(Outcome.MOVE_TOO_LONG, detail)
    flows = transition(plant, lengths)
    pushes = step_response(plant, lengths) * problem.force_limit
    state, column, jump = np.zeros((plant.order, cells + jumps + 2)), 0, cells
    segments: list[Segment] = []
    for i, (start, end, interior) in enumerate(spans):
        arrived = first = state
        if interior is None:
            state = flows[i] @ state
            state[:, column] += pushes[i]
        else:
            limit = problem.limits[interior.limit]
            # The restriction arrives on the bound by its own equations. Without this its small
            # misses of them would grow over the interior, and the program would lose all digits.
            first = _projected(problem, plan, interior, arrived)
            state = limit.boundary_flow.over(float(lengths[i])) @ first
            if relaxed:
                state[:, jump : jump + limit.order] += limit.force_chain
                jump += limit.order
        segments.append(
            Segment(
                start=start,
                end=end,
                limit=-1 if interior is None else interior.limit,
                column=column if interior is None else -1,
                arrived=arrived,
                first=first,
                last=state,
            )
        )
        column += interior is None
    return tuple(segments)


def _level(problem: BoundedProblem, plan: MeshPlan, limit: int, width: int) -> Array:
    """Return a level as a row over all columns: the constant, or the reach if it follows."""
    row = np.zeros(width)
    if limit == FORCE:
        row[-1] = 1.0
        return row
    held = problem.limits[limit]
    # A bound that the target itself meets has no room for a margin.
    margin = (
        0.0
        if abs(float(held.row @ problem.target)) > 1.0 - problem.settings.mesh.at_target
        else plan.margin
    )
    row[-2 if held.follows else -1] = 1.0 - margin
    return row


def _projected(
    problem: BoundedProblem, plan: MeshPlan, interior: ArcInterior, state: Array
) -> Array:
    """Return the state moved onto the bound by impulses of the force."""
    limit = problem.limits[interior.limit]
    moved = state - limit.impulses @ (limit.output_chain @ state)
    level = interior.side * _level(problem, plan, interior.limit, state.shape[1])
    return np.asarray(moved + np.outer(limit.impulses[:, 0], level))


def bound_rows(
    problem: BoundedProblem, plan: MeshPlan, segments: tuple[Segment, ...]
) -> tuple[Array, Array]:
    """Return rows and rooms of the bounds at the points, rows x <= rooms."""
    starts = -np.array([segment.start for segment in segments])
    rows = np.zeros((len(plan.points), segments[-1].last.shape[1]))
    for i, point in enumerate(plan.points):
        index = max(int(np.searchsorted(starts, -point.remaining, side="right")) - 1, 0)
        segment = segments[index]
        row = _bounded_row(problem, point.limit, segment)
        if point.remaining == segment.start and index > 0:
            rows[i] = row @ segments[index - 1].last
            continue
        since = np.array(segment.start - point.remaining)
        if segment.limit >= 0:
            flow = problem.limits[segment.limit].boundary_flow.over(float(since))
            rows[i] = row @ flow @ segment.first
            continue
        rows[i] = row @ transition(problem.plant, since) @ segment.first
        push = step_response(problem.plant, since) @ row
        rows[i, segment.column] += push * problem.force_limit
    sides = np.array([point.side for point in plan.points], dtype=np.float64)
    rows *= sides[:, np.newaxis]
    for i, point in enumerate(plan.points):
        rows[i] -= _level(problem, plan, point.limit, rows.shape[1])
    return rows[:, :-1], -rows[:, -1]


def _bounded_row(problem: BoundedProblem, limit: int, segment: Segment) -> Array:
    """Return the row of a bounded signal, or of the boundary control held on a segment."""
    if limit == FORCE:
        return problem.limits[segment.limit].feedback / problem.force_limit
    return problem.limits[limit].row


def feedback_rows(problem: BoundedProblem, segments: tuple[Segment, ...]) -> tuple[Array, Array]:
    """Return rows and rooms that keep the boundary control within the force limit at its ends."""
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
    """Return the scale of the terminal equations."""
    if sizes is not None:
        return 1.0 / sizes
    sizes = np.abs(segments[-1].last[problem.fixed]).sum(axis=1)
    return np.asarray(1.0 / np.maximum(sizes, np.abs(problem.target[problem.fixed])))


def terminal_rows(
    problem: BoundedProblem, segments: tuple[Segment, ...], *, sizes: Array | None = None
) -> tuple[Array, Array]:
    """Return the scaled equations by which the motion ends at the reached multiple."""
    final, scale = segments[-1].last[problem.fixed], terminal_scale(problem, segments, sizes=sizes)
    rows = final[:, :-1].copy()
    rows[:, -1] -= problem.target[problem.fixed]
    return rows * scale[:, np.newaxis], -final[:, -1] * scale


def entry_rows(
    problem: BoundedProblem, plan: MeshPlan, segments: tuple[Segment, ...]
) -> tuple[Array, Array]:
    """Return the equations by which the motion arrives on the bounds of the interiors."""
    rows = [np.empty((0, segments[-1].last.shape[1]))]
    for segment in segments:
        if segment.limit >= 0:
            interior = next(
                interior for interior in plan.interiors if interior.start == segment.start
            )
            held = problem.limits[interior.limit].output_chain @ segment.arrived
            held[0] -= interior.side * _level(problem, plan, interior.limit, held.shape[1])
            rows.append(held)
    stacked = np.vstack(rows)
    return stacked[:, :-1], -stacked[:, -1]
