"""The loop beside the optima -> its entry in the record."""

from __future__ import annotations

from mtcommission.commission import MoveComparison
from mtcommission.plant import Plant
from mtcommission.record.optima import finite_or_none
from mtcommission.record.schema import (
    ComparedEntry,
    ComparisonEntry,
    ContinuousEntry,
    FedForwardEntry,
)


def comparison_entry(plant: Plant, comparison: MoveComparison) -> ComparisonEntry:
    """Return the loop beside the optima of one move."""
    return ComparisonEntry(
        controls=[
            ComparedEntry(
                name=control.name,
                transfer_time=finite_or_none(control.transfer_time),
                overshoot=control.overshoot,
                peaks=dict(zip(plant.signals, control.peaks.tolist(), strict=True)),
                max_force=control.max_force,
                heat=control.heat,
                work=control.work,
            )
            for control in comparison.controls
        ],
        fed_forward=[
            FedForwardEntry(
                control=name,
                payload=found.corner.payload,
                frequency_factor=found.corner.frequency_factor,
                damping_factor=found.corner.damping_factor,
                settling_time=finite_or_none(found.settling_time),
                residual_deviation=found.residual_deviation,
                peak_deviation=found.peak_deviation,
                saturated_share=found.saturated_share,
            )
            for name, rows in comparison.fed_forward
            for found in rows
        ],
        continuous=ContinuousEntry(
            settling_time=finite_or_none(comparison.continuous.settling_time),
            residual_deviation=comparison.continuous.residual_deviation,
        ),
    )
