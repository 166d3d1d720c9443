"""Loops tried with the limits that suit them best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

from mtcommission.allowance import find_part
from mtcommission.limits.choose import choose_limits
from mtcommission.loop.tuning.cascade import Shape
from mtcommission.loop.tuning.proposals import Proposal, Proposals, propose_near
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import finish
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import Settings
from mtcommission.verdict.evaluate import Candidate

TRIED = 15.0
"""What trying loops after the first may take, about that many seconds of processor time."""

LATER = 0.03
"""What a stiffer tool may cost in settling time (design choice)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopTrial:
    """A loop with the limits that suit it best.

    Parameters
    ----------
    shape
        Kv and Tn over Kp.
    tuned
        The loop in every corner.
    candidate
        Its best limits by the coarser search, judged.
    is_classic, is_used
        Whether it is the cascade by the classic rule, and whether everything else in the record
        uses it.
    """

    shape: Shape
    tuned: TunedLoop
    candidate: Candidate
    is_classic: bool
    is_used: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopVariant:
    """The loop without or with state feedback, each with the limits that suit it best.

    Parameters
    ----------
    name
        Without or with state feedback.
    tuned
        The loop in every corner.
    candidate
        Its best limits by the coarser search, judged.
    is_used
        Whether everything else in the record uses this loop.
    """

    name: Message
    tuned: TunedLoop
    candidate: Candidate
    is_used: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopChoice:
    """Which loop is used, and what others would have done.

    Parameters
    ----------
    tuned
        The loop that is used.
    trials
        The loops that were tried, soonest first; empty where there was nothing to choose.
    variants
        The best loop without and with state feedback; empty where only one was sought.
    remarks
        Why this loop, and what the control must offer.
    """

    tuned: TunedLoop
    trials: tuple[LoopTrial, ...] = ()
    variants: tuple[LoopVariant, ...] = ()
    remarks: tuple[Message, ...] = ()

    @property
    def model(self) -> Any:
        """The loop as a ``control.StateSpace`` to go on with, e.g. ``control.bode_plot``."""
        return self.tuned.model


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopSearch:
    """What was proposed, and what came of it.

    Parameters
    ----------
    proposals, trials
        All of the proposals were tried, and those near the best of them.
    remarks
        That this is not so where it was too much to compute.
    """

    proposals: Proposals
    trials: tuple[LoopTrial, ...]
    remarks: tuple[Message, ...] = ()

    @property
    def best(self) -> LoopTrial | None:
        """The one that serves the moves best; None if there is none."""
        return pick_loop(self.trials)

    def use(self, trial: LoopTrial, *, among: Sequence[LoopTrial] = ()) -> LoopChoice:
        """The choice of one of the trials, listed beside all others, soonest first."""
        listed = [replace(item, is_used=item is trial) for item in (*self.trials, *among)]
        listed.sort(key=lambda item: item.candidate.settling_time)
        tuned = finish(self.proposals.family, trial.tuned)
        return LoopChoice(
            tuned=tuned, trials=tuple(listed), remarks=(*_explain(trial, listed), *self.remarks)
        )


def pick_loop(trials: Sequence[LoopTrial]) -> LoopTrial | None:
    """Return the stiffest loop of those whose moves settle nearly as soon as any.

    Parameters
    ----------
    trials
        Those that meet the requirements count, if any does.

    Returns
    -------
    LoopTrial or None
        None of none.
    """
    good = [item for item in trials if item.candidate.assessment.is_met] or trials
    soonest = min((item.candidate.settling_time for item in good), default=inf)
    near = [item for item in good if item.candidate.settling_time <= (1.0 + LATER) * soonest]
    return max(near, key=lambda item: item.tuned.least_stiffness, default=None)


def try_all(machine: Machine, plant: Plant, settings: Settings, proposals: Proposals) -> LoopSearch:
    """Return what the moves make of each proposal, and of those near the best one."""
    trials: list[LoopTrial] = []
    starts: tuple[MotionLimits, ...] = ()

    def attempt(proposal: Proposal) -> None:
        nonlocal starts
        tuned = proposal.tuned
        found = best_limits(machine, plant, settings, tuned, starts)
        starts = starts or (found.limits,)
        is_classic = tuned is proposals.classic
        trials.append(
            LoopTrial(shape=proposal.shape, tuned=tuned, candidate=found, is_classic=is_classic)
        )

    def attempt_others() -> tuple[Message, ...]:
        for proposal in proposals.loops[1:]:
            attempt(proposal)
        best = pick_loop(trials)
        if best is not None:
            for proposal in propose_near(proposals, best.shape):
                attempt(proposal)
        return ()

    for proposal in proposals.loops[:1]:
        attempt(proposal)
    remarks = find_part(
        attempt_others,
        seconds=TRIED,
        otherwise=lambda _: (Message("loop-trials-left-out"),),
    )
    return LoopSearch(proposals=proposals, trials=tuple(trials), remarks=remarks)


def best_limits(
    machine: Machine,
    plant: Plant,
    settings: Settings,
    tuned: TunedLoop,
    starts: Sequence[MotionLimits],
) -> Candidate:
    """Return the limits that suit a loop best by the coarser search, judged."""
    near = starts[0] if starts else None
    return choose_limits(machine, plant, tuned, near=near).candidate


def _explain(used: LoopTrial, trials: Sequence[LoopTrial]) -> tuple[Message, ...]:
    """Why a loop is used, and what the classic rule's would do."""
    if len(trials) < 2:
        return ()
    reason = Message(
        "loop-chosen",
        number=len(trials),
        later=LATER,
        settling=say_settling(used.candidate),
        stiffness=used.tuned.least_stiffness,
        soonest=say_settling(min(trials, key=lambda item: item.candidate.settling_time).candidate),
    )
    classic = [
        Message(
            "loop-by-classic-rule",
            settling=say_settling(item.candidate),
            stiffness=item.tuned.least_stiffness,
        )
        for item in trials
        if item.is_classic and not item.is_used
    ]
    return (reason, *classic)


def say_settling(candidate: Candidate) -> Message:
    """Return the settling time, or that there is none."""
    time = candidate.settling_time
    return Message("time-value", time=time) if isfinite(time) else Message("not-settled")
