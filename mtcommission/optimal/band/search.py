"""Searching t_f: the force on cells that just reaches the target, on finer and finer cells."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.errors import ComputationError, Outcome
from mtcommission.messages.message import Message
from mtcommission.optimal.band.force import FULL, cell_arcs
from mtcommission.optimal.band.program import CellForce, Question, first_contacts, reach_farthest
from mtcommission.optimal.proof import follow_control

Array = NDArray[np.float64]

WIDER = 1.03
"""Factor by which a bracket of t_f grows at first."""
WIDER_AGAIN = 1.001
"""The same next to a known one."""
INSIDE = 1e-3
"""Share of a bracket within which the next time does not come to its ends."""
TIGHTER = 2.0
"""What is kept free of max_velocity in addition, over what it was exceeded by."""


def find_time(
    question: Question, shares: Array, *, guess: float, known: CellForce | None = None
) -> CellForce:
    """Return the force that just reaches the target, on cells that are given shares of its t_f.

    Raises
    ------
    ComputationError
        NO_CONVERGENCE if a program or the exchange does not end, or if max_velocity is exceeded
        between the points at which it is watched however much of it is kept free there.
    """
    contacts = first_contacts(question)
    if known is not None:
        contacts = contacts.joined(known.contacts, which=known.multipliers != 0.0)
    low = high = reach_farthest(question, guess * shares, contacts)
    wider = WIDER if known is None else WIDER_AGAIN
    while high.reach < 1.0:
        low, high = high, _again(question, shares, high, t_f=wider * high.t_f)
        wider = wider**2
    while low.reach >= 1.0:
        low, high = _again(question, shares, low, t_f=low.t_f / wider), low
        wider = wider**2
    last = _narrowed(question, shares, low, high)
    excess_share = _velocity_excess(question, last)
    if excess_share <= 0.0:
        return last
    margin = question.velocity_margin + TIGHTER * excess_share
    if margin > question.settings.most_velocity_margin:
        detail = Message("band-exceeds-velocity", times=1.0 + excess_share)
        raise ComputationError(Outcome.NO_CONVERGENCE, detail)
    return find_time(replace(question, velocity_margin=margin), shares, guess=last.t_f, known=last)


def _velocity_excess(question: Question, cells: CellForce) -> float:
    """Return the share by which the motion exceeds max_velocity; not above 0 if it does not."""
    if not isfinite(question.max_velocity):
        return 0.0
    plant = question.plant
    motion = follow_control(plant, cell_arcs(question, cells))
    return float(motion.peaks[plant.velocity]) / question.max_velocity - 1.0


def _again(question: Question, shares: Array, cells: CellForce, *, t_f: float) -> CellForce:
    """Return the force that reaches farthest on as many cells, in another time."""
    return reach_farthest(question, t_f * shares, cells.contacts, start=cells.basis)


def _narrowed(question: Question, shares: Array, low: CellForce, high: CellForce) -> CellForce:
    """Return a force that reaches the target by next to nothing, between too short and too long.

    By the chord, halved for an end that stays (Illinois method).
    """
    tolerance = question.settings.time_tolerance
    below, above, moved = low.reach - 1.0, high.reach - 1.0, 0
    while high.reach > 1.0 + tolerance and high.t_f - low.t_f > tolerance * high.t_f:
        share = min(max(-below / (above - below), INSIDE), 1.0 - INSIDE)
        newest = max(high, low, key=lambda cells: cells.contacts.s.size)
        tried = _again(question, shares, newest, t_f=low.t_f + share * (high.t_f - low.t_f))
        side = 1 if tried.reach >= 1.0 else -1
        if side > 0:
            high, above, below = tried, tried.reach - 1.0, below * (0.5 if moved > 0 else 1.0)
        else:
            low, below, above = tried, tried.reach - 1.0, above * (0.5 if moved < 0 else 1.0)
        moved = side
    return high


def divide_switches(cells: CellForce, *, parts: int) -> Array:
    """Return shares of t_f with the cells divided in which, or beside which, the force switches."""
    level = np.abs(cells.force).max()
    side = np.where(np.abs(cells.force) >= FULL * level, np.sign(cells.force), 0.0)
    differs = side[1:] != side[:-1]
    switches = np.zeros(side.size, dtype=bool)
    switches[1:] |= differs
    switches[:-1] |= differs
    shares, pieces = cells.edges / cells.t_f, [np.zeros(1)]
    for left, right, divided in zip(shares[:-1], shares[1:], switches, strict=True):
        count = parts if divided else 1
        pieces.append(left + (right - left) * np.arange(1, count + 1) / count)
    return np.concatenate(pieces)
