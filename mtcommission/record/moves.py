"""Moves through the loop -> their entries in the record, and the verdict."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mtcommission.limits.judge import Assessment, MoveResult, evaluate_moves
from mtcommission.loop.simulate import LoopResponse
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Reserve
from mtcommission.machine.variations import Corner
from mtcommission.plant.plant import Plant, longest_period
from mtcommission.record.data import Array, by_mode, by_name, describe_move, filter_entry
from mtcommission.record.schema.moves import (
    AssessmentPart,
    Check,
    MoveEntry,
    ResponseEntry,
    Segment,
    SetpointEntry,
    SimulationPart,
)
from mtcommission.record.schema.values import Series
from mtcommission.record.shape import entry_of
from mtcommission.setpoint.setpoint import sample_setpoint

PLOT_STEP = 0.25e-3
"""Spacing of the samples of a response for its plot [s]; all judgements use every cycle."""

PLOT_TAIL = 0.15
"""What a plot shows after the end of the setpoint at most [s]."""

LEAST_TAIL = 0.4
"""The least of it, as a share of the move [-]; and two periods of the slowest mode."""


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
        series=series_entry(plant, t, nominal.states[shown], extra),
    )


def _response_entry(plant: Plant, corner: Corner, response: LoopResponse) -> ResponseEntry:
    return entry_of(
        ResponseEntry,
        corner,
        response,
        mode_amplitudes=by_mode(plant, response.mode_amplitudes),
        peaks=by_name(plant.signals, response.peaks),
    )


def series_entry(plant: Plant, t: Array, states: Array, extra: dict[str, Array]) -> Series:
    """Return signals by name, states and outputs, rounded to seven digits: for plots only.

    ``t``, ``states``: shapes (n_samples,) [s], (n_samples, n_states); ``extra``: further signals
    by name, each of shape (n_samples,).
    """

    def rounded(values: Array) -> list[float]:
        return [float(f"{value:.7g}") for value in values]

    columns = dict(zip(plant.states, states.T, strict=True))
    columns |= dict(zip(plant.outputs, (states @ plant.C.T).T, strict=True))
    signals = {name: rounded(column) for name, column in {**extra, **columns}.items()}
    return Series(t=rounded(t), signals=signals)
