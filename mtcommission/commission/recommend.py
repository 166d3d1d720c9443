"""Loop and limits: what ``limits`` and its page need, and what ``commission`` begins with.

A module of its own, since the optima and studies of ``commission`` load as long as this computes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mtcommission.base.messages.message import Message
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.commissioning_rule import RuleResult, apply_commissioning_rule
from mtcommission.limits.judge import Candidate
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine, require_force
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.setpoint.duration import require_short_moves
from mtcommission.study.loops import LoopChoice, settle_on_loop
from mtcommission.study.rules import TodaysValues, evaluate_rules, judge_today

Progress = Callable[[Message], None]

Announce = Callable[[Candidate], None]
"""Called with the recommended limits, judged, as soon as they are known."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recommendation:
    """Loop and limits alone, for whoever goes on trying from there."""

    machine: Machine
    plant: Plant  # nominal
    loop: LoopChoice  # the one that is used
    choice: Choice
    today: TodaysValues | None  # None where the profile states none
    rule: RuleResult | None  # where asked for
    rules: tuple[Candidate, ...]

    @property
    def tuned(self) -> TunedLoop:
        """The loop that is used, in every corner."""
        return self.loop.tuned


def recommend(
    machine: Machine,
    *,
    with_rules: bool = False,
    progress: Progress = lambda _: None,
    announce: Announce = lambda _: None,
) -> Recommendation:
    """Return loop and limits, and with them the rules of makers and textbooks if asked for.

    ``progress``: called with the name of each stage as it begins; ``announce``: with the
    recommended limits, judged, as soon as they are known.

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    require_force(machine)
    require_short_moves(machine)
    plant = build_plant(machine)
    progress(Message("stage-feedback-loop"))
    loop = settle_on_loop(machine)
    progress(Message("limits-name"))
    choice = loop.choice or choose_limits(machine, loop.tuned)
    announce(choice.candidate)
    progress(Message("stage-responses"))
    rule = apply_commissioning_rule(machine, loop.tuned) if with_rules else None
    return Recommendation(
        machine=machine,
        plant=plant,
        loop=loop,
        choice=choice,
        today=judge_today(machine, loop.tuned),
        rule=rule,
        rules=evaluate_rules(machine, loop.tuned, rule) if rule else (),
    )
