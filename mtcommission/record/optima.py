"""An optimal control -> its entry in the record."""

from __future__ import annotations

from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits.optima import Optima
from mtcommission.optimal.band.force import BandForce
from mtcommission.optimal.solution import (
    Certificate,
    DampingOptimum,
    TimeOptimum,
    control_text,
    sample_trajectory,
    side_text,
)
from mtcommission.plant.plant import Plant
from mtcommission.record.data import describe_move, series_entry
from mtcommission.record.schema.optima import (
    ArcEntry,
    BandEntry,
    ForceSegment,
    LawEntry,
    OptimaEntry,
    OptimumEntry,
    ProofEntry,
    RobustEntry,
    TouchPointEntry,
)
from mtcommission.record.shape import entry_of
from mtcommission.study.within_band import WithinBand

Array = NDArray[np.float64]

PLOT_SAMPLES = 800
"""Samples of an optimal control for its plot."""


def optima_entry(plant: Plant, item: Optima, within: WithinBand) -> OptimaEntry:
    """Return the optima of one move.

    Parameters
    ----------
    plant
        The plant they were computed for.
    item, within
        Exact rest, and the band, of the same move.
    """
    band, robust = within.optimum, within.robust
    return OptimaEntry(
        move=describe_move(item.move),
        time=optimum_entry(plant, item.time),
        constrained=optimum_entry(plant, item.constrained) if item.constrained else None,
        damping=optimum_entry(plant, item.damping) if item.damping else None,
        band=entry_of(BandEntry, band, band.force, segments=_segments(band.force))
        if band
        else None,
        robust=(
            entry_of(RobustEntry, robust, robust.force, segments=_segments(robust.force))
            if robust
            else None
        ),
        remarks=[*item.remarks, *within.remarks],
    )


def _segments(force: BandForce) -> list[ForceSegment]:
    return [
        ForceSegment(duration=arc.t_end - arc.t_start, force=float(arc.output @ arc.initial))
        for arc in force.arcs
    ]


def optimum_entry(plant: Plant, solution: TimeOptimum | DampingOptimum) -> OptimumEntry:
    """Return an optimal control as ``optimal --json`` prints it.

    Parameters
    ----------
    plant
        The plant it was computed for.
    solution
        Time-optimal or damping-optimal.
    """
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / PLOT_SAMPLES)
    shared = {
        "f_max": solution.force_limit,
        "move": describe_move(solution.move),
        "limits": _limits(solution),
        "arcs": [
            entry_of(ArcEntry, arc, control=control_text(arc.control)) for arc in solution.arcs
        ],
        "switching_times": [arc.t_end for arc in solution.arcs[:-1]],
        "peaks": dict(zip(plant.signals, solution.peaks.tolist(), strict=True)),
        "terminal_error": dict(zip(plant.states, solution.terminal_error.tolist(), strict=True)),
        "series": series_entry(plant, motion.t, motion.states, {"F_set": motion.force}),
    }
    if isinstance(solution, TimeOptimum):
        return entry_of(
            OptimumEntry,
            solution,
            **shared,
            kind="time",
            touch_points=[
                TouchPointEntry(t=point.t, limit=side_text(point.signal, point.side))
                for point in solution.touch_points
            ],
            cost=None,
            cost_terms={},
            weights={},
            certificate=_proof_entry(plant, solution.certificate),
        )
    names = ("F_set", *(item.state for item in solution.weights))
    return entry_of(
        OptimumEntry,
        solution,
        **shared,
        kind="damping",
        touch_points=[],
        cost_terms=dict(zip(names, solution.cost_terms.tolist(), strict=True)),
        weights={item.state: item.value for item in solution.weights},
        certificate=LawEntry(
            adjoint_initial=_adjoint(plant, solution.adjoint_initial),
            law_residual=solution.law_residual,
        ),
    )


def _proof_entry(plant: Plant, proof: Certificate) -> ProofEntry:
    rank = proof.terminal_jacobian_rank
    return entry_of(
        ProofEntry,
        proof,
        adjoint_initial=_adjoint(plant, proof.adjoint_initial),
        terminal_jacobian_rank=rank if rank >= 0 else None,
    )


def _limits(solution: TimeOptimum | DampingOptimum) -> dict[str, float]:
    """Return the bounds by name, that of the jerk among them."""
    found = {bound.name: bound.value for bound in solution.bounds}
    if isinstance(solution, TimeOptimum) and isfinite(solution.jerk_limit):
        found["jerk"] = solution.jerk_limit
    return found


def _adjoint(plant: Plant, values: Array) -> dict[str, float]:
    """Return what is known of an adjoint by state."""
    known = zip(plant.states, values.tolist(), strict=True)
    return {state: value for state, value in known if isfinite(value)}
