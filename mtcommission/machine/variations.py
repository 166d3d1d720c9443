"""Machines that differ from the nominal one: its corners."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

from mtcommission.machine.machine import Machine


@dataclass(frozen=True, slots=True, kw_only=True)
class Corner:
    """One variation of the machine in which the requirements must hold."""

    payload: float = 0.0  # [kg]
    frequency_factor: float = 1.0  # on all eigenfrequencies [-]
    damping_factor: float = 1.0  # on all damping ratios [-]
    state: str = ""  # name of the measured state; "": as [plant] states the machine


NOMINAL = Corner()
"""The machine exactly as the profile states it: no payload, no spread."""


def vary(machine: Machine, corner: Corner) -> Machine:
    """Return the nominal machine as it is in a corner: with mechanics changed, all else the same.

    Payload adds to the moving mass (and to the rotary inertia if ``payload_radius`` is given);
    the frequency factor s acts through stiffness with damping ratios fixed: k s², d s.

    Source: the project's definition of corners.
    """
    mechanics = machine.mechanics_in(corner.state).vary(
        payload=corner.payload,
        payload_radius=machine.requirements.payload_radius,
        frequency=corner.frequency_factor,
        damping=corner.damping_factor,
    )
    return replace(machine, mechanics=mechanics)


def corners(machine: Machine) -> tuple[Corner, ...]:
    """Return the nominal machine and every combination of the ends of the stated ranges.

    First the nominal one, then payload ends x frequency ends x damping ends, none twice: of the
    machine as [plant] states it, then of each measured state. Its requirements hold the ranges.
    """
    needs = machine.requirements

    def ends(spread: float) -> tuple[float, ...]:
        return (1.0 - spread, 1.0 + spread) if spread else (1.0,)

    combinations = product(
        ("", *(state.name for state in machine.states)),
        dict.fromkeys(needs.payload),
        ends(needs.frequency_spread),
        ends(needs.damping_spread),
    )
    outer = [
        Corner(payload=payload, frequency_factor=frequency, damping_factor=damping, state=state)
        for state, payload, frequency, damping in combinations
    ]
    return tuple(dict.fromkeys([NOMINAL, *outer]))
