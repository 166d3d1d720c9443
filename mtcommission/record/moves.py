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
from mtcommission.record.data import describe_move, filter_entry, series_entry
from mtcommission.record.schema.moves import (
    AssessmentPart,
    Check,
    MoveEntry,
    ResponseEntry,
    Segment,
    SetpointEntry,
    SimulationPart,
)
from mtcommission.record.shape import entry_of
from mtcommission.setpoint.setpoint import sample_setpoint

PLOT_STEP = 0.25e-3
"""Spacing of the samples of a response for its plot [s]; all judgements use every cycle."""

PLOT_TAIL = 0.15
"""What a plot shows after the end of the setpoint at most [s]."""

LEAST_TAIL = 0.4
"""The least of it, as a share of the move [-]; and two periods of the slowest mode."""


def move_entry(plant: Plant, tuned: TunedLoop, result: MoveResult) -> MoveEntry:
    """Return one move with its limits, as ``simulate --json`` prints it.

    Parameters
    ----------
    plant, tuned
        Nominal plant and the loop in every corner.
    result
        The move, run in every corner.

    Returns
    -------
    MoveEntry
        Series thinned out to ``PLOT_STEP``, for plots.
    """
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
    return MoveEntry(
        move=describe_move(setpoint.move),
        setpoint=SetpointEntry(
            duration=setpoint.duration,
            setpoint_filter=filter_entry(setpoint.setpoint_filter),
            segments=[
                Segment(duration=float(duration), jerk=float(jerk))
                for duration, jerk in zip(
                    setpoint.segment_durations, setpoint.segment_jerks, strict=True
                )
            ],
        ),
        response=_response_entry(plant, tuned.corners[0], nominal),
        corners=[
            _response_entry(plant, corner, response)
            for corner, response in zip(tuned.corners, result.responses, strict=True)
        ],
        series=series_entry(plant, t, nominal.states[shown], extra),
    )


def _response_entry(plant: Plant, corner: Corner, response: LoopResponse) -> ResponseEntry:
    return entry_of(
        ResponseEntry,
        corner,
        response,
        mode_amplitudes={
            mode.name: float(amplitude)
            for mode, amplitude in zip(plant.modes, response.mode_amplitudes, strict=True)
        },
        peaks=dict(zip(plant.signals, response.peaks.tolist(), strict=True)),
    )


def simulation_part(
    machine: Machine, plant: Plant, tuned: TunedLoop, results: Sequence[MoveResult]
) -> SimulationPart:
    """Return what ``simulate --json`` prints, judged like a recommendation.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant, and the loop that the moves went through.
    results
        One for each move.
    """
    entries = [move_entry(plant, tuned, result) for result in results]
    verdict = evaluate_moves(machine, plant, tuned, results).assessment
    return SimulationPart(
        setpoint=entries[0].setpoint,
        response=entries[0].response,
        corners=entries[0].corners,
        moves=entries,
        warnings=list(tuned.warnings),
        assessment=assessment_part(verdict, machine.requirements.reserve),
    )


def assessment_part(assessment: Assessment, reserve: Reserve) -> AssessmentPart:
    """Return the verdict as the record holds it, with the share that recommendations may use."""
    limiting = assessment.limiting_requirement
    return AssessmentPart(
        met=assessment.is_met,
        checks=[
            entry_of(
                Check,
                check,
                met=check.is_met,
                reserve=check.requirement.share(reserve),
            )
            for check in assessment.checks
        ],
        obstacle=limiting.key if limiting else "",
    )
