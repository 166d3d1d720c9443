"""The optimal controls of a record."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import (
    AnyOptimum,
    Certificate,
    control_text,
    join_arcs,
    sample_trajectory,
    side_text,
)
from mtcommission.record.moves import Series, by_name, series_of
from mtcommission.record.shape import Words, entry_of, of

if TYPE_CHECKING:  # the optima's own libraries take a while to load
    from mtcommission.limits.optima import Optima, WithinBand

PLOT_SAMPLES = 800
"""Samples of an optimal control for its plot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcEntry:
    """An arc of an optimal control."""

    t_start: float
    t_end: float
    control: str = of(lambda arc: control_text(arc.control))


@dataclass(frozen=True, slots=True, kw_only=True)
class TouchPointEntry:
    """Where a limit is touched for a moment."""

    t: float
    limit: str = of(lambda point: side_text(point.signal, point.side))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProofEntry:
    """What proves a least time, or that a damping-optimal control keeps its law; None: neither."""

    t_f_lower_bound: float | None = None
    relative_gap: float | None = None
    adjoint_initial: dict[str, float]
    switching_law_holds: bool | None = None
    terminal_jacobian_rank: int | None = None
    law_residual: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimumEntry:
    """An optimal control as ``optimal --json`` prints it, with its motion for the plots."""

    kind: str
    method: str
    f_max: float = of("force_limit")
    move: Move
    limits: dict[str, float]
    t_f: float
    arcs: list[ArcEntry]
    switching_times: list[float]
    touch_points: list[TouchPointEntry]
    peaks: dict[str, float]
    terminal_error: dict[str, float]
    cost: float | None
    weights: dict[str, float]
    certificate: ProofEntry
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class BandEntry:
    """The fastest control to a state from which the free motion keeps the tool within the band."""

    t_f: float
    band: float
    lower_bound: float  # proved; 0: nothing is


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimaEntry:
    """The optima of one move; ``remarks`` say why one was not found."""

    move: Move
    time: OptimumEntry
    constrained: OptimumEntry | None  # None: the profile bounds no peaks
    damping: OptimumEntry | None
    band: BandEntry | None
    robust: BandEntry | None  # None where there is no spread, too
    remarks: list[Words]


def optima_entry(plant: Plant, item: Optima, within: WithinBand) -> OptimaEntry:
    """Return the optima of one move: at exact rest, and within the band."""
    found = {"time": item.time, "constrained": item.constrained, "damping": item.damping}
    return entry_of(
        OptimaEntry,
        item,
        band=within.optimum,
        robust=within.robust,
        remarks=[*item.remarks, *within.remarks],
        **{key: one and optimum_entry(plant, one) for key, one in found.items()},
    )


def optimum_entry(plant: Plant, solution: AnyOptimum) -> OptimumEntry:
    """Return an optimal control of a plant as ``optimal --json`` prints it."""
    motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / PLOT_SAMPLES)
    limits = {bound.name: bound.value for bound in solution.bounds}
    if isfinite(solution.jerk_limit):
        limits["jerk"] = solution.jerk_limit
    weights = {item.name: item.value for item in solution.weights}
    proof, arcs = solution.certificate, join_arcs(solution.arcs)
    adjoint = by_name(plant.states, proof.adjoint_initial)
    rank = proof.terminal_jacobian_rank if isinstance(proof, Certificate) else -1
    return entry_of(
        OptimumEntry,
        solution,
        limits=limits,
        arcs=arcs,
        switching_times=[arc.t_end for arc in arcs[:-1]],
        peaks=by_name(plant.signals, solution.peaks),
        terminal_error=by_name(plant.states, solution.terminal_error),
        certificate=entry_of(
            ProofEntry,
            proof,
            adjoint_initial={state: one for state, one in adjoint.items() if isfinite(one)},
            terminal_jacobian_rank=None if rank < 0 else rank,
        ),
        series=series_of(plant, motion.t, motion.states, {"F_set": motion.force}),
        weights=weights,
    )
