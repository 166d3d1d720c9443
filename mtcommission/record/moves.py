"""The moves of a record in the loop, and on machines that differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mtcommission.limits.judge import MoveResult, evaluate_moves
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant, longest_period
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.shape import Words, entry_of, of
from mtcommission.setpoint.setpoint import sample_setpoint

Array = NDArray[np.float64]

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


@dataclass(frozen=True, slots=True, kw_only=True)
class Series:
    """A sampled motion for the plots; ``signals`` by name (F_set, then every state and output)."""

    t: list[float]
    signals: dict[str, list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class InCorner:
    """A machine of the corners: payload, and factors of all frequencies and damping ratios."""

    payload: float = of("corner.payload")
    frequency_factor: float = of("corner.frequency_factor")
    damping_factor: float = of("corner.damping_factor")
    state: str = of("corner.state", default="")  # as the profile names it


@dataclass(frozen=True, slots=True, kw_only=True)
class Segment:
    """One segment of Ruckig's profile."""

    duration: float
    jerk: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointEntry:
    """The setpoint of a move with the recommended limits."""

    duration: float
    setpoint_filter: SetpointFilter | None
    segments: list[Segment]


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

    move: Move
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
    obstacle: str = of(lambda one: getattr(one.limiting_requirement, "key", ""))  # "": none


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
    verdict = evaluate_moves(machine, tuned, results).assessment
    return entry_of(
        SimulationPart, entries[0], moves=entries, warnings=tuned.warnings, assessment=verdict
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
    pairs = zip(setpoint.segment_durations, setpoint.segment_jerks, strict=True)
    segments = [Segment(duration=float(duration), jerk=float(jerk)) for duration, jerk in pairs]
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
    return MoveEntry(
        move=setpoint.move,
        setpoint=entry_of(SetpointEntry, setpoint, setpoint.limits, segments=segments),
        response=responses[0],
        corners=responses,
        series=series_of(
            plant, t, nominal.states[shown], dict(zip(REFERENCES, columns, strict=True))
        ),
    )


def by_name(names: Sequence[str], values: Array) -> dict[str, float]:
    """Return values by the names of signals or states."""
    return dict(zip(names, values.tolist(), strict=True))


def by_mode(plant: Plant, values: ArrayLike) -> dict[str, float]:
    """Return values by the names of the plant's modes."""
    return by_name([mode.name for mode in plant.modes], np.asarray(values, dtype=np.float64))


def rounded(values: Array, digits: int) -> Array:
    """Return values for plots, short to write; of the same shape."""
    return np.array([float(f"{value:.{digits}g}") for value in values.flat]).reshape(values.shape)


def series_of(plant: Plant, t: Array, states: Array, extra: Mapping[str, Array]) -> Series:
    """Return ``extra`` signals, states and outputs, rounded to seven digits: for plots only."""
    columns = {
        **extra,
        **dict(zip(plant.states, states.T, strict=True)),
        **dict(zip(plant.outputs, (states @ plant.C.T).T, strict=True)),
    }
    signals = {name: rounded(column, 7).tolist() for name, column in columns.items()}
    return Series(t=rounded(t, 7).tolist(), signals=signals)
