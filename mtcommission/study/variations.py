"""A study is a list of rows: what is judged, and by which limits, all by the one judge."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.judge import Candidate, evaluate_moves, simulate_moves
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.messages.message import Message
from mtcommission.plant.plant import build_plant
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Row:
    """A machine in its loop, whose limits are judged as given or as the one search finds them."""

    label: Message
    machine: Machine  # nominal; its moves and requirements count
    tuned: TunedLoop  # in every corner
    limits: MotionLimits | None = None  # None: chosen
    near: MotionLimits | None = None  # where they are chosen: known ones that are nearly as good
    source: Message | None = None  # who says so


def judge(row: Row) -> Candidate:
    """Return the limits of a row, judged like the recommendation.

    ``sizes`` is empty where the listed sizes miss a requirement already.
    """
    if row.limits is None:
        return replace(choose(row).candidate, name=row.label, source=row.source)
    plant = build_plant(row.machine)
    moves = simulate_moves(row.machine, row.tuned, row.limits)
    of_all = partial(evaluate_moves, row.machine, plant, row.tuned, moves)
    found = of_all(sizes=(), name=row.label, source=row.source)
    # What the listed sizes miss, smaller ones cannot mend.
    return of_all(name=row.label, source=row.source) if found.assessment.is_met else found


def choose(row: Row) -> Choice:
    """Return the limits that the one search finds for a row."""
    return choose_limits(row.machine, build_plant(row.machine), row.tuned, near=row.near)
