"""LoopResponse + requirements -> Assessment: a failed one is a result, not an error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite

from mtcommission.loop.analysis.quantisation import SIGMAS
from mtcommission.loop.simulate import LoopResponse
from mtcommission.machine.machine import Machine, Reserve, VelocityStep
from mtcommission.machine.requirement import (
    CONTOUR_DEVIATION,
    RESIDUAL_DEVIATION,
    RMS_FORCE,
    SET_FORCE,
    SETTLING_TIME,
    Requirement,
    peak_of,
)
from mtcommission.machine.variations import NOMINAL, Corner
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.verdict.every_size import SizeCheck

LAST_DIGIT = 1e-9
"""An acceleration of just what the motor follows comes back with rounding errors [-]."""

ROUNDING = 1e-6
"""Relative difference that search and simulation may have where a reserve is just kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against the worst that was found.

    Parameters
    ----------
    requirement
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

    requirement: Requirement
    value: float
    limit: float
    unit: str
    is_met: bool
    where: Message

    @property
    def name(self) -> str:
        """Name of the requirement in records."""
        return self.requirement.value


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
    def limiting_requirement(self) -> Requirement | None:
        """The requirement missed by the largest factor; None if all are met."""
        missed = [check for check in self.checks if not check.is_met]
        worst = max(missed, key=lambda check: check.value / check.limit, default=None)
        return worst.requirement if worst else None

    def keeps(self, reserve: Reserve) -> bool:
        """Return whether no requirement needs more than a reserve leaves."""
        return all(
            check.value <= (1.0 + ROUNDING) * check.requirement.usable_share(reserve) * check.limit
            for check in self.checks
        )

    def check_of(self, requirement: Requirement) -> Check:
        """Return the check of one requirement."""
        return next(check for check in self.checks if check.requirement == requirement)


def assess(
    machine: Machine,
    plant: Plant,
    corners: Sequence[Corner],
    responses: Sequence[Sequence[LoopResponse]],
    *,
    sizes: Sequence[SizeCheck] = (),
) -> Assessment:
    """Return the verdict on the responses of all moves in all corners, encoder noise included.

    Parameters
    ----------
    machine, plant
        The nominal machine, whose requirements count, and its plant.
    corners
        Where the responses were taken.
    responses
        ``responses[move][corner]``.
    sizes
        The worst of all smaller moves, where they count.

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

    def worst(requirement: Requirement, limit: float, unit: str, values: Sequence[float]) -> Check:
        value, where = max(
            ((value, where) for value, (_, where) in zip(values, found, strict=True)),
            key=lambda pair: pair[0],
        )
        smaller = next((item for item in sizes if item.requirement == requirement), None)
        if smaller is not None and smaller.value > value:
            value, where = smaller.value, _describe_size(machine, smaller)
        return Check(
            requirement=requirement,
            value=value,
            limit=limit,
            unit=unit,
            is_met=value <= (1.0 + LAST_DIGIT) * limit,
            where=where,
        )

    residuals = [response.residual_deviation + response.tool_noise for response, _ in found]
    checks = [worst(RESIDUAL_DEVIATION, needs.tcp_deviation, length, residuals)]
    if isfinite(needs.max_settling_time):
        settling = [response.settling_time for response, _ in found]
        checks.append(worst(SETTLING_TIME, needs.max_settling_time, "s", settling))
    if isfinite(needs.contour_deviation):
        contours = [response.contour_deviation + response.tool_noise for response, _ in found]
        checks.append(worst(CONTOUR_DEVIATION, needs.contour_deviation, length, contours))
    for peak in needs.peaks:
        column = plant.signals.index(peak.name)
        values = [float(response.peaks[column]) for response, _ in found]
        checks.append(worst(peak_of(peak.name), peak.bound, plant.signal_units[column], values))
    forces = [response.max_force + response.force_noise for response, _ in found]
    checks.append(worst(SET_FORCE, drive.motion_force, force, forces))
    if isfinite(drive.continuous_force):
        rms = [hypot(r.rms_force, r.force_noise / SIGMAS) for r, _ in found]
        checks.append(worst(RMS_FORCE, drive.continuous_force, force, rms))
    return Assessment(checks=tuple(checks))


def _describe_size(machine: Machine, check: SizeCheck) -> Message:
    is_step = isinstance(machine.moves[check.move - 1], VelocityStep)
    size = Message("place-velocity-step" if is_step else "place-distance", size=check.size)
    return describe_place(check.move, check.corner, len(machine.moves), size)


def describe_place(move: int, corner: Corner, n_moves: int, size: Message | None = None) -> Message:
    """Return where a value was found, e.g. ``move 2, payload 100 kg, frequencies × 0.95``."""
    parts = [Message("place-move", number=move)] if n_moves > 1 else []
    if size is not None:
        parts.append(size)
    if corner == NOMINAL:
        return Message("place", parts=(*parts, Message("place-nominal")))
    parts.append(Message("place-payload", payload=corner.payload))
    if corner.frequency_factor != 1.0:
        parts.append(Message("place-frequencies", factor=corner.frequency_factor))
    if corner.damping_factor != 1.0:
        parts.append(Message("place-damping", factor=corner.damping_factor))
    return Message("place", parts=tuple(parts))
