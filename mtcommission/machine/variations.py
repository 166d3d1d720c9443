"""Machines that differ from the nominal one: its corners, and samples of the same ranges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Machine

Array = NDArray[np.float64]


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Variations:
    """Machines that differ from the nominal one."""

    payload: Array  # shape (n_samples,) [kg]
    frequency_factor: Array  # on all eigenfrequencies, shape (n_samples,) [-]
    damping_factor: Array  # on all damping ratios, shape (n_samples,) [-]
    state: tuple[str, ...]  # of each sample

    def corner(self, index: int) -> Corner:
        """Return one sample as a corner."""
        return Corner(
            payload=float(self.payload[index]),
            frequency_factor=float(self.frequency_factor[index]),
            damping_factor=float(self.damping_factor[index]),
            state=self.state[index],
        )


def draw_variations(machine: Machine, *, samples: int, seed: int) -> Variations:
    """Return machines drawn uniformly from payloads, spreads and measured states."""
    generator, needs = np.random.default_rng(seed), machine.requirements

    def factor(spread: float) -> Array:
        return generator.uniform(1.0 - spread, 1.0 + spread, samples)

    states = ("", *(state.name for state in machine.states))
    return Variations(
        payload=generator.uniform(*needs.payload, samples),
        frequency_factor=factor(needs.frequency_spread),
        damping_factor=factor(needs.damping_spread),
        state=tuple(generator.choice(states, samples).tolist())
        if machine.states
        else ("",) * samples,
    )


def as_variations(places: Sequence[Corner]) -> Variations:
    """Return corners as variations, in the same order."""
    return Variations(
        payload=np.array([corner.payload for corner in places]),
        frequency_factor=np.array([corner.frequency_factor for corner in places]),
        damping_factor=np.array([corner.damping_factor for corner in places]),
        state=tuple(corner.state for corner in places),
    )
