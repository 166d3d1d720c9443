"""Moves through the loop and their optima -> their entries in the record, and the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TypeVar

import numpy as np

from mtcommission.limits.judge import Assessment, MoveResult, evaluate_moves
from mtcommission.limits.optima import Optima
from mtcommission.loop.simulate import LoopResponse
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Reserve
from mtcommission.machine.variations import Corner
from mtcommission.optimal.band.band_optimum import BandOptimum
from mtcommission.optimal.band.robust import RobustForce
from mtcommission.optimal.solution import (
    DampingOptimum,
    TimeOptimum,
    control_text,
    sample_trajectory,
    side_text,
)
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.record.data import Array, by_mode, by_name, describe_move, filter_entry
from mtcommission.record.schema.comparisons import ComparedEntry, ComparisonEntry, FedForwardEntry
from mtcommission.record.schema.moves import (
    AssessmentPart,
    Check,
    MoveEntry,
    ResponseEntry,
    Segment,
    SetpointEntry,
    SimulationPart,
)
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
from mtcommission.record.schema.values import Series
from mtcommission.record.shape import entry_of
from mtcommission.setpoint.setpoint import sample_setpoint
from mtcommission.study.optimum import MoveComparison, WithinBand

InBand = TypeVar("InBand", BandEntry, RobustEntry)

PLOT_STEP = 0.25e-3
"""Spacing of the samples of a response for its plot [s]; all judgements use every cycle."""

PLOT_TAIL = 0.15
"""What a plot shows after the end of the setpoint at most [s]."""

LEAST_TAIL = 0.4
"""The least of it, as a share of the move [-]; and two periods of the slowest mode."""

PLOT_SAMPLES = 800
"""Samples of an optimal control for its plot."""


def simulation_part(
    machine: Machine, plant: Plant, tuned: TunedLoop, results: Sequence[MoveResult]
) -> SimulationPart:
    """Return what ``simulate --json`` prints, judged like a recommendation; a result each move."""
    entries = [move_entry(plant, tuned, result) for result in results]
    verdict = evaluate_moves(machine, plant, tuned, results).assessment
    return entry_of(
        SimulationPart,
        entries[0],
        moves=entries,
        warnings=tuned.warnings,
        assessment=assessment_part(verdict, machine.requirements.reserve),
    )


def assessment_part(assessment: Assessment, reserve: Reserve) -> AssessmentPart:
    """Return the verdict as the record holds it, with the share that recommendations may use."""
    limiting = assessment.limiting_requirement
    return AssessmentPart(
        met=assessment.is_met,
        checks=[
            entry_of(Check, check, reserve=check.requirement.share(reserve))
            for check in assessment.checks
        ],
        obstacle=limiting.key if limiting else "",
    )


def move_entry(plant: Plant, tuned: TunedLoop, result: MoveResult) -> MoveEntry:
    """Return one move with its limits, run in every corner; its series are thinned out."""
    setpoint, nominal = result.setpoint, result.responses[0]
    every = max(1, round(PLOT_STEP / tuned.controller.velocity_cycle))
    late = nominal.settling_time - nominal.t_end
    tail = max(LEAST_TAIL * nominal.t_end, 2.0 * longest_period(plant), 1.2 * late)
    shown = nominal.t <= nominal.t_end + min(tail, PLOT_TAIL)
    shown[:] &= np.arange(len(shown)) % every == 0
    t = nominal.t[shown]
    delayed = sample_setpoint(setpoint, t - tuned.controller.reference_delay)
    now = sample_setpoint(setpoint, t)
    extra = {
        "x_ref_delayed": delayed[:, 0],
        "v_ref": now[:, 1],
        "a_ref": now[:, 2],
        "j_ref": now[:, 3],
        "deviation": nominal.deviation[shown],
        "F_set": nominal.force[shown],
    }
    durations, jerks = setpoint.segment_durations.tolist(), setpoint.segment_jerks.tolist()
    responses = [
        _response_entry(plant, corner, response)
        for corner, response in zip(tuned.corners, result.responses, strict=True)
    ]
    return MoveEntry(
        move=describe_move(setpoint.move),
        setpoint=SetpointEntry(
            duration=setpoint.duration,
            setpoint_filter=filter_entry(setpoint.setpoint_filter),
            segments=[Segment(duration=d, jerk=j) for d, j in zip(durations, jerks, strict=True)],
        ),
        response=responses[0],
        corners=responses,
        series=_series(plant, t, nominal.states[shown], extra),
    )


def _response_entry(plant: Plant, corner: Corner, response: LoopResponse) -> ResponseEntry:
    return entry_of(
        ResponseEntry,
        corner,
        response,
        mode_amplitudes=by_mode(plant, response.mode_amplitudes),
        peaks=by_name(plant.signals, response.peaks),
    )


def _series(plant: Plant, t: Array, states: Array, extra: dict[str, Array]) -> Series:
    """Signals by name, states and outputs, rounded to seven digits: for plots only.

    ``t``, ``states``: shapes (n_samples,) [s], (n_samples, n_states); ``extra``: further signals
    by name, each of shape (n_samples,).
    """

    def rounded(values: Array) -> list[float]:
        return [float(f"{value:.7g}") for value in values]

    columns = dict(zip(plant.states, states.T, strict=True))
    columns |= dict(zip(plant.outputs, (states @ plant.C.T).T, strict=True))
    signals = {name: rounded(column) for name, column in {**extra, **columns}.items()}
    return Series(t=rounded(t), signals=signals)


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
        series=_series(plant, motion.t, motion.states, {"F_set": motion.force}),
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
