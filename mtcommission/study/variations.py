"""A study is a list of rows: what is judged, and by which limits, all by the one judge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

from mtcommission.base.messages.message import Message
from mtcommission.limits.bench import build_bench
from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.explore import REFINED, Found, explore
from mtcommission.limits.filters import neighbours
from mtcommission.limits.judge import Candidate, evaluate_moves, simulate_moves
from mtcommission.limits.requirements import keep_reserve
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.settings import STUDY


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Row:
    """A machine in its loop, whose limits are judged as given or as the one search finds them."""

    machine: Machine  # nominal; its moves and requirements count
    tuned: TunedLoop  # in every corner
    label: Message | None = None
    source: Message | None = None  # who says so
    limits: MotionLimits | None = None  # None: chosen
    near: MotionLimits | None = None  # where they are chosen: known ones that are nearly as good,
    beside: Sequence[SetpointFilter | None] = ()  # other filters that may be better,
    found: tuple[Found, ...] = ()  # or what was found already
    refined: int = REFINED  # places that are looked at more closely; 0 for a first look
    latest: float = inf  # duration beyond which nothing is looked at [s]
    largest_jerk: float = inf  # [m/s³]


def judge(row: Row) -> Candidate:
    """Return the limits of a row, judged like the recommendation.

    ``sizes`` is empty where the listed sizes miss a requirement: smaller ones cannot mend that.
    """
    if row.limits is None:
        found = choose(row).candidate
    else:
        moves = simulate_moves(row.machine, row.tuned, row.limits)
        found = evaluate_moves(row.machine, row.tuned, moves, sizes=())
        if found.assessment.is_met:
            found = evaluate_moves(row.machine, row.tuned, moves)
    return replace(found, name=row.label, source=row.source)


def look(row: Row) -> tuple[Found, ...]:
    """Return limits that the search sees for a row, the best first; empty where it sees none."""
    return explore(
        build_bench(keep_reserve(row.machine), row.tuned),
        largest_jerk=row.largest_jerk,
        near=row.near,
        beside=row.beside,
        refined=row.refined,
        latest=row.latest,
    )


def choose(row: Row) -> Choice:
    """Return the limits that the one search finds for a row."""
    return choose_limits(
        row.machine,
        row.tuned,
        near=row.near,
        found=row.found or (look(row) if row.beside else ()),
        largest_jerk=row.largest_jerk,
    )


def serve_listed(
    machine: Machine,
    tuned: TunedLoop,
    choice: Choice,
    filters: Sequence[SetpointFilter | None],
) -> Candidate | None:
    """Return what would serve the listed sizes alone best; None where only these count anyway.

    ``filters``: those that served every size well, the best first.
    """
    needs = machine.requirements
    if not (needs.every_size and choice.meets_requirements):
        return None
    alone = replace(machine, requirements=replace(needs, every_size=False))
    if not filters:
        return judge(Row(machine=alone, tuned=tuned))
    # One size leaves more notches to the ramps alone: none, or another filter, may do.
    control, own = machine.control, choice.limits.setpoint_filter
    beside = [*filters, *neighbours(control, own, STUDY.other_filter)]
    beside += [None] if control.seeks_setpoint_filter else []
    return judge(Row(machine=alone, tuned=tuned, near=choice.limits, beside=beside, refined=2))
