"""Answers of the loop at rest to what sets in: a force on the axis, an error of the encoder.

What an encoder that counts in steps q says is wrong by up to half a step. While the axis moves over
many steps in a velocity cycle, the error is as good as white noise of variance q²/12. At rest it is
not: the axis stands somewhere between two steps, and integrator and position controller carry it to
and fro across their border. Seen in simulations, that stays below what one change of the count
does, the whole swing after a step of q.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop, discretise_disturbance

Array = NDArray[np.float64]

SIGMAS = 3.0
"""Of the white noise: 99.7 % of the samples of a normal distribution lie within."""

SWING = 1.0
"""How long the answer to a change of the count is followed [s]: its peak is among the first swings,
and no servo is slower (empirical)."""

DOUBLINGS = 30
"""The noise is summed over 2^30 position cycles: days."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DisturbanceStep:
    """Response of the tool to a step of force on the line of the drive."""

    t: Array  # every velocity cycle from the step on, shape (n_samples,) [s]
    deflection: Array  # tool displacement per newton, shape (n_samples,) [m/N]

    @property
    def peak(self) -> float:
        """Largest displacement per newton [m/N]."""
        return float(np.max(np.abs(self.deflection)))


def simulate_disturbance(loop: SampledLoop, *, duration: float) -> DisturbanceStep:
    """Return how the tool gives way to a step of force, at rest before it, for a duration [s].

    The step begins with a position cycle; the setpoint rests, the force is not saturated.
    """
    T_v, push = loop.controller.velocity_cycle, np.zeros(len(loop.states))
    push[: loop.plant.order] = discretise_disturbance(loop.plant, T_v)
    nothing = np.zeros(len(loop.states) - loop.held)
    found = _step_response(loop, push, nothing, duration)[:, 0]
    t = np.arange(len(found), dtype=np.float64) * T_v
    return DisturbanceStep(t=t, deflection=found)


@dataclass(frozen=True, slots=True, kw_only=True)
class EncoderNoise:
    """What the steps of an encoder add to the motion, either way."""

    tool: float  # position [m]
    force: float  # set force [N]


@lru_cache(maxsize=128)
def encoder_noise(loop: SampledLoop, *, resolution: float) -> EncoderNoise:
    """Return within what tool and set force stay of where they would be with a perfect encoder.

    Of a stable loop whose encoder has steps q = ``resolution`` [m] (0: none), the larger of: three
    sigmas of white noise in the velocity cycle in which they are most, at the tool beside half a
    step for where the axis stands; and what one change of the count does, at the tool the peak
    after it (half a step for where the axis stands, the rest for how it swings about that), in the
    force from peak to peak, because the count may change back at the worst moment.

    Source: variance of rounding q²/12 (Widrow & Kollár, Quantization Noise, 2008); the rest is
    derived here, and held to simulations that round every sample (docs/feedback-loop.md).
    """
    if resolution == 0.0:
        return EncoderNoise(tool=0.0, force=0.0)
    noise = SIGMAS / sqrt(12.0) * _standard_deviations(loop)
    sample, handed_down = loop.sensed
    swings = _step_response(loop, sample, handed_down[loop.held :], SWING)
    tool, force = np.abs(swings[:, 0]).max(), np.ptp(swings[:, 1])
    return EncoderNoise(
        tool=resolution * max(float(noise[0]) + 0.5, float(tool)),
        force=resolution * max(float(noise[1]), float(force)),
    )


def worst_noise(loops: Sequence[SampledLoop], resolution: float) -> EncoderNoise:
    """Return the largest of both over some loops."""
    found = [encoder_noise(loop, resolution=resolution) for loop in loops]
    tool, force = max(noise.tool for noise in found), max(noise.force for noise in found)
    return EncoderNoise(tool=tool, force=force)


def _standard_deviations(loop: SampledLoop) -> Array:
    """Of tool and set force under white noise of variance 1 on the encoder, shape (2,).

    The covariance at the beginning of a position cycle solves P = A P Aᵀ + Q. It is summed by
    doubling: scipy's solver loses all digits where a loop holds states of very different size.
    """
    rows, cycle, A = _seen(loop), loop.cycle, loop.lifted.A
    sample, handed_down = loop.sensed
    entries = [sample]
    for _ in range(loop.controller.cycles - 1):
        entries.append(cycle @ entries[-1])
    G = np.array(entries).T
    # What was handed down is replaced at the end of the cycle; the first sample counts for it.
    G[loop.held :] = 0.0
    G[:, -1] += handed_down
    P = G @ G.T
    for _ in range(DOUBLINGS):
        P, A = P + A @ P @ A.T, A @ A
    largest = np.zeros(2)
    for _ in range(loop.controller.cycles):
        largest = np.maximum(largest, np.sum(rows @ P * rows, axis=1))
        P = cycle @ P @ cycle.T + np.outer(sample, sample)
    return np.sqrt(largest)


def _step_response(loop: SampledLoop, entry: Array, handed_down: Array, duration: float) -> Array:
    """Tool and set force at every velocity cycle after a constant input sets in, (n, 2).

    ``entry``: what the input adds to the loop's states in a velocity cycle, ``handed_down``: to
    what is held, in a position cycle. It begins with a position cycle.
    """
    size, rows, cycle, A = len(loop.states), _seen(loop), loop.cycle, loop.lifted.A
    seen, added, state, pushed = [], [], np.eye(size), np.zeros(size)
    for _ in range(loop.controller.cycles):
        seen.append(rows @ state)
        added.append(rows @ pushed)
        state, pushed = cycle @ state, cycle @ pushed + entry
    pushed[loop.held :] = handed_down
    states = np.zeros((ceil(duration / loop.controller.position_cycle), size))
    known, power = 1, A  # the states so far, and what takes them on by as many cycles
    while known < len(states):
        after = A @ states[known - 1] + pushed
        more = states[known : 2 * known]
        more[:] = states[: len(more)] @ power.T + after
        known, power = 2 * known, power @ power
    found = states @ np.vstack(seen).T + np.concatenate(added)
    return np.asarray(found.reshape(-1, len(rows)))


def _seen(loop: SampledLoop) -> Array:
    """Tool and set force, over the loop's states."""
    return loop.observation[[0, 2]]
