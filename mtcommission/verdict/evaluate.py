"""Limits through the loop: every move in every corner, judged like a recommendation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite

from mtcommission.loop.analysis.quantisation import EncoderNoise, encoder_noise
from mtcommission.loop.simulate import LoopResponse, simulate_corners
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.requirement import slow_to_feed
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import Plan, Setpoint, plan_within
from mtcommission.verdict.assess import Assessment, assess
from mtcommission.verdict.every_size import SizeCheck, judge_every_size


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveResult:
    """One move with some limits, in every corner.

    Parameters
    ----------
    setpoint
        What the control sends.
    responses
        One for each corner, the nominal machine first.
    """

    setpoint: Setpoint
    responses: tuple[LoopResponse, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """Limits through the same loop, corners and judgement as the recommendation.

    Parameters
    ----------
    limits
        Acceleration and jerk.
    settling_time, residual_deviation, peak_deviation
        Worst over moves and corners [s, m, m].
    assessment
        Verdict on every requirement.
    sizes
        The worst of all smaller moves for each requirement, where they count; else empty.
    name, source
        What they are and who says so, where they are shown beside others.
    """

    limits: MotionLimits
    settling_time: float
    residual_deviation: float
    peak_deviation: float
    assessment: Assessment
    sizes: tuple[SizeCheck, ...] = ()
    name: Message | None = None
    source: Message | None = None


def simulate_moves(
    machine: Machine, tuned: TunedLoop, limits: MotionLimits
) -> tuple[MoveResult, ...]:
    """Return every move with these limits, simulated in every corner.

    Parameters
    ----------
    machine
        Nominal; its band and drive count.
    tuned
        The loop in every corner.
    limits
        Acceleration and jerk.

    Returns
    -------
    tuple of MoveResult
    """
    return simulate_planned(machine, tuned, plan_within(machine, limits))


def simulate_planned(machine: Machine, tuned: TunedLoop, plan: Plan) -> tuple[MoveResult, ...]:
    """Return every move, simulated in every corner.

    Parameters
    ----------
    machine
        Nominal; its moves, requirements and drive count.
    tuned
        The loop in every corner.
    plan
        Setpoint of a move, filters included.

    Returns
    -------
    tuple of MoveResult
        The plant's states of the first corner only.
    """
    drive, needs = machine.drive, machine.requirements
    follows, noise = isfinite(needs.contour_deviation), _noise(machine, tuned)
    found = []
    for move in machine.moves:
        setpoint, slower = plan(move), slow_to_feed(move, needs.contour_feed)
        path = plan(slower) if follows and slower != move else None
        run = partial(simulate_corners, tuned.loops, drive=drive, band=needs.tcp_deviation)
        contours = [item.peak_deviation for item in run(path)] if path else []
        responses: list[LoopResponse] = []
        for corner, (response, own) in enumerate(zip(run(setpoint), noise, strict=True)):
            response = replace(response, tool_noise=own.tool, force_noise=own.force)
            if path:
                response = replace(response, contour_deviation=contours[corner])
            if responses:  # a gigabyte, where many corners ring for long
                response = replace(response, states=response.states[:0].copy())
            responses.append(response)
        found.append(MoveResult(setpoint=setpoint, responses=tuple(responses)))
    return tuple(found)


def _noise(machine: Machine, tuned: TunedLoop) -> list[EncoderNoise]:
    resolution = machine.drive.encoder_resolution
    return [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]


def evaluate(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    name: Message | None = None,
    source: Message | None = None,
) -> Candidate:
    """Return what some limits do in the same loop, corners and judgement as all others.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    limits
        Acceleration and jerk.
    name, source
        Of the limits, where they are shown beside others.

    Returns
    -------
    Candidate
    """
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
    """Return the same where the moves have been simulated already.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant, and the loop that the moves went through.
    moves
        From ``simulate_moves`` or ``simulate_planned``; the first one's limits are the
        candidate's.
    sizes
        The worst of all smaller moves, where that is known already.
    name, source
        Of the limits, where they are shown beside others.

    Returns
    -------
    Candidate
    """
    rows = [result.responses for result in moves]
    everywhere = [response for row in rows for response in row]
    limits = moves[0].setpoint.limits
    if sizes is None and machine.requirements.every_size:
        sizes = judge_every_size(machine, plant, tuned, limits)
    return Candidate(
        limits=limits,
        settling_time=max(response.settling_time for response in everywhere),
        residual_deviation=max(response.residual_deviation for response in everywhere),
        peak_deviation=max(response.peak_deviation for response in everywhere),
        assessment=assess(machine, plant, tuned.corners, rows, sizes=sizes or ()),
        sizes=tuple(sizes or ()),
        name=name,
        source=source,
    )
