"""Loops tried with the limits that suit them best: all at a first look, the best exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, isfinite
from typing import Any

from mtcommission.limits.bench import build_bench
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.explore import REFINED, Found, explore
from mtcommission.limits.judge import Candidate
from mtcommission.limits.reserve import keep_reserve
from mtcommission.loop.tuning.cascade import Shape
from mtcommission.loop.tuning.family import Proposal, Proposals, propose_near
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import finish
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits

STIFFNESS_EXPONENT = 0.01
"""What a stiffer tool is worth: twice the stiffness as much as 0.7 % of the settling time (design
choice; a smooth price, so that a machine that is a little better never gets a loop that is much
slower)."""

CENTRES = 2
"""Loops about which others are looked at."""

BESIDE = 4
"""Kinds of setpoint filters with which a loop is looked at, those first that served another."""

FINALISTS = 3
"""Loops whose limits are sought more closely, those first that a first look likes best."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finalist:
    """A loop and the limits that seem to suit it best."""

    shape: Shape  # Kv and Tn over Kp
    tuned: TunedLoop  # in every corner
    is_classic: bool  # the cascade by the classic rule
    found: tuple[Found, ...] = ()  # the best first; empty: none were found that keep the bounds
    is_explored: bool = False  # everywhere, not at a first look
    price: float = inf  # settling time, less what the stiffness is worth

    @property
    def limits(self) -> MotionLimits | None:
        """The best limits, not rounded; None where none were found."""
        if not self.found:
            return None
        best = self.found[0]
        return MotionLimits(
            acceleration=best.acceleration,
            jerk=best.acceleration / best.jerk_time,
            setpoint_filter=best.setpoint_filter,
        )


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
    others: tuple[Finalist, ...] = ()  # that came near, not judged yet
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
    best: LoopTrial | None  # the one that serves the moves best; None if there is none
    others: tuple[Finalist, ...]

    def use(self, trial: LoopTrial, *, among: Sequence[LoopTrial] = ()) -> LoopChoice:
        """The choice of the best, or of one of another search, listed beside it."""
        used = replace(trial, is_used=True)
        return LoopChoice(
            tuned=finish(self.proposals.family, trial.tuned),
            choice=trial.choice,
            trials=in_order((used, *among)),
            others=self.others,
            remarks=_explain(trial, self.looked_at),
        )


def in_order(trials: Sequence[LoopTrial]) -> tuple[LoopTrial, ...]:
    """Return trials, the soonest first."""
    return tuple(sorted(trials, key=lambda item: item.candidate.settling_time))


def try_all(machine: Machine, plant: Plant, proposals: Proposals) -> LoopSearch:
    """Return what the moves make of the proposals, and of those near the best one.

    The best has the least price of those whose limits meet the requirements, if any does.
    """
    looked = _look_at_all(machine, plant, proposals)
    finalists = [
        item if item.is_explored else _explore_closely(machine, plant, item)
        for item in looked[:FINALISTS]
    ]
    finalists.sort(key=_price)
    best: LoopTrial | None = None
    for item in finalists:
        trial = judge_loop(machine, plant, item)
        best = best or trial
        if trial.choice.meets_requirements:
            best = trial
            break
    others = [item for item in finalists if best and item.tuned is not best.tuned]
    return LoopSearch(proposals=proposals, looked_at=len(looked), best=best, others=tuple(others))


def _price(item: Finalist) -> float:
    return item.price


def _look_at_all(machine: Machine, plant: Plant, proposals: Proposals) -> list[Finalist]:
    """All proposals, and those near the best of them, at a first look; the best first."""
    found: list[Finalist] = []
    first = partial(_explore, machine, plant)

    def look_at(loops: Sequence[Proposal]) -> None:
        for each in loops:
            item = Finalist(
                shape=each.shape, tuned=each.tuned, is_classic=each.tuned is proposals.classic
            )
            known = next((other for other in found if other.limits), None)
            found.append(_look_like(machine, plant, item, known) if known else first(item))

    look_at(proposals.loops)
    for best in sorted(found, key=_price)[:CENTRES]:
        look_at(propose_near(proposals, best.shape))
    return sorted(found, key=_price)


def _explore(
    machine: Machine,
    plant: Plant,
    item: Finalist,
    *,
    near: MotionLimits | None = None,
    beside: Sequence[SetpointFilter | None] = (),
    refined: int = REFINED,
) -> Finalist:
    """A loop with the best limits, sought everywhere or near those of a loop much like it."""
    bench = build_bench(keep_reserve(machine), plant, item.tuned)
    found = explore(bench, near=near, beside=beside, refined=refined)
    time = found[0].duration + bench.delay if found else inf
    return replace(item, found=found, is_explored=bool(refined), price=priced(time, item.tuned))


def _explore_closely(machine: Machine, plant: Plant, item: Finalist) -> Finalist:
    """A loop with the best limits near those of its first look, behind any filter that did well."""
    beside = [each.setpoint_filter for each in item.found[1:BESIDE]]
    return _explore(machine, plant, item, near=item.limits, beside=beside)


def _look_like(machine: Machine, plant: Plant, loop: Finalist, known: Finalist) -> Finalist:
    """A loop at a first look, near the limits of another, and behind the best filters of others."""
    kinds: dict[str, SetpointFilter | None] = {}
    for each in known.found:
        kinds.setdefault(
            each.setpoint_filter.kind if each.setpoint_filter else "", each.setpoint_filter
        )
    beside = list(kinds.values())[1:BESIDE]
    return _explore(machine, plant, loop, near=known.limits, beside=beside, refined=0)


def judge_loop(machine: Machine, plant: Plant, item: Finalist) -> LoopTrial:
    """Return a loop with the limits that were found for it, rounded and judged."""
    return LoopTrial(
        shape=item.shape,
        tuned=item.tuned,
        choice=choose_limits(machine, plant, item.tuned, found=item.found),
        is_classic=item.is_classic,
    )


def _explain(used: LoopTrial, number: int) -> tuple[Message, ...]:
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
