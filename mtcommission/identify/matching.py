"""Modes matched across states of the machine, and the spread that the corners must hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, product
from math import ceil, log
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.machine.machine import MOST_STATES
from mtcommission.record.identified import MeasuredStateEntry, SpreadEntry

FARTHEST = 0.25
"""Largest distance of one mode in two states that follow each other, in ln f (empirical): a bed at
24, 30 and 36 Hz with three payloads is one mode."""
FREQUENCY_FLOOR = 0.01
"""Least spread where several states were measured: the level alone shifts a mode by 0.8 %."""
FREQUENCY_FLOOR_OF_ONE = 0.03
"""Least spread where one state was measured: positions and payload are not in it (empirical)."""
DAMPING_FLOOR = 0.15
"""Least spread of damping where several states were measured (empirical)."""
DAMPING_FLOOR_OF_ONE = 0.3
"""Least spread of damping where one state was measured: that of a profile that states none."""
MOST_DAMPING = 0.95
"""Largest spread of damping: of a mode of which the lines show nothing but the frequency."""
APART = 3.0
"""Difference of two states in its standard errors from which each is judged by itself."""
STEP = 0.005
"""Spreads are rounded up to it."""

Chain = dict[int, MeasuredMode]
"""One mode in each state where it was seen."""

_ESTIMATES = ("frequency_hz", "damping_ratio", "measured_gain", "tcp_gain")


def match_modes(
    states: Sequence[MeasuredStateEntry],
) -> tuple[list[MeasuredMode], list[MeasuredStateEntry]]:
    """Return the modes over all states, and the states with the modes named by them.

    The state with most modes leads; modes that it does not have are added. Modes that no state has
    both of are one, if states between them lead from one to the other. Values are the middle of the
    states, with a standard error of at least a quarter of their range.
    """
    chains: list[Chain] = []
    for i, state in sorted(enumerate(states), key=lambda one: -len(one[1].modes)):
        left = dict(enumerate(state.modes))
        if left and chains:
            from scipy.optimize import linear_sum_assignment  # slow to load, rarely needed

            centres = [_centre(chain) for chain in chains]
            cost = np.array([[abs(_log(mode) - c) for mode in state.modes] for c in centres])
            for row, column in zip(*linear_sum_assignment(np.minimum(cost, 1.0)), strict=True):
                if cost[row, column] < FARTHEST:
                    chains[row][i] = left.pop(int(column))
        chains += [{i: mode} for mode in left.values()]
    chains = sorted(_joined(chains), key=_centre)
    named: list[list[MeasuredMode]] = [[] for _ in states]
    found = []
    for number, chain in enumerate(chains, start=1):
        seen = {i: replace(mode, name=f"mode{number}") for i, mode in chain.items()}
        for i, mode in seen.items():
            named[i].append(mode)
        values: dict[str, Any] = {
            key: middle_of([getattr(mode, key) for mode in seen.values()]) for key in _ESTIMATES
        }
        found.append(MeasuredMode(name=f"mode{number}", **values))
    return found, [replace(state, modes=own) for state, own in zip(states, named, strict=True)]


def _joined(chains: list[Chain]) -> list[Chain]:
    """The nearest first; one file in the middle may have come last."""
    while True:
        near = [
            (distance, a, b)
            for (a, one), (b, other) in combinations(enumerate(chains), 2)
            if not one.keys() & other.keys() and (distance := _distance(one, other)) < FARTHEST
        ]
        if not near:
            return chains
        _, a, b = min(near)
        joined = chains[a] | chains[b]
        chains = [chain for k, chain in enumerate(chains) if k not in (a, b)] + [joined]


def _log(mode: MeasuredMode) -> float:
    return log(mode.frequency_hz.value)


def _distance(one: Chain, other: Chain) -> float:
    """Between the nearest two of two chains, in ln f."""
    pairs = product(one.values(), other.values())
    return min(abs(_log(a) - _log(b)) for a, b in pairs)


def _centre(chain: Chain) -> float:
    """Middle of a chain, in ln f."""
    logs = [_log(mode) for mode in chain.values()]
    return 0.5 * (min(logs) + max(logs))


def middle_of(estimates: Sequence[Estimate | None]) -> Estimate | None:
    """Middle of some estimates; two standard errors reach the outermost."""
    known = [one for one in estimates if one is not None]
    if not known:
        return None
    low, high = min(one.value for one in known), max(one.value for one in known)
    typical = float(np.sqrt(np.mean([one.sigma**2 for one in known])))
    return Estimate(value=0.5 * (low + high), sigma=typical + 0.25 * (high - low))


def find_spread(states: Sequence[MeasuredStateEntry], modes: Sequence[MeasuredMode]) -> SpreadEntry:
    """Return the spreads that the corners must hold: the worst mode, at least a floor.

    max(2 sigma, half of the range over the states, floor) by the middle, for each mode; without the
    range where the states differ so much that each is judged by itself.
    """
    n, apart = len(states), states_differ(states, modes)
    floors = {
        "frequency": FREQUENCY_FLOOR if n > 1 else FREQUENCY_FLOOR_OF_ONE,
        "damping": DAMPING_FLOOR if n > 1 else DAMPING_FLOOR_OF_ONE,
    }
    spreads, because = {}, []
    for kind, floor in floors.items():
        why = f"identify-{kind}-{'apart' if apart else 'floor'}"
        found = [(floor, Message(why, floor=floor, states=n))]
        for mode in modes:
            seen = [
                one.frequency_hz if kind == "frequency" else one.damping_ratio
                for state in states
                for one in state.modes
                if one.name == mode.name
            ]
            low, high = min(one.value for one in seen), max(one.value for one in seen)
            if not apart:
                by_range = (high - low) / (high + low)
                kind_of, count = f"identify-{kind}-range", len(seen)
                by_ends = Message(kind_of, mode=mode.name, low=low, high=high, states=count)
                found.append((by_range, by_ends))
            by_sigma = 2.0 * max(one.sigma for one in seen) / (0.5 * (low + high))
            because_of = Message(f"identify-{kind}-sigma", mode=mode.name, spread=by_sigma)
            found.append((by_sigma, because_of))
        spread, message = max(found, key=lambda one: one[0])
        if kind == "damping" and spread > MOST_DAMPING:
            name, spread = message.values["mode"], MOST_DAMPING
            message = Message("identify-damping-unknown", mode=name, spread=spread)
        spreads[kind] = STEP * ceil(spread / STEP - 1e-9)
        because.append(message)
    return SpreadEntry(**spreads, because=because)


def states_differ(states: Sequence[MeasuredStateEntry], modes: Sequence[MeasuredMode]) -> bool:
    """Return whether a mode or the mass differs by more than its intervals: each is judged then."""
    if not 1 < len(states) <= MOST_STATES:
        return False
    masses = [state.moving_mass for state in states if state.moving_mass]
    seen = [mode for state in states for mode in state.modes]
    frequencies = ([one.frequency_hz for one in seen if one.name == mode.name] for mode in modes)
    return any(
        abs(one.value - other.value) > APART * float(np.hypot(one.sigma, other.sigma))
        for values in (masses, *frequencies)
        for one, other in combinations(values, 2)
    )
