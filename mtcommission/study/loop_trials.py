"""Loops tried with the limits that suit them best: all at a first look, the best exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

from mtcommission.limits.bench import build_bench
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.explore import Found, explore
from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.tuning.cascade import Shape
from mtcommission.loop.tuning.proposals import Proposal, Proposals, propose_near
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import finish
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verdict.evaluate import Candidate

STIFFNESS_EXPONENT = 0.01
"""What a stiffer tool is worth: twice the stiffness as much as 0.7 % of the settling time (design
choice; a smooth price, so that a machine that is a little better never gets a loop that is much
slower)."""

FINALISTS = 3
"""Loops that are judged with limits of their own, those first that a first look likes best."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopTrial:
    """A loop with the limits that suit it best, judged as the recommendation is."""

    shape: Shape  # Kv and Tn over Kp
    tuned: TunedLoop  # in every corner
    choice: Choice
    is_classic: bool  # the cascade by the classic rule
    is_used: bool = False  # everything else in the record uses it

    @property
    def candidate(self) -> Candidate:
        """Its best limits, judged."""
        return self.choice.candidate

    @property
    def price(self) -> float:
        """Settling time, less what the stiffness is worth; the least is chosen."""
        return priced(self.candidate.settling_time, self.tuned)


def priced(settling_time: float, tuned: TunedLoop) -> float:
    """Return a settling time divided by what the stiffness of the loop is worth."""
    return float(settling_time / tuned.least_stiffness**STIFFNESS_EXPONENT)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopVariant:
    """The loop without or with state feedback, each with the limits that suit it best, judged."""

    name: Message
    tuned: TunedLoop
    candidate: Candidate
    is_used: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopChoice:
    """Which loop is used, and what others would have done."""

    tuned: TunedLoop
    choice: Choice | None = None  # its limits, where they were chosen already
    trials: tuple[LoopTrial, ...] = ()  # judged ones, soonest first; empty: nothing to choose
    variants: tuple[LoopVariant, ...] = ()  # without and with state feedback, if both were sought
    remarks: tuple[Message, ...] = ()  # why this loop, and what the control must offer

    @property
    def model(self) -> Any:
        """The loop as a ``control.StateSpace`` to go on with, e.g. ``control.bode_plot``."""
        return self.tuned.model


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopSearch:
    """What was proposed, how many of them were looked at, and the best of them, judged."""

    proposals: Proposals
    looked_at: int
    trials: tuple[LoopTrial, ...]

    @property
    def best(self) -> LoopTrial | None:
        """The one that serves the moves best; None if there is none."""
        return pick_loop(self.trials)

    def use(self, trial: LoopTrial, *, among: Sequence[LoopTrial] = ()) -> LoopChoice:
        """The choice of one of the trials, listed beside all others, soonest first."""
        listed = [replace(item, is_used=item is trial) for item in (*self.trials, *among)]
        listed.sort(key=lambda item: item.candidate.settling_time)
        return LoopChoice(
            tuned=finish(self.proposals.family, trial.tuned),
            choice=trial.choice,
            trials=tuple(listed),
            remarks=_explain(trial, listed, self.looked_at),
        )


def pick_loop(trials: Sequence[LoopTrial]) -> LoopTrial | None:
    """Return the loop with the least price, of those that meet the requirements if any does."""
    good = [item for item in trials if item.candidate.assessment.is_met] or trials
    return min(good, key=lambda item: item.price, default=None)


def try_all(machine: Machine, plant: Plant, proposals: Proposals) -> LoopSearch:
    """Return what the moves make of the proposals, and of those near the best one."""
    strict, looked = keep_reserve(machine), list[tuple[float, Proposal]]()
    known: Found | None = None

    def look_at(proposal: Proposal) -> None:
        nonlocal known
        bench = build_bench(strict, plant, proposal.tuned)
        near = None
        if known is not None:
            near = MotionLimits(
                acceleration=known.acceleration,
                jerk=known.acceleration / known.jerk_time,
                setpoint_filter=known.setpoint_filter,
            )
        found = explore(bench, near=near, refined=0)
        if found:
            known = known or found[0]
            time = min(item.duration for item in found) + bench.delay
            looked.append((priced(time, proposal.tuned), proposal))
        else:
            looked.append((inf, proposal))

    for proposal in proposals.loops:
        look_at(proposal)
    if looked:
        _, best = min(looked, key=lambda item: item[0])
        for proposal in propose_near(proposals, best.shape):
            look_at(proposal)
    looked.sort(key=lambda item: item[0])
    trials: list[LoopTrial] = []
    for _, proposal in looked[:FINALISTS]:
        first = trials[0].choice if trials else None
        near = first.limits if first and first.meets_requirements else None
        trials.append(
            LoopTrial(
                shape=proposal.shape,
                tuned=proposal.tuned,
                choice=choose_limits(machine, plant, proposal.tuned, near=near),
                is_classic=proposal.tuned is proposals.classic,
            )
        )
    return LoopSearch(proposals=proposals, looked_at=len(looked), trials=tuple(trials))


def best_limits(
    machine: Machine, plant: Plant, tuned: TunedLoop, near: MotionLimits | None
) -> Candidate:
    """Return the limits that suit a loop best near what is known of another, judged."""
    return choose_limits(machine, plant, tuned, near=near).candidate


def _explain(used: LoopTrial, trials: Sequence[LoopTrial], number: int) -> tuple[Message, ...]:
    """Why a loop is used."""
    if number < 2:
        return ()
    return (
        Message(
            "loop-chosen",
            number=number,
            settling=say_settling(used.candidate),
            stiffness=used.tuned.least_stiffness,
        ),
    )


def say_settling(candidate: Candidate) -> Message:
    """Return the settling time, or that there is none."""
    time = candidate.settling_time
    return Message("time-value", time=time) if isfinite(time) else Message("not-settled")
