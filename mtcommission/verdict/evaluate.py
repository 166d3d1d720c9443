"""Limits through the loop: every move in every corner, judged like a recommendation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.quantisation import encoder_noise
from mtcommission.loop.simulate import LoopResponse, simulate_corners
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine, Move
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.requirements.register import requirements_of
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Plan, Setpoint, plan_within
from mtcommission.verdict.assess import Assessment, assess
from mtcommission.verdict.every_size import SizeCheck, judge_every_size

Array = NDArray[np.float64]


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
    return simulate_planned(machine, tuned, plan_within(machine, limits))


def simulate_planned(machine: Machine, tuned: TunedLoop, plan: Plan) -> tuple[MoveResult, ...]:
    """Return every move, simulated in every corner; ``plan``: its setpoint, filters included."""
    resolution, plant = machine.drive.encoder_resolution, tuned.loops[0].plant
    noises = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]

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
        # Of all corners that ring for long, the states would be a gigabyte.
        lean = [replace(one, states=one.states[:0].copy()) for one in others]
        found.append(
            MoveResult(setpoint=setpoint, responses=(first, *lean), values=np.array(values))
        )
    return tuple(found)


def evaluate(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    name: Message | None = None,
    source: Message | None = None,
) -> Candidate:
    """Return what some limits do in the same loop, corners and judgement as all others."""
    moves = simulate_moves(machine, tuned, limits)
    return evaluate_moves(machine, plant, tuned, moves, name=name, source=source)


def evaluate_moves(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    moves: Sequence[MoveResult],
    *,
    sizes: Sequence[SizeCheck] | None = None,
    name: Message | None = None,
    source: Message | None = None,
) -> Candidate:
    """Return the same where the moves have been simulated already, with the first one's limits.

    ``sizes``: the worst of all smaller moves, where that is known already.
    """
    everywhere = [response for result in moves for response in result.responses]
    limits = moves[0].setpoint.limits
    if sizes is None and machine.requirements.every_size:
        sizes = judge_every_size(machine, plant, tuned, limits)
    values = [result.values for result in moves]
    return Candidate(
        limits=limits,
        settling_time=max(response.settling_time for response in everywhere),
        residual_deviation=max(response.residual_deviation for response in everywhere),
        peak_deviation=max(response.peak_deviation for response in everywhere),
        assessment=assess(machine, plant, tuned.corners, values, sizes=sizes or ()),
        sizes=tuple(sizes or ()),
        name=name,
        source=source,
    )
