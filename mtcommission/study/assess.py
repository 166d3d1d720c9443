"""LoopResponse + requirements -> Assessment: a failed one is a result, not an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from mtcommission.loop.simulate.response import LoopResponse
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import NOMINAL, Corner
from mtcommission.plant.plant import Plant


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against the worst that was found.

    Parameters
    ----------
    name
        What is required.
    value
        Worst over all moves and corners; inf if the response never settles.
    limit
        Largest allowed value.
    unit
        SI unit of both.
    is_met
        Whether value <= limit.
    where
        Move and corner of the worst value.
    """

    name: str
    value: float
    limit: float
    unit: str
    is_met: bool
    where: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessment:
    """The verdict over all moves and corners.

    Parameters
    ----------
    checks
        One for each requirement.
    """

    checks: tuple[Check, ...]

    @property
    def is_met(self) -> bool:
        """Whether every requirement is met."""
        return all(check.is_met for check in self.checks)

    @property
    def obstacle(self) -> str:
        """The requirement missed by the largest factor; "" if all are met."""
        missed = [check for check in self.checks if not check.is_met]
        if not missed:
            return ""
        return max(missed, key=lambda check: check.value / check.limit).name


def assess(
    machine: Machine,
    plant: Plant,
    corners: Sequence[Corner],
    responses: Sequence[Sequence[LoopResponse]],
) -> Assessment:
    """Return the verdict on the responses of all moves in all corners.

    Parameters
    ----------
    machine, plant
        The nominal machine, whose requirements count, and its plant.
    corners
        Where the responses were taken.
    responses
        ``responses[move][corner]``.

    Returns
    -------
    Assessment
    """
    needs, drive = machine.requirements, machine.drive
    length, force = machine.axis_units.length.si, machine.axis_units.force.si
    found = [
        (response, describe_place(number, corner, len(machine.moves)))
        for number, row in enumerate(responses, start=1)
        for corner, response in zip(corners, row, strict=True)
    ]

    def worst(name: str, limit: float, unit: str, values: Sequence[float]) -> Check:
        value, where = max(
            ((value, where) for value, (_, where) in zip(values, found, strict=True)),
            key=lambda pair: pair[0],
        )
        return Check(
            name=name, value=value, limit=limit, unit=unit, is_met=value <= limit, where=where
        )

    residuals = [response.residual_deviation for response, _ in found]
    checks = [worst("residual deviation", needs.tcp_deviation, length, residuals)]
    if isfinite(needs.max_settling_time):
        settling = [response.settling_time for response, _ in found]
        checks.append(worst("settling time", needs.max_settling_time, "s", settling))
    for peak in needs.peaks:
        column = plant.signals.index(peak.name)
        values = [float(response.peaks[column]) for response, _ in found]
        checks.append(worst(f"peak {peak.name}", peak.bound, plant.signal_units[column], values))
    forces = [response.max_force for response, _ in found]
    checks.append(worst("set force", drive.motion_force, force, forces))
    if isfinite(drive.continuous_force):
        rms = [response.rms_force for response, _ in found]
        checks.append(worst("RMS force", drive.continuous_force, force, rms))
    return Assessment(checks=tuple(checks))


def describe_place(move: int, corner: Corner, n_moves: int) -> str:
    """Return where a value was found, e.g. ``move 2, payload 100 kg, frequencies x 0.95``."""
    parts = [f"move {move}"] if n_moves > 1 else []
    if corner == NOMINAL:
        return ", ".join([*parts, "nominal"])
    parts.append(f"payload {corner.payload:g} kg")
    if corner.frequency_factor != 1.0:
        parts.append(f"frequencies x {corner.frequency_factor:g}")
    if corner.damping_factor != 1.0:
        parts.append(f"damping x {corner.damping_factor:g}")
    return ", ".join(parts)
