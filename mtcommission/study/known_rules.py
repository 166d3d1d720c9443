"""What the rules of makers and textbooks do in the same loop."""

from __future__ import annotations

from mtcommission.limits.commissioning_rule.rule import RuleResult
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb, apply_slower_ramps
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.verdict.evaluate import Candidate, evaluate


def evaluate_rules(
    machine: Machine, plant: Plant, tuned: TunedLoop, rule: RuleResult
) -> tuple[Candidate, ...]:
    """Return what the rules of makers and textbooks do in the same loop.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    rule
        The commissioning rule, applied.

    Returns
    -------
    tuple of Candidate
        First the commissioning rule, then the others.
    """
    known = [
        (item.name, item.source, item.limits)
        for item in (*apply_rules_of_thumb(machine, plant), *apply_slower_ramps(machine, plant))
    ]
    name = Message("commissioning-rule-with", chosen=rule.best.name)
    source = Message("source-commissioning-rule")
    return tuple(
        evaluate(machine, plant, tuned, limits, name=name, source=source)
        for name, source, limits in ((name, source, rule.limits), *known)
    )
