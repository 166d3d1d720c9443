"""How large a state or output of the plant gets: one requirement for each that is bounded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Requirement, Swing, Yields
from mtcommission.loop.respond import Signal, output_of_states
from mtcommission.machine.machine import Machine


def peak_of(signal: str) -> Requirement:
    """Return the requirement on the largest magnitude of a state or output."""

    def bound(machine: Machine) -> float:
        peaks = machine.requirements.peaks
        return next((peak.bound for peak in peaks if peak.name == signal), inf)

    def with_bound(machine: Machine, bound: float) -> Machine:
        peaks = tuple(
            replace(peak, bound=bound) if peak.name == signal else peak
            for peak in machine.requirements.peaks
        )
        return replace(machine, requirements=replace(machine.requirements, peaks=peaks))

    return Requirement(
        key=f"peak {signal}",
        message=Message("requirement-peak", signal=signal),
        unit=lambda _, plant: plant.unit(signal),
        bound=bound,
        with_bound=with_bound,
        share=lambda reserve: reserve.band,
        value=lambda response, plant: float(response.peaks[plant.signals.index(signal)]),
        by_poles=lambda plant: Swing(signal=Signal(row=output_of_states(plant.row(signal)))),
        yields=Yields.IF_ASKED,
    )


def peaks_of(machine: Machine) -> Iterator[Requirement]:
    """Yield one for each bounded state or output, in the profile's order."""
    return (peak_of(peak.name) for peak in machine.requirements.peaks)
