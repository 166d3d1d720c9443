"""A plan -> pieces of work, cut by case number alone: each is on disk within about a second."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from math import isfinite

from mtcommission.machine.machine import Positioning
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import FORCE_KEY, PEAKS_KEY, Plan, Quantity, plain_key
from mtcommission.sweep.rows import Work, columns

CURVE_PIECE = 500
"""Neighbouring forces solved together: well below a second."""
PIECE = 4
"""Other time-optimal controls together: some tens of milliseconds each."""
FEWEST = 3
"""Cases that are worth a curve."""


def piece_size(plan: Plan) -> int:
    """Return how many cases are computed together.

    One where a case takes long: limits, whole runs, and optimal controls that keep a bound (0.3 s,
    on some machines many seconds).

    Parameters
    ----------
    plan
        Any plan whose profile can be read as it is.

    Examples
    --------
    >>> from mtcommission.profile.shipped import read_shipped
    >>> from mtcommission.sweep.cases import read_axis
    >>> masses, forces = (read_axis(text, where="example")
    ...     for text in ("plant.slider_mass=600:900:20", "drive.max_force=1kN:4kN:100"))
    >>> text = read_shipped("milling-manipulator").text
    >>> plan = Plan(profile_text=text, where="machine.toml", axes=(masses, forces))
    >>> piece_size(plan), piece_size(replace(plan, axes=(forces, masses)))
    (100, 4)
    """
    if plan.quantity is not Quantity.OPTIMAL or _is_bounded(plan):
        return 1
    together = _neighbours(plan)
    return min(together, CURVE_PIECE) if together >= FEWEST else PIECE


def count_pieces(plan: Plan) -> int:
    """Return the number of pieces of a plan."""
    return -(-plan.count // piece_size(plan))


def cut_work(plan: Plan, numbers: Iterable[int]) -> Iterator[Work]:
    """Yield pieces of a plan with all that they need.

    Parameters
    ----------
    plan
        What to compute.
    numbers
        Of the pieces, counted from 0.
    """
    base, digest, table = replace(plan, axes=()), plan.base_digest, columns(plan)
    size = piece_size(plan)
    for piece in numbers:
        cases = range(piece * size, min((piece + 1) * size, plan.count))
        settings = tuple(plan.settings(index) for index in cases)
        yield Work(
            piece=piece,
            first=cases.start,
            settings=settings,
            base=base,
            base_digest=digest,
            columns=table,
        )


def _is_bounded(plan: Plan) -> bool:
    """Whether a bound, given or varied, or a greatest velocity rules out the quick ways."""
    keys = [plain_key(key) for key in plan.keys]
    if plan.bounds or any(key.startswith(PEAKS_KEY) for key in keys):
        return True
    if f"moves.{plan.move - 1}.max_velocity" in keys:
        return True
    moves = parse_profile(plan.profile_text, where=plan.where).moves[plan.move - 1 : plan.move]
    return any(isinstance(move, Positioning) and isfinite(move.max_velocity) for move in moves)


def _neighbours(plan: Plan) -> int:
    """How many cases in a row differ in F_max alone, on average."""
    axes = plan.axes if plan.is_paired else plan.axes[-1:]
    rows = list(zip(*(axis.rows for axis in axes), strict=True)) or [()]
    keys = [key for axis in axes for key in axis.keys]
    others = {
        tuple(text for key, text in zip(keys, sum(row, ()), strict=True) if key != FORCE_KEY)
        for row in rows
    }
    return len(rows) // len(others)
