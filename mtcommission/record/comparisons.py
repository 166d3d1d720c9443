"""The loop beside the optima -> its entry in the record."""

from __future__ import annotations

from mtcommission.limits.judge import MoveResult
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import Plant
from mtcommission.record.schema.comparisons import (
    ComparedEntry,
    ComparisonEntry,
    FedForwardEntry,
)
from mtcommission.record.shape import entry_of
from mtcommission.study.comparison import MoveComparison


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
    )
