"""The bounded problem on an adapted mesh: a linear program close to the exact solution.

Off the interiors of boundary arcs the force is constant in each cell; inside them it is the
boundary control, so the bound holds there exactly. The program is solved in two forms:

- restriction: the interior is entered on the bound with all its derivatives;
- relaxation: the state jumps onto and off the bound by any impulses of the force; it is the one
  whose multipliers are a measure with a density on the interior (``proof.dual_point.Measure``).

Their values enclose the optimum on the mesh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.mesh.rows import (
    MeshPlan,
    Segment,
    bound_rows,
    entry_rows,
    feedback_rows,
    mesh_segments,
    off_interiors,
    terminal_rows,
    terminal_scale,
)
from mtcommission.optimal.bounded.places import FORCE, ConstraintPoint
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.bounded.program.linear_program import Basis, Program, solve_program
from mtcommission.optimal.bounded.proof.dual_point import Atom, Measure

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MeshOptimum:
    """Solution of one program."""

    plan: MeshPlan  # What was solved
    # In order of time, with their states under the solution, shape (n,): the affine maps of a
    # fine mesh take some hundred megabytes, and a search keeps many meshes.
    segments: tuple[Segment, ...]
    unknowns: Array  # Relative force in each cell, then jumps, shape (n_unknowns,)
    reach: float  # α, the reached multiple of the target
    slope: float  # dα/dt_f [1/s]
    measure: Measure  # The multipliers
    points: tuple[ConstraintPoint, ...]  # Points with their multipliers
    # Share of the reach that the bounds carry, what it loses where all of them are smaller.
    held: float
    basis: Basis  # Where the program with more points or another t_f may start

    @property
    def sizes(self) -> Array:
        """Largest magnitude of each state at the ends of cells and interiors, shape (n,)."""
        states = np.array([segment.last for segment in self.segments])
        return np.asarray(np.abs(states).max(axis=0))


def solve_mesh(
    problem: BoundedProblem,
    plan: MeshPlan,
    *,
    relaxed: bool,
    start: Basis | None = None,
    solvable: bool = False,
    sizes: Array | None = None,
) -> MeshOptimum | None:
    """Return the best control on a mesh, or None if the interiors cannot be held."""
    settings = problem.settings.mesh
    if relaxed:
        # What may not carry an atom is left out of the relaxation.
        plan = replace(plan, points=off_interiors(problem, plan.points, plan.interiors))
    segments = mesh_segments(problem, plan, relaxed=relaxed)
    size = segments[-1].last.shape[1] - 2
    rows, rooms = bound_rows(problem, plan, segments)
    if not relaxed:
        held_rows, held_rooms = feedback_rows(problem, segments)
        rows, rooms = np.vstack([held_rows, rows]), np.append(held_rooms, rooms)
    equal, right = terminal_rows(problem, segments, sizes=sizes)
    if not relaxed:
        held, levels = entry_rows(problem, plan, segments)
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
    steps = settings.steps_per_line * (sum(program.rows.shape) + right.size)
    solution = solve_program(
        program,
        problem.settings.program,
        steps=steps,
        tolerance=settings.feasibility,
        start=start,
        solvable=solvable,
    )
    if solution is None:
        return None
    weights = -solution.rows[rooms.size - len(plan.points) :]
    terminal = np.zeros(problem.plant.order)
    scale = terminal_scale(problem, segments, sizes=sizes)
    terminal[problem.fixed] = solution.equal[: scale.size] * scale
    points = tuple(
        replace(at, weight=float(max(w, 0.0))) for at, w in zip(plan.points, weights, strict=True)
    )
    atoms = tuple(
        Atom(remaining=at.remaining, limit=at.limit, weight=at.side * at.weight)
        for at in points
        if at.weight > 0.0 and at.limit != FORCE
    )
    return MeshOptimum(
        plan=plan,
        segments=_under(segments, np.append(solution.unknowns, 1.0)),
        unknowns=solution.unknowns[:-1],
        reach=float(solution.unknowns[-1]),
        slope=_slope(segments, solution.bounds),
        measure=Measure(t_f=plan.t_f, terminal=terminal, atoms=atoms, interiors=plan.interiors),
        points=points,
        held=float(solution.unknowns[-1] - np.abs(solution.bounds[:cells]).sum()),
        basis=solution.basis,
    )


def solve_relaxation(problem: BoundedProblem, restriction: MeshOptimum) -> MeshOptimum | None:
    """Return the relaxation on the mesh of a control.

    It begins with the points that the control comes near; those that its own motion breaks follow,
    each once, so the loop ends.
    """
    settings = problem.settings.mesh
    every = off_interiors(problem, restriction.plan.points, restriction.plan.interiors)
    plan = replace(restriction.plan, points=every, margin=0.0)
    left_out = _room(problem, plan, restriction, relaxed=False) >= settings.near
    found: MeshOptimum | None = None
    while True:
        # The points so far come first, so that the basis fits.
        before = () if found is None else found.plan.points
        known = set(before)
        new = tuple(
            at
            for at, out in zip(every, left_out.tolist(), strict=True)
            if not out and at not in known
        )
        found = solve_mesh(
            problem,
            replace(plan, points=(*before, *new)),
            relaxed=True,
            start=None if found is None else found.basis,
        )
        if found is None:
            return None
        broken = left_out & (_room(problem, plan, found, relaxed=True) < -settings.missed)
        if not broken.any():
            return found
        left_out &= ~broken


def _room(problem: BoundedProblem, plan: MeshPlan, found: MeshOptimum, *, relaxed: bool) -> Array:
    """Return how far a motion stays from its bounds at the points of a plan, shape (k,)."""
    segments = mesh_segments(problem, found.plan, relaxed=relaxed)
    rows, rooms = bound_rows(problem, plan, segments)
    return np.asarray(rooms - rows @ np.append(found.unknowns, found.reach))


def _under(segments: tuple[Segment, ...], solution: Array) -> tuple[Segment, ...]:
    """Return segments with states for maps; ``solution`` has unknowns, reach and 1."""
    return tuple(
        replace(
            segment,
            arrived=segment.arrived @ solution,
            first=segment.first @ solution,
            last=segment.last @ solution,
        )
        for segment in segments
    )


def _slope(segments: tuple[Segment, ...], marginals: Array) -> float:
    """Return dα/dt_f = F |σ(t_f)|, extrapolated from the means of F |σ| over the first cells."""
    first, second = segments[:2]
    lengths = np.array([first.start - first.end, second.start - second.end])
    if first.column < 0 or second.column < 0:
        return float(abs(marginals[0]) / lengths[0])
    here, beside = np.abs(marginals[:2]) / lengths
    return float(max(here + (here - beside) * lengths[0] / lengths.sum(), 0.5 * here))
