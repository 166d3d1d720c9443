"""The loop beside the optima -> its entry in the record."""

from __future__ import annotations

from math import isfinite

from mtcommission.loop.simulate.continuous import ContinuousResponse
from mtcommission.loop.simulate.response import LoopResponse
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import Plant
from mtcommission.record.schema.comparisons import (
    ComparedEntry,
    ComparisonEntry,
    ContinuousEntry,
    FedForwardEntry,
)
from mtcommission.record.shape import entry_of
from mtcommission.study.comparison import MoveComparison
from mtcommission.verdict.evaluate import MoveResult


def comparison_entry(
    machine: Machine, plant: Plant, comparison: MoveComparison, result: MoveResult
) -> ComparisonEntry:
    """Return the loop beside the optima of one move, done with the recommended limits, too.

    Parameters
    ----------
    machine, plant
        Nominal.
    comparison, result
        Of the same move.
    """
    return ComparisonEntry(
        controls=[
            entry_of(
                ComparedEntry,
                control,
                peaks=dict(zip(plant.signals, control.peaks.tolist(), strict=True)),
            )
            for control in comparison.controls
        ],
        fed_forward=[
            entry_of(FedForwardEntry, found, found.corner, control=name)
            for name, rows in comparison.fed_forward
            for found in rows
        ],
        claims=list(comparison.claims),
        why_not_the_optimum=list(comparison.why_not_the_optimum),
        continuous=continuous_entry(
            comparison.continuous,
            result.responses[0],
            band=machine.requirements.tcp_deviation,
        ),
    )


def continuous_entry(
    continuous: ContinuousResponse, sampled: LoopResponse, *, band: float
) -> ContinuousEntry:
    """Return what the continuous approximation says beside the sampled loop.

    Parameters
    ----------
    continuous, sampled
        The same setpoint in both, on the nominal machine.
    band
        Permitted TCP deviation [m or rad].

    Returns
    -------
    ContinuousEntry
        ``settling_time`` null where the approximation does not settle.
    """
    # Outside the band at the last sample it has not settled, whatever time was found.
    settles = isfinite(continuous.settling_time) and abs(continuous.deviation[-1]) <= band
    return ContinuousEntry(
        settling_time=continuous.settling_time if settles else None,
        residual_deviation=continuous.residual_deviation,
        settling_difference=(
            continuous.settling_time / sampled.settling_time - 1.0
            if settles and isfinite(sampled.settling_time)
            else None
        ),
        residual_difference=(
            continuous.residual_deviation / sampled.residual_deviation - 1.0
            if isfinite(sampled.residual_deviation)
            else None
        ),
    )
