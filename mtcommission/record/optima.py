"""Optima of moves, and the loop beside them -> their entries in the record."""

from __future__ import annotations

from math import isfinite
from typing import TypeVar

from mtcommission.limits.optima import Optima
from mtcommission.optimal.band.band_optimum import BandOptimum
from mtcommission.optimal.band.robust import RobustForce
from mtcommission.optimal.solution import (
    DampingOptimum,
    TimeOptimum,
    control_text,
    sample_trajectory,
    side_text,
)
from mtcommission.plant.plant import Plant
from mtcommission.record.data import Array, by_name, describe_move
from mtcommission.record.moves import series_entry
from mtcommission.record.schema.comparisons import ComparedEntry, ComparisonEntry, FedForwardEntry
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
from mtcommission.study.optimum import MoveComparison, WithinBand

InBand = TypeVar("InBand", BandEntry, RobustEntry)

PLOT_SAMPLES = 800
"""Samples of an optimal control for its plot."""


def comparison_entry(plant: Plant, comparison: MoveComparison) -> ComparisonEntry:
    """Return the loop beside the optima of one move."""
    return entry_of(
        ComparisonEntry,
        comparison,
        controls=[
            entry_of(ComparedEntry, control, peaks=by_name(plant.signals, control.peaks))
            for control in comparison.controls
        ],
        fed_forward=[
            entry_of(FedForwardEntry, found, found.corner, control=name)
            for name, rows in comparison.fed_forward
            for found in rows
        ],
    )


def optima_entry(plant: Plant, item: Optima, within: WithinBand) -> OptimaEntry:
    """Return the optima of one move: at exact rest, and within the band."""
    band, robust = within.optimum, within.robust
    return OptimaEntry(
        move=describe_move(item.move),
        time=optimum_entry(plant, item.time),
        constrained=optimum_entry(plant, item.constrained) if item.constrained else None,
        damping=optimum_entry(plant, item.damping) if item.damping else None,
        band=_within(BandEntry, band) if band else None,
        robust=_within(RobustEntry, robust) if robust else None,
        remarks=[*item.remarks, *within.remarks],
    )


def _within(form: type[InBand], found: BandOptimum | RobustForce) -> InBand:
    segments = [
        ForceSegment(duration=arc.t_end - arc.t_start, force=float(arc.output @ arc.initial))
        for arc in found.force.arcs
    ]
    return entry_of(form, found, found.force, segments=segments)


def optimum_entry(plant: Plant, solution: TimeOptimum | DampingOptimum) -> OptimumEntry:
    """Return an optimal control of a plant as ``optimal --json`` prints it."""
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / PLOT_SAMPLES)
    found = (
        _time_optimal(plant, solution)
        if isinstance(solution, TimeOptimum)
        else _damping_optimal(plant, solution)
    )
    limits = {bound.name: bound.value for bound in solution.bounds}
    if isinstance(solution, TimeOptimum) and isfinite(solution.jerk_limit):
        limits["jerk"] = solution.jerk_limit
    return entry_of(
        OptimumEntry,
        solution,
        f_max=solution.force_limit,
        move=describe_move(solution.move),
        limits=limits,
        arcs=[entry_of(ArcEntry, arc, control=control_text(arc.control)) for arc in solution.arcs],
        switching_times=[arc.t_end for arc in solution.arcs[:-1]],
        peaks=by_name(plant.signals, solution.peaks),
        terminal_error=by_name(plant.states, solution.terminal_error),
        series=series_entry(plant, motion.t, motion.states, {"F_set": motion.force}),
        **found,
    )


def _time_optimal(plant: Plant, solution: TimeOptimum) -> dict[str, object]:
    """What a time-optimal control alone has."""
    proof = solution.certificate
    rank = proof.terminal_jacobian_rank
    return {
        "kind": "time",
        "touch_points": [
            TouchPointEntry(t=point.t, limit=side_text(point.signal, point.side))
            for point in solution.touch_points
        ],
        "cost": None,
        "cost_terms": {},
        "weights": {},
        "certificate": entry_of(
            ProofEntry,
            proof,
            adjoint_initial=_known(plant, proof.adjoint_initial),
            terminal_jacobian_rank=rank if rank >= 0 else None,
        ),
    }


def _damping_optimal(plant: Plant, solution: DampingOptimum) -> dict[str, object]:
    """What a damping-optimal control alone has."""
    names = ("F_set", *(item.state for item in solution.weights))
    return {
        "kind": "damping",
        "touch_points": [],
        "cost_terms": by_name(names, solution.cost_terms),
        "weights": {item.state: item.value for item in solution.weights},
        "certificate": LawEntry(
            adjoint_initial=_known(plant, solution.adjoint_initial),
            law_residual=solution.law_residual,
        ),
    }


def _known(plant: Plant, values: Array) -> dict[str, float]:
    """What is known of an adjoint, by state."""
    adjoint = by_name(plant.states, values)
    return {state: value for state, value in adjoint.items() if isfinite(value)}
