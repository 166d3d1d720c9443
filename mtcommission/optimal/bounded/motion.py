"""From a found control to arcs, and what the motion under them really does.

Nothing here knows how the control was found: bounds, force and target are checked on the
motion itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.bounded.arcs import Sequence
from mtcommission.optimal.bounded.mesh import MeshOptimum
from mtcommission.optimal.bounded.problem import BoundedProblem
from mtcommission.optimal.closed_form import step_response, transition
from mtcommission.optimal.exponential import balanced_expm
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, constant_arc
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

RADIANS_PER_CELL = 0.015
"""Cells for the peaks: the cubic between samples is right to (ω h)^4 / 384 = 1.3e-10."""

SAME_FORCE = 1e-9
"""Relative difference of the forces of two cells below which they are one arc."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """What a control does.

    Parameters
    ----------
    arcs
        The control.
    final
        State at the end, shape (n,).
    peaks
        Largest magnitude of each of ``Plant.signals``.
    force_peak
        Largest |F_set| [N].
    """

    arcs: tuple[Arc, ...]
    final: Array
    peaks: Array
    force_peak: float


def sequence_arcs(problem: BoundedProblem, sequence: Sequence) -> tuple[Arc, ...]:
    """Return the arcs of a sequence of bang and boundary arcs.

    Parameters
    ----------
    problem
        The bounded problem.
    sequence
        All durations >= 0.

    Returns
    -------
    tuple of Arc
    """
    plant, F = problem.plant, problem.force_limit
    state, start, arcs = np.zeros(plant.order), 0.0, []
    for piece in sequence.pieces:
        end, since = start + piece.duration, np.array(piece.duration)
        if piece.limit < 0:
            label = "+F_max" if piece.side > 0 else "-F_max"
            arcs.append(constant_arc(start, end, control=label, force=piece.side * F))
            push = step_response(plant, since) * piece.side * F
            state = transition(plant, since) @ state + push
        else:
            # As in Newton's method: what is missed at the entry would grow over the arc.
            held = problem.limits[piece.limit]
            state = state - held.impulses @ held.missed(state, piece.side)
            arcs.append(boundary_arc(problem, piece.limit, start, end, state=state))
            state = held.boundary_flow.over(piece.duration) @ state
        start = end
    return tuple(arcs)


def boundary_arc(
    problem: BoundedProblem, index: int, start: float, end: float, *, state: Array
) -> Arc:
    """Return the arc that holds a bound from a state on it: F_set = K expm((A + B K) t) x."""
    limit, flow = problem.limits[index], problem.limits[index].boundary_flow
    side = "+" if float(limit.row @ state) > 0.0 else "-"
    return Arc(
        t_start=start,
        t_end=end,
        control=f"boundary:{limit.bound.name}:{side}",
        generator=flow.generator,
        initial=flow.chart @ state,
        output=limit.feedback @ flow.inverse,
    )


def mesh_arcs(problem: BoundedProblem, found: MeshOptimum) -> tuple[Arc, ...]:
    """Return the arcs of a control on a mesh, scaled so that it reaches the target once.

    Parameters
    ----------
    problem
        The bounded problem.
    found
        With a reach of at least 1.

    Returns
    -------
    tuple of Arc
        Cells of equal force joined; a boundary arc holds the bound divided by the reach.
    """
    F, t_f, arcs = problem.force_limit, found.layout.t_f, list[Arc]()
    for group in _groups(found):
        start, end = t_f - group[0].start, t_f - group[-1].end
        if group[0].limit >= 0:
            state = found.state(group[0].first) / found.reach
            arcs.append(boundary_arc(problem, group[0].limit, start, end, state=state))
            continue
        lengths = np.array([cell.start - cell.end for cell in group])
        share = float(found.unknowns[[cell.column for cell in group]] @ lengths / lengths.sum())
        full = abs(share) > 1.0 - SAME_FORCE
        label = ("+F_max" if share > 0.0 else "-F_max") if full else "interior"
        arcs.append(constant_arc(start, end, control=label, force=share * F / found.reach))
    return tuple(arcs)


def _groups(found: MeshOptimum) -> list[list]:  # type: ignore[type-arg]
    groups = [[found.segments[0]]]
    for before, after in pairwise(found.segments):
        both = before.limit < 0 and after.limit < 0
        if both and abs(found.unknowns[before.column] - found.unknowns[after.column]) < SAME_FORCE:
            groups[-1].append(after)
        else:
            groups.append([after])
    return groups


def follow(plant: Plant, arcs: tuple[Arc, ...], *, rate: float) -> Motion:
    """Return what the plant does under the arcs, from rest.

    Parameters
    ----------
    plant
        Plant with n states.
    arcs
        In order, without gaps, from t = 0.
    rate
        Fastest angular frequency [rad/s].

    Returns
    -------
    Motion
    """
    state, rows = np.zeros(plant.order), signal_rows(plant)
    peaks, force_peak = np.zeros(len(rows)), 0.0
    for arc in arcs:
        length = arc.t_end - arc.t_start
        count = int(np.ceil(length * rate / RADIANS_PER_CELL)) + 1
        flow = balanced_expm(_joint(plant, arc) * (length / count))
        samples = [np.concatenate([state, arc.initial])]
        for _ in range(count):
            samples.append(flow @ samples[-1])
        joint = np.array(samples)
        states, force = joint[:, : plant.order], joint[:, plant.order :] @ arc.output
        values, rates = states @ rows.T, (states @ plant.A.T + np.outer(force, plant.B)) @ rows.T
        inside = hermite_peaks(
            np.full(count, length / count),
            values[:-1],
            values[1:],
            start_rate=rates[:-1],
            end_rate=rates[1:],
        )
        peaks, state = np.maximum(peaks, inside), states[-1]
        force_peak = max(force_peak, float(np.abs(force).max()))
    return Motion(arcs=arcs, final=state, peaks=peaks, force_peak=force_peak)


def _joint(plant: Plant, arc: Arc) -> Array:
    n = plant.order
    joint = np.zeros((n + arc.initial.size, n + arc.initial.size))
    joint[:n, :n], joint[:n, n:] = plant.A, np.outer(plant.B, arc.output)
    joint[n:, n:] = arc.generator
    return joint
