"""Modes matched across states of the machine, and the spread that the corners must hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import ceil, log

import numpy as np
from scipy.optimize import linear_sum_assignment

from mtcommission.identify.identified import IdentifiedMode, Spread, State
from mtcommission.machine.identified import Estimate
from mtcommission.machine.machine import MOST_STATES
from mtcommission.messages.message import Message

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
APART = 3.0
"""Difference of two states in its standard errors from which each is judged by itself."""
STEP = 0.005
"""Spreads are rounded up to it."""


def match_modes(states: Sequence[State]) -> tuple[IdentifiedMode, ...]:
    """Return the modes of all states, each matched to the nearest in frequency.

    The state with most modes leads; modes that it does not have are added. Modes that no state has
    both of are one, if states between them lead from one to the other.
    """
    order = sorted(range(len(states)), key=lambda i: -len(states[i].modes))
    chains: list[dict[int, int]] = []
    for i in order:
        modes = states[i].modes
        centres = [_centre(chain, states) for chain in chains]
        taken: set[int] = set()
        if modes and centres:
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
    return tuple(
        _identified(f"mode{number}", chain, states) for number, chain in enumerate(chains, start=1)
    )


def _joined(chains: list[dict[int, int]], states: Sequence[State]) -> list[dict[int, int]]:
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


def _distance(one: dict[int, int], other: dict[int, int], states: Sequence[State]) -> float:
    """Between the nearest two of two chains, in ln f."""
    return min(
        abs(log(states[i].modes[k].frequency_hz.value / states[j].modes[n].frequency_hz.value))
        for i, k in one.items()
        for j, n in other.items()
    )


def _centre(chain: dict[int, int], states: Sequence[State]) -> float:
    logs = [log(states[i].modes[k].frequency_hz.value) for i, k in chain.items()]
    return float(np.exp(0.5 * (min(logs) + max(logs))))


def _identified(name: str, chain: dict[int, int], states: Sequence[State]) -> IdentifiedMode:
    seen = [states[i].modes[k] for i, k in chain.items()]
    frequency = middle_of([mode.frequency_hz for mode in seen])
    damping = middle_of([mode.damping_ratio for mode in seen])
    assert frequency is not None
    assert damping is not None
    return IdentifiedMode(
        name=name,
        frequency_hz=frequency,
        damping_ratio=damping,
        measured_gain=middle_of([mode.measured_gain for mode in seen]),
        tcp_gain=middle_of([mode.tcp_gain for mode in seen]),
        seen=tuple(chain.get(i) for i in range(len(states))),
    )


def middle_of(estimates: Sequence[Estimate | None]) -> Estimate | None:
    """Middle of some estimates; two standard errors reach the outermost."""
    known = [one for one in estimates if one is not None]
    if not known:
        return None
    low, high = min(one.value for one in known), max(one.value for one in known)
    typical = float(np.sqrt(np.mean([one.sigma**2 for one in known])))
    return Estimate(value=0.5 * (low + high), sigma=typical + 0.25 * (high - low))


def find_spread(states: Sequence[State], modes: Sequence[IdentifiedMode]) -> Spread:
    """Return the spreads that the corners must hold: the worst mode, at least a floor.

    max(2 sigma, half of the range over the states, floor) by the middle, for each mode; without the
    range where the states differ so much that each is judged by itself.
    """
    n, apart = len(states), _differ(states, modes)
    floor = FREQUENCY_FLOOR if n > 1 else FREQUENCY_FLOOR_OF_ONE
    kind = "identify-frequency-apart" if apart else "identify-frequency-floor"
    frequency = _Worst(floor, Message(kind, floor=floor, states=n))
    floor = DAMPING_FLOOR if n > 1 else DAMPING_FLOOR_OF_ONE
    kind = "identify-damping-apart" if apart else "identify-damping-floor"
    damping = _Worst(floor, Message(kind, floor=floor, states=n))
    for mode in modes:
        seen = [state.modes[k] for state, k in zip(states, mode.seen, strict=True) if k is not None]
        low, high, by_range, by_sigma = _reach([one.frequency_hz for one in seen], apart=apart)
        ends = {"low": low, "high": high, "states": len(seen)}
        frequency = frequency.or_if_worse(
            by_range, Message("identify-frequency-range", mode=mode.name, **ends)
        ).or_if_worse(
            by_sigma, Message("identify-frequency-sigma", mode=mode.name, spread=by_sigma)
        )
        low, high, by_range, by_sigma = _reach([one.damping_ratio for one in seen], apart=apart)
        ends = {"low": low, "high": high, "states": len(seen)}
        damping = damping.or_if_worse(
            by_range, Message("identify-damping-range", mode=mode.name, **ends)
        ).or_if_worse(by_sigma, Message("identify-damping-sigma", mode=mode.name, spread=by_sigma))
    return Spread(
        frequency=frequency.rounded,
        damping=damping.rounded,
        because=(frequency.why, damping.why),
        apart=apart,
    )


def _differ(states: Sequence[State], modes: Sequence[IdentifiedMode]) -> bool:
    """Whether a mode or the mass differs between states by more than its intervals."""
    if not 1 < len(states) <= MOST_STATES:
        return False
    known = [[state.moving_mass for state in states if state.moving_mass]]
    for mode in modes:
        pairs = zip(states, mode.seen, strict=True)
        known.append([state.modes[k].frequency_hz for state, k in pairs if k is not None])
    return any(
        abs(one.value - other.value) > APART * float(np.hypot(one.sigma, other.sigma))
        for values in known
        for one, other in combinations(values, 2)
    )


@dataclass(frozen=True, slots=True)
class _Worst:
    """The largest spread so far, and why."""

    spread: float
    why: Message

    def or_if_worse(self, spread: float, why: Message) -> _Worst:
        return _Worst(spread, why) if spread > self.spread else self

    @property
    def rounded(self) -> float:
        return STEP * ceil(self.spread / STEP - 1e-9)


def _reach(values: Sequence[Estimate], *, apart: bool) -> tuple[float, float, float, float]:
    """Ends of some values, half of their range and two standard errors by the middle."""
    low, high = min(one.value for one in values), max(one.value for one in values)
    by_sigma = 2.0 * max(one.sigma for one in values) / (0.5 * (low + high))
    return low, high, 0.0 if apart else (high - low) / (high + low), by_sigma
