"""How the recommended limits fare on thousands of machines inside the stated spread.

Only the plant differs from one sample to the next, so the loops of all samples advance
together: their plants are discretised in one go (Taylor series, converged to rounding at the
velocity cycle), lifted to the position cycle, and driven by the same setpoint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil, inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.limits import MotionLimits
from mtcommission.loop.response import DECAYED, HORIZON
from mtcommission.loop.sampled import SampledLoop
from mtcommission.loop.tuning import TunedLoop
from mtcommission.machine import Corner, Machine, Manipulator, corners
from mtcommission.plant import Plant
from mtcommission.rules import longest_period
from mtcommission.setpoint import Setpoint, plan_setpoint, sample_setpoint

Array = NDArray[np.float64]

TAYLOR_TERMS = 18
"""Of the matrix exponential: poles times velocity cycle stay below 2, and 2^18/18! < 1e-10;
typical axes (below 0.5) reach rounding."""

CHUNK = 1000
"""Samples advanced at once: keeps their matrices in the cache (measured)."""

EARLIEST_STOP = 0.02
"""Shortest stretch of free motion after which a sample may count as decayed [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Variations:
    """Machines that differ from the nominal one.

    Parameters
    ----------
    payload
        Shape (n_samples,) [kg].
    frequency_factor, damping_factor
        Factors on all eigenfrequencies and damping ratios, shape (n_samples,) [-].
    """

    payload: Array
    frequency_factor: Array
    damping_factor: Array

    def corner(self, index: int) -> Corner:
        """Return one sample as a corner."""
        return Corner(
            payload=float(self.payload[index]),
            frequency_factor=float(self.frequency_factor[index]),
            damping_factor=float(self.damping_factor[index]),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MonteCarlo:
    """Distribution of settling time and residual deviation over the stated spread.

    Parameters
    ----------
    variations
        The machines drawn.
    settling_time, residual_deviation
        Of the slowest move and the worst move, shape (n_samples,) [s, m]; inf: not settled.
    share_in_band
        Share of samples whose residual deviation is within the band [-].
    worst
        The sample with the largest residual deviation.
    seed
        Of the generator.
    """

    variations: Variations
    settling_time: Array
    residual_deviation: Array
    share_in_band: float
    worst: Corner
    seed: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """What a small change costs, worst over moves and corners.

    Parameters
    ----------
    change
        What was changed, for the sheet.
    settling_time, residual_deviation
        After the change [s, m].
    settling_change, residual_change
        Relative to the unchanged ones [-]; inf or nan where a response does not settle.
    """

    change: str
    settling_time: float
    residual_deviation: float
    settling_change: float
    residual_change: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VariedResponse:
    """What limits do on many machines.

    Parameters
    ----------
    settling_time
        Slowest move, shape (n_samples,) [s]; inf where it has not decayed within the horizon.
    residual_deviation
        Worst move, shape (n_samples,) [m].
    """

    settling_time: Array
    residual_deviation: Array


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Lifted:
    """Loops of many samples at the position cycle, without the kept setpoint samples.

    X⁺ = A X + input, tool at velocity cycle i of it: tool[:, i] X.
    """

    A: Array
    tool: Array


@dataclass(slots=True, kw_only=True, eq=False)
class _Progress:
    """What is known so far of the free motion of one chunk."""

    settling: Array
    residual: Array
    last: Array = field(default_factory=lambda: np.zeros(0))


def run_monte_carlo(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    samples: int = 10_000,
    seed: int = 0,
) -> MonteCarlo:
    """Return settling time and residual deviation over the stated spread.

    Payload, frequency factor and damping factor are drawn uniformly and independently from
    their stated ranges.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the controller is the same on every sample.
    limits
        Acceleration and jerk.
    samples
        How many machines.
    seed
        Of the generator.

    Returns
    -------
    MonteCarlo
        Force and peaks are not judged here.
    """
    variations = draw_variations(machine, samples=samples, seed=seed)
    found = respond_to_variations(machine, plant, tuned, limits, variations=variations)
    band = machine.requirements.tcp_deviation
    return MonteCarlo(
        variations=variations,
        settling_time=found.settling_time,
        residual_deviation=found.residual_deviation,
        share_in_band=float(np.mean(found.residual_deviation <= band)),
        worst=variations.corner(int(np.argmax(found.residual_deviation))),
        seed=seed,
    )


def draw_variations(machine: Machine, *, samples: int, seed: int) -> Variations:
    """Return machines drawn uniformly from the stated ranges.

    Parameters
    ----------
    machine
        Its requirements state payload and spreads.
    samples
        How many.
    seed
        Of the generator.

    Returns
    -------
    Variations
    """
    generator, needs = np.random.default_rng(seed), machine.requirements

    def factor(spread: float) -> Array:
        return generator.uniform(1.0 - spread, 1.0 + spread, samples)

    return Variations(
        payload=generator.uniform(*needs.payload, samples),
        frequency_factor=factor(needs.frequency_spread),
        damping_factor=factor(needs.damping_spread),
    )


def find_sensitivities(
    machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits
) -> tuple[Sensitivity, ...]:
    """Return what small changes of limits and machine cost, in all corners.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop.
    limits
        Acceleration and jerk.

    Returns
    -------
    tuple of Sensitivity
        10 % more and less jerk and acceleration; all frequencies, in every corner, 1 % higher
        and lower; 10 % less damping.
    """
    places = as_variations(corners(machine))
    a, j = limits.acceleration, limits.jerk
    cases = [
        ("jerk +10 %", MotionLimits(acceleration=a, jerk=1.1 * j), places),
        ("jerk -10 %", MotionLimits(acceleration=a, jerk=0.9 * j), places),
        ("acceleration +10 %", MotionLimits(acceleration=1.1 * a, jerk=j), places),
        ("acceleration -10 %", MotionLimits(acceleration=0.9 * a, jerk=j), places),
        ("frequencies +1 %", limits, _scaled(places, frequency=1.01)),
        ("frequencies -1 %", limits, _scaled(places, frequency=0.99)),
        ("damping -10 %", limits, _scaled(places, damping=0.9)),
    ]
    base = _worst(machine, plant, tuned, limits, places)
    found = []
    for change, varied, variations in cases:
        settling, residual = _worst(machine, plant, tuned, varied, variations)
        found.append(
            Sensitivity(
                change=change,
                settling_time=settling,
                residual_deviation=residual,
                settling_change=settling / base[0] - 1.0,
                residual_change=residual / base[1] - 1.0,
            )
        )
    return tuple(found)


def _worst(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    variations: Variations,
) -> tuple[float, float]:
    found = respond_to_variations(machine, plant, tuned, limits, variations=variations)
    return float(found.settling_time.max()), float(found.residual_deviation.max())


def as_variations(places: Sequence[Corner]) -> Variations:
    """Return corners as variations, in the same order."""
    return Variations(
        payload=np.array([corner.payload for corner in places]),
        frequency_factor=np.array([corner.frequency_factor for corner in places]),
        damping_factor=np.array([corner.damping_factor for corner in places]),
    )


def _scaled(variations: Variations, *, frequency: float = 1.0, damping: float = 1.0) -> Variations:
    return replace(
        variations,
        frequency_factor=variations.frequency_factor * frequency,
        damping_factor=variations.damping_factor * damping,
    )


def respond_to_variations(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    *,
    variations: Variations,
) -> VariedResponse:
    """Return settling time and residual deviation of the same limits on many machines.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    limits
        Acceleration and jerk.
    variations
        The machines.

    Returns
    -------
    VariedResponse
    """
    time = machine.control.moving_average_time
    setpoints = [plan_setpoint(move, limits, moving_average=time) for move in machine.moves]
    return follow_setpoints(machine, plant, tuned, setpoints, variations=variations)


def follow_setpoints(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    setpoints: Sequence[Setpoint],
    *,
    variations: Variations,
) -> VariedResponse:
    """Return settling time and residual deviation of given setpoints on many machines.

    Parameters
    ----------
    machine, plant
        The nominal machine and its plant.
    tuned
        Its loop; the force is not saturated here.
    setpoints
        One for each move, filters included.
    variations
        The machines.

    Returns
    -------
    VariedResponse
        Worst over the setpoints.
    """
    count = len(variations.payload)
    settling, residual = np.zeros(count), np.zeros(count)
    for start in range(0, count, CHUNK):
        part = slice(start, start + CHUNK)
        A, B = _discretise_all(machine, plant, tuned, variations, part)
        lifted = _lift_all(tuned.loops[0], A, B)
        for setpoint in setpoints:
            found = _respond(machine, plant, tuned.loops[0], lifted, setpoint)
            settling[part] = np.maximum(settling[part], found.settling)
            residual[part] = np.maximum(residual[part], found.residual)
    return VariedResponse(settling_time=settling, residual_deviation=residual)


def _discretise_all(
    machine: Machine, plant: Plant, tuned: TunedLoop, variations: Variations, part: slice
) -> tuple[Array, Array]:
    """Zero-order-hold plants of the samples over a velocity cycle, (n_samples, n, n), (…, n)."""
    payload = variations.payload[part]
    s, d = variations.frequency_factor[part], variations.damping_factor[part]
    n = plant.order
    joint = np.zeros((len(payload), n + 1, n + 1))
    joint[:, :n, :n], joint[:, :n, n] = plant.A, plant.B
    joint[:, plant.velocity, plant.force] = 1.0 / (plant.moving_mass + payload)
    for mode in plant.modes:
        loosened = _inertia_ratio(machine, mode.name, payload)
        joint[:, mode.rate, mode.deflection] *= s**2 * loosened
        joint[:, mode.rate, mode.rate] *= s * d * loosened
        joint[:, mode.rate, plant.force] *= loosened
    joint *= tuned.controller.velocity_cycle
    eye = np.eye(n + 1)
    result = np.broadcast_to(eye, joint.shape)
    for k in range(TAYLOR_TERMS, 0, -1):
        result = eye + (joint / k) @ result
    return result[:, :n, :n], result[:, :n, n]


def _inertia_ratio(machine: Machine, mode: str, payload: Array) -> Array:
    """Rotary inertia without payload over that with it; 1 for all modes but the tower's."""
    mechanics = machine.mechanics
    if not isinstance(mechanics, Manipulator) or mode != "rotation":
        return np.ones_like(payload)
    J = mechanics.rotary_inertia
    return np.asarray(J / (J + payload * machine.requirements.payload_radius**2))


def _lift_all(loop: SampledLoop, A: Array, B: Array) -> _Lifted:
    """The lifted loops; the rows of the controller do not depend on the sample."""
    n, z, size = loop.plant.order, loop.integrator, _own_size(loop)
    cycle = np.repeat(loop.step[None, :size, :size], len(A), axis=0)
    cycle[:, :n, :n], cycle[:, :n, z + 1] = A, B
    cycle[:, z] += loop.integration[:size]
    cycle[:, z + 1] = loop.demand[:size]
    row = np.repeat(loop.observation[:1, :size][None], len(A), axis=0)
    tool = []
    for _ in range(loop.controller.cycles):
        tool.append(row)
        row = row @ cycle
    lifted = np.linalg.matrix_power(cycle, loop.controller.cycles)
    lifted[:, loop.held :] = loop.handed_down[:, :size]
    return _Lifted(A=lifted, tool=np.concatenate(tool, axis=1))


def _own_size(loop: SampledLoop) -> int:
    """Number of loop states up to the held values, without the kept setpoint samples."""
    return loop.held + len(loop.handed_down)


def _handed_down(loop: SampledLoop, setpoint: Setpoint, cycles: int) -> Array:
    """What the setpoint alone hands down at each position cycle, shape (cycles, n_held)."""
    rows = loop.handed_down[:, _own_size(loop) :]
    kept = (rows.shape[1] - 4) // 4
    T_p = loop.controller.position_cycle
    times = np.arange(-kept, cycles, dtype=np.float64) * T_p
    references = sample_setpoint(setpoint, times)
    now = references[kept:] @ rows[:, -4:].T
    for back in range(1, kept + 1):
        columns = rows[:, 4 * (back - 1) : 4 * back]
        now += references[kept - back : len(references) - back] @ columns.T
    return np.asarray(now)


def _respond(
    machine: Machine, plant: Plant, loop: SampledLoop, lifted: _Lifted, setpoint: Setpoint
) -> _Progress:
    """Settling time and residual of one setpoint on all samples of a chunk."""
    T_p, tau = loop.controller.position_cycle, loop.controller.reference_delay
    until = setpoint.duration + tau
    first = int(until / T_p)
    stretch = ceil(max(min(longest_period(plant), 0.2), EARLIEST_STOP) / T_p)
    last = first + ceil(HORIZON / T_p)
    fed = _handed_down(loop, setpoint, last + stretch)
    A, tool, held = lifted.A, lifted.tool, loop.held
    X = np.zeros((len(A), A.shape[1], 1))
    for k in range(first):
        X = A @ X
        X[:, held:, 0] += fed[k]
    progress = _Progress(settling=np.full(len(A), until), residual=np.zeros(len(A)))
    alive = np.arange(len(A))
    band, step = machine.requirements.tcp_deviation, loop.controller.velocity_cycle
    for start in range(first, last, stretch):
        pieces = []
        for k in range(start, start + stretch):
            pieces.append((tool @ X)[:, :, 0])
            X = A @ X
            X[:, held:, 0] += fed[k]
        t = start * T_p + step * np.arange(stretch * tool.shape[1])
        tip = np.concatenate(pieces, axis=1) - sample_setpoint(setpoint, t - tau)[:, 0]
        moving = _note(progress, alive, t, np.abs(tip), until=until, band=band)
        alive, A, tool, X = alive[moving], A[moving], tool[moving], X[moving]
        if not alive.size:
            return progress
        progress.last = progress.last[moving]
    progress.settling[alive], progress.residual[alive] = inf, inf
    return progress


def _note(
    progress: _Progress, alive: NDArray[np.intp], t: Array, e: Array, *, until: float, band: float
) -> NDArray[np.bool_]:
    """Add a stretch of |e| to what is known; return which samples have not decayed yet."""
    e[:, t < until - 1e-12] = 0.0
    progress.residual[alive] = np.maximum(progress.residual[alive], e.max(axis=1))
    step = t[1] - t[0]
    if progress.last.size:  # a crossing may lie between two stretches
        e = np.hstack([progress.last[:, None], e])
        t = np.concatenate([[t[0] - step], t])
    outside = e > band
    row = np.flatnonzero(outside.any(axis=1))
    final = e.shape[1] - 1 - np.argmax(outside[row, ::-1], axis=1)
    following = np.minimum(final + 1, e.shape[1] - 1)
    here, there = e[row, final], e[row, following]
    share = np.where(following > final, (here - band) / np.maximum(here - there, 1e-300), 0.0)
    progress.settling[alive[row]] = np.maximum(until, t[final] + step * share)
    progress.last = e[:, -1]
    return np.asarray(e.max(axis=1) > DECAYED * band)
