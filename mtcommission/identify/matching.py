"""Modes matched across states of the machine, and the spread that the corners must hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from math import ceil, log
from typing import Any

import numpy as np

from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.machine.machine import MOST_STATES
from mtcommission.messages.message import Message
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


Chain = dict[int, int]
"""Which mode it is in each state where it was seen."""


def match_modes(
    states: Sequence[MeasuredStateEntry],
) -> tuple[list[MeasuredMode], list[MeasuredStateEntry]]:
    """Return the modes over all states, and the states with the modes named by them.

    The state with most modes leads; modes that it does not have are added. Modes that no state has
    both of are one, if states between them lead from one to the other. Values are the middle of the
    states, with a standard error of at least a quarter of their range.
    """
    order = sorted(range(len(states)), key=lambda i: -len(states[i].modes))
    chains: list[Chain] = []
    for i in order:
        modes = states[i].modes
        centres = [_centre(chain, states) for chain in chains]
        taken: set[int] = set()
        if modes and centres:
            from scipy.optimize import linear_sum_assignment  # slow to load, rarely needed

            cost = np.array(
                [[abs(log(c / mode.frequency_hz.value)) for mode in modes] for c in centres]
            )
            for row, column in zip(*linear_sum_assignment(np.minimum(cost, 1.0)), strict=True):
                if cost[row, column] < FARTHEST:
                    chains[row][i] = int(column)
                    taken.add(int(column))
        chains += [{i: k} for k in range(len(modes)) if k not in taken]
    chains = _joined(chains, states)
    chains.sort(key=lambda chain: _centre(chain, states))
    named: list[list[MeasuredMode]] = [[] for _ in states]
    found = []
    for number, chain in enumerate(chains, start=1):
        seen = [replace(states[i].modes[k], name=f"mode{number}") for i, k in chain.items()]
        for i, mode in zip(chain, seen, strict=True):
            named[i].append(mode)
        values: dict[str, Any] = {
            key: middle_of([getattr(mode, key) for mode in seen]) for key in _ESTIMATES
        }
        found.append(replace(seen[0], **values))
    return found, [replace(state, modes=own) for state, own in zip(states, named, strict=True)]


_ESTIMATES = ("frequency_hz", "damping_ratio", "measured_gain", "tcp_gain")


def _joined(chains: list[Chain], states: Sequence[MeasuredStateEntry]) -> list[Chain]:
    """The nearest first; one file in the middle may have come last."""
    while True:
        near = [
            (distance, a, b)
            for b in range(len(chains))
            for a in range(b)
            if not chains[a].keys() & chains[b].keys()
            and (distance := _distance(chains[a], chains[b], states)) < FARTHEST
        ]
        if not near:
            return chains
        _, a, b = min(near)
        joined = chains[a] | chains[b]
        chains = [chain for k, chain in enumerate(chains) if k not in (a, b)] + [joined]


def _distance(one: Chain, other: Chain, states: Sequence[MeasuredStateEntry]) -> float:
    """Between the nearest two of two chains, in ln f."""
    return min(
        abs(log(states[i].modes[k].frequency_hz.value / states[j].modes[n].frequency_hz.value))
        for i, k in one.items()
        for j, n in other.items()
    )


def _centre(chain: Chain, states: Sequence[MeasuredStateEntry]) -> float:
    logs = [log(states[i].modes[k].frequency_hz.value) for i, k in chain.items()]
    return float(np.exp(0.5 * (min(logs) + max(logs))))


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
        worst = floor, Message(why, floor=floor, states=n)
        for mode in modes:
            seen = [
                one.frequency_hz if kind == "frequency" else one.damping_ratio
                for state in states
                for one in state.modes
                if one.name == mode.name
            ]
            low, high, by_range, by_sigma = _reach(seen, apart=apart)
            ends = {"low": low, "high": high, "states": len(seen)}
            for spread, message in (
                (by_range, Message(f"identify-{kind}-range", mode=mode.name, **ends)),
                (by_sigma, Message(f"identify-{kind}-sigma", mode=mode.name, spread=by_sigma)),
            ):
                worst = (spread, message) if spread > worst[0] else worst
        if kind == "damping" and worst[0] > MOST_DAMPING:
            mode_of = worst[1].values["mode"]
            unknown = Message("identify-damping-unknown", mode=mode_of, spread=MOST_DAMPING)
            worst = MOST_DAMPING, unknown
        spreads[kind] = STEP * ceil(worst[0] / STEP - 1e-9)
        because.append(worst[1])
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


def _reach(values: Sequence[Estimate], *, apart: bool) -> tuple[float, float, float, float]:
    """Ends of some values, half of their range and two standard errors by the middle."""
    low, high = min(one.value for one in values), max(one.value for one in values)
    by_sigma = 2.0 * max(one.sigma for one in values) / (0.5 * (low + high))
    return low, high, 0.0 if apart else (high - low) / (high + low), by_sigma
