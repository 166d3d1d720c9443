"""The simulated moves of a record, and the verdict on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from mtcommission.limits.judge import MoveResult, evaluate_moves
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant, longest_period
from mtcommission.record.shape import entry_of, of
from mtcommission.record.values import (
    InCorner,
    Series,
    SetpointFilterEntry,
    Words,
    by_mode,
    by_name,
    describe_move,
    series_of,
)
from mtcommission.setpoint.setpoint import Setpoint, sample_setpoint

REFERENCES = ("x_ref_delayed", "v_ref", "a_ref", "j_ref", "deviation", "F_set")
"""Signals of a simulated move beside those of the plant."""

PLOT_STEP = 0.25e-3
"""Spacing of the samples of a response for its plot [s]; all judgements use every cycle."""

PLOT_SAMPLES = 8000
"""So many of them at most: those of a move of a second are all kept."""

PLOT_TAIL = 0.15
"""What a plot shows after the end of the setpoint at most [s]."""

LEAST_TAIL = 0.4
"""The least of it, as a share of the move [-]; and two periods of the slowest mode."""


def _segments(setpoint: Setpoint) -> list[Segment]:
    pairs = zip(setpoint.segment_durations.tolist(), setpoint.segment_jerks.tolist(), strict=True)
    return [Segment(duration=duration, jerk=jerk) for duration, jerk in pairs]


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One segment of Ruckig's profile."""

    duration: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointEntry:
    """The setpoint of a move with the recommended limits."""

    duration: float
    setpoint_filter: SetpointFilterEntry | None
    segments: list[Segment] = of(_segments)


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseEntry(InCorner):
    """A closed-loop response in one corner."""

    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    mode_amplitudes: dict[str, float]
    peaks: dict[str, float]
    max_force: float
    rms_force: float
    saturated: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveEntry:
    """One move with the recommended limits: nominal response, corners, motion for the plots."""

    move: dict[str, float] = of("setpoint.move", by=describe_move)
    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    series: Series


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against what was found."""

    name: str
    value: float | None  # None: not settled
    limit: float
    reserve: float  # share of the limit that a recommendation may use [-]
    unit: str
    met: bool
    where: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class AssessmentPart:
    """The verdict."""

    met: bool
    checks: list[Check]
    obstacle: str = of("limiting_requirement", by=lambda one: one.key if one else "")  # "": none


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationPart:
    """What ``simulate`` prints: the first move's setpoint and response, and all moves."""

    setpoint: SetpointEntry
    response: ResponseEntry
    corners: list[ResponseEntry]
    moves: list[MoveEntry]
    warnings: list[Words]  # what is poor about the loop
    assessment: AssessmentPart


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
        assessment=verdict,
    )


def move_entry(plant: Plant, tuned: TunedLoop, result: MoveResult) -> MoveEntry:
    """Return one move with its limits, run in every corner; its series are thinned out."""
    setpoint, nominal = result.setpoint, result.responses[0]
    every = max(1, round(PLOT_STEP / tuned.controller.velocity_cycle))
    late = nominal.settling_time - nominal.t_end
    tail = max(LEAST_TAIL * nominal.t_end, 2.0 * longest_period(plant), 1.2 * late)
    shown = np.flatnonzero(nominal.t <= nominal.t_end + min(tail, PLOT_TAIL))
    shown = shown[:: max(every, ceil(len(shown) / PLOT_SAMPLES))]
    t = nominal.t[shown]
    delayed = sample_setpoint(setpoint, t - tuned.controller.reference_delay)
    now = sample_setpoint(setpoint, t)
    columns = (delayed[:, 0], *now[:, 1:4].T, nominal.deviation[shown], nominal.force[shown])
    responses = [
        entry_of(
            ResponseEntry,
            corner,
            response,
            mode_amplitudes=by_mode(plant, response.mode_amplitudes),
            peaks=by_name(plant.signals, response.peaks),
        )
        for corner, response in zip(tuned.corners, result.responses, strict=True)
    ]
    references = dict(zip(REFERENCES, columns, strict=True))
    return entry_of(
        MoveEntry,
        result,
        response=responses[0],
        corners=responses,
        series=series_of(plant, t, nominal.states[shown], references),
    )
