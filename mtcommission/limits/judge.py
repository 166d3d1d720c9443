"""Limits through the loop: every move in every corner, and the verdict on every requirement.

A requirement that is missed is a result, not an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.limits.every_size import SizeCheck, judge_sizes
from mtcommission.limits.requirements import Requirement, requirements_of
from mtcommission.loop.disturbance import encoder_noise
from mtcommission.loop.simulate import LoopResponse, simulate_corners
from mtcommission.loop.tuning.tuned import TunedLoop, describe_corner
from mtcommission.machine.machine import Corner, Machine
from mtcommission.machine.moves import Move, VelocityStep
from mtcommission.machine.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Setpoint, plan_within

Array = NDArray[np.float64]

LAST_DIGIT = 1e-9
"""An acceleration of just what the motor follows comes back with rounding errors [-]."""

ROUNDING = 1e-6
"""Relative difference that search and simulation may have where a reserve is just kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One requirement against the worst that was found."""

    requirement: Requirement
    value: float  # worst over all moves and corners [unit]; inf if the response never settles
    limit: float  # largest allowed value [unit]
    reserve: float  # share of the limit that a recommendation may use [-]
    unit: str  # SI
    is_met: bool
    where: Message  # move and corner of the worst value

    @property
    def name(self) -> str:
        """Name of the requirement in records."""
        return self.requirement.key


@dataclass(frozen=True, slots=True, kw_only=True)
class Assessment:
    """The verdict over all moves and corners: one check for each requirement."""

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

    @property
    def keeps_reserve(self) -> bool:
        """Whether no requirement needs more than a recommendation may use."""
        return all(
            check.value <= (1.0 + ROUNDING) * check.reserve * check.limit for check in self.checks
        )

    def check_of(self, requirement: Requirement) -> Check:
        """Return the check of one requirement."""
        return next(check for check in self.checks if check.requirement == requirement)


def assess(
    machine: Machine,
    plant: Plant,
    corners: Sequence[Corner],
    values: Sequence[Array],
    *,
    sizes: Sequence[SizeCheck] = (),
) -> Assessment:
    """Return the verdict on all moves in all corners, encoder noise included.

    ``values``: of each move, shape (n_requirements, n_corners), as ``requirements_of`` the machine
    lists them; ``sizes``: the worst of all smaller moves, where they count.
    """
    smaller = {item.requirement: item for item in sizes}
    checks, count = [], len(machine.moves)
    by_requirement = np.swapaxes(np.array(values), 0, 1)
    for requirement, found in zip(requirements_of(machine), by_requirement, strict=True):
        move, corner = divmod(int(found.argmax()), len(corners))
        value, limit = float(found[move, corner]), requirement.bound(machine)
        where = describe_place(move + 1, corners[corner], count)
        item = smaller.get(requirement)
        if item is not None and item.value > value:
            is_step = isinstance(machine.moves[item.move - 1], VelocityStep)
            kind = "place-velocity-step" if is_step else "place-distance"
            size = Message(kind, size=item.size)
            value, where = item.value, describe_place(item.move, item.corner, count, size)
        checks.append(
            Check(
                requirement=requirement,
                value=value,
                limit=limit,
                reserve=requirement.share(machine.requirements.reserve),
                unit=requirement.unit(machine, plant),
                is_met=value <= (1.0 + LAST_DIGIT) * limit,
                where=where,
            )
        )
    return Assessment(checks=tuple(checks))


def describe_place(move: int, corner: Corner, n_moves: int, size: Message | None = None) -> Message:
    """Return where a value was found, e.g. ``move 2, payload 100 kg, frequencies × 0.95``."""
    parts = [Message("place-move", number=move)] if n_moves > 1 else []
    parts += [size] if size else []
    return Message("place", parts=(*parts, *describe_corner(corner)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MoveResult:
    """One move with some limits, in every corner, the nominal machine first."""

    setpoint: Setpoint  # what the control sends
    responses: tuple[LoopResponse, ...]  # the plant's states of the first one only
    values: Array  # of each requirement, noise included, shape (n_requirements, n_corners)


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """Limits through the same loop, corners and judgement as the recommendation."""

    limits: MotionLimits
    settling_time: float  # worst over moves and corners [s]
    residual_deviation: float  # likewise [m]
    peak_deviation: float  # likewise [m]
    assessment: Assessment
    sizes: tuple[SizeCheck, ...] = ()  # worst of all smaller moves, where they count; else empty
    name: Message | None = None  # what they are and who says so, where shown beside others
    source: Message | None = None


def simulate_moves(
    machine: Machine, tuned: TunedLoop, limits: MotionLimits
) -> tuple[MoveResult, ...]:
    """Return every move with these limits, simulated in every corner."""
    resolution, plant = machine.drive.encoder_resolution, tuned.plant
    noises = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    plan = plan_within(machine, limits)

    def run(setpoint: Setpoint) -> list[LoopResponse]:
        band = machine.requirements.tcp_deviation
        return simulate_corners(tuned.loops, setpoint, drive=machine.drive, band=band)

    found = []
    for move in machine.moves:
        setpoint = plan(move)
        responses: dict[Move, list[LoopResponse]] = {move: run(setpoint)}
        values = []
        for requirement in requirements_of(machine):
            judged = requirement.judged(machine, move)
            if judged not in responses:
                responses[judged] = run(plan(judged))
            own = np.array([requirement.value(one, plant) for one in responses[judged]])
            values.append(requirement.noisy(own, noises))
        first, *others = responses[move]
        # Of all corners that ring for long, the states would be a gigabyte; views keep all outputs.
        lean = [replace(one, states=one.states[:0].copy()) for one in others]
        first = replace(first, states=first.states.copy())
        found.append(
            MoveResult(setpoint=setpoint, responses=(first, *lean), values=np.array(values))
        )
    return tuple(found)


def evaluate(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> Candidate:
    """Return what some limits do in the same loop, corners and judgement as all others."""
    return evaluate_moves(machine, tuned, simulate_moves(machine, tuned, limits))


def evaluate_moves(
    machine: Machine,
    tuned: TunedLoop,
    moves: Sequence[MoveResult],
    *,
    sizes: Sequence[SizeCheck] | None = None,
) -> Candidate:
    """Return the same where the moves have been simulated already, with the first one's limits.

    ``sizes``: the worst of all smaller moves, where that is known already.
    """
    everywhere = [response for result in moves for response in result.responses]
    limits, values = moves[0].setpoint.limits, [result.values for result in moves]
    if not machine.requirements.every_size:
        sizes = ()
    elif sizes is None:
        sizes = judge_sizes(machine, tuned, limits)
    return Candidate(
        limits=limits,
        settling_time=max(response.settling_time for response in everywhere),
        residual_deviation=max(response.residual_deviation for response in everywhere),
        peak_deviation=max(response.peak_deviation for response in everywhere),
        assessment=assess(machine, tuned.plant, tuned.corners, values, sizes=sizes),
        sizes=tuple(sizes),
    )
