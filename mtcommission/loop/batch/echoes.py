"""What one step of the jerk leaves behind: the answer of a loop, from which every move is a sum.

A setpoint is a sum of jerk steps, so whatever a linear loop does with it is the same sum of one
function of time, its echo: the answer to a step of 1 m/s³. Where a step falls between two position
cycles changes the tool's answer a little: its echo is the mean over all these phases. The force
swings inside a position cycle where setpoints are held, so it is heard where it is largest.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import require_room, spend
from mtcommission.loop.batch.tables import following_states, search_horizon
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.machine.setpoint_filter import SetpointFilter

Array = NDArray[np.float64]
Weights = tuple[tuple[int, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Echoes:
    """Answers of a loop in every corner to one step of the jerk.

    Parameters
    ----------
    dt
        Spacing of the samples [s].
    delay
        τ, after which the tool is judged [s].
    deviation
        Of the tool from the delayed setpoint, shape (n_corners, n_samples) [m per m/s³].
    signals
        Of what is bounded besides, at some velocity cycles of each position cycle, shape
        (n_cycles, n_signals, n_corners, n_samples).
    """

    dt: float
    delay: float
    deviation: Array
    signals: Array


def listen(loops: Sequence[SampledLoop], *, signals: Array, spacing: float) -> Echoes:
    """Return the echoes of a loop in every corner.

    Parameters
    ----------
    loops
        The same controller on the machine in every corner.
    signals
        Rows over the outputs of a velocity cycle, shape (n_signals, n_outputs).
    spacing
        Wanted distance of samples [s]; rounded to whole velocity cycles.

    Returns
    -------
    Echoes
        Until the slowest mode has decayed, at most some seconds.
    """
    controller = loops[0].controller
    every = max(round(spacing / controller.velocity_cycle), 1)
    seen = within_cycle(loops[0], signals)
    found = [_listen(loop, signals, seen) for loop in loops]
    size = max(item.shape[1] for item in found)
    # A signal that has come to rest goes on as it is, or at the rate at which it grows.
    padded = np.stack([_extended(item, size) for item in found], axis=1)[:, :, ::every]
    return Echoes(
        dt=every * controller.velocity_cycle,
        delay=controller.reference_delay,
        deviation=padded[0],
        signals=padded[1:].reshape(len(seen), len(signals), *padded.shape[1:]),
    )


def less_delayed(y: Array, lag: int) -> Array:
    """Return (1 - D^lag) y: rows less the same some samples later."""
    result = y.copy()
    if lag < y.shape[1]:
        result[:, lag:] -= y[:, : y.shape[1] - lag]
    return result


def cubic(lag: float) -> Weights:
    """Return whole lags and weights that stand for one between them, for smooth answers: Lagrange.

    To the nearest sample a shaper would be detuned by up to half of one, 1 % at 45 Hz and 0.25 ms,
    which leaves as much vibration as a good part of its spread does.
    """
    n = int(lag + 1e-9)
    p = lag - n
    if n == 0 or abs(p) < 1e-9:
        return linear(lag)
    return (
        (n - 1, -p * (p - 1.0) * (p - 2.0) / 6.0),
        (n, (p * p - 1.0) * (p - 2.0) / 2.0),
        (n + 1, -p * (p + 1.0) * (p - 2.0) / 2.0),
        (n + 2, p * (p * p - 1.0) / 6.0),
    )


def linear(lag: float) -> Weights:
    """Return the two whole lags about one and their weights: never more than the answers have."""
    n = int(lag + 1e-9)
    p = max(lag - n, 0.0)
    return (n, 1.0 - p), (n + 1, p)


def behind_filter(
    answers: Array,
    item: SetpointFilter | None,
    *,
    dt: float,
    between: Callable[[float], Weights] = cubic,
) -> Array:
    """Return answers behind a setpoint filter.

    Parameters
    ----------
    answers
        Shape (n_rows, n_samples).
    item
        The filter.
    dt
        Spacing [s].
    between
        How a lag between samples is made.

    Returns
    -------
    ndarray
        Lengths of averages are rounded to samples, delays of impulses are not. Longer by the
        filter's duration where the answers are not much longer than that.
    """
    if item is None:
        return answers
    length = int(np.ceil(item.duration / dt)) + 3
    if 2 * length > answers.shape[1]:  # the filter is still moving when the answer has ended
        answers = _extended(answers, answers.shape[1] + length)
    for time in item.averages:
        lag = max(round(time / dt), 1)
        total = np.cumsum(answers, axis=1)
        centred = total - 0.5 * answers
        answers = less_delayed(centred, lag) / lag
    times, shares = item.impulses
    if len(times) > 1:
        copies = np.zeros_like(answers)
        for time, share in zip(times, shares, strict=True):
            for lag, weight in between(time / dt):
                copies[:, lag:] += share * weight * answers[:, : answers.shape[1] - lag]
        answers = copies
    return answers


def _listen(loop: SampledLoop, signals: Array, seen: Sequence[int]) -> Array:
    """Deviation and signals at every velocity cycle after the step, (1 + n_seen, n)."""
    lifted, controller = loop.lifted, loop.controller
    T, T_v, N = lifted.dt, controller.velocity_cycle, controller.cycles
    tau = controller.reference_delay
    count = int(np.ceil(search_horizon(lifted) / T)) + 1
    rows = np.vstack([np.eye(1, signals.shape[1]), signals])
    C = rows @ lifted.C.reshape(N, signals.shape[1], -1)  # (N, n_rows, n)
    S = following_states(lifted, 3)
    within = T_v * np.arange(N)
    values = float(count * N * len(rows))
    require_room(4.0 * values, array="allowance-echoes")
    spend(values * 2.0 * (len(lifted.A) + 10.0 * N), calls=0.5 * count)
    # Steady answers to the k-th derivative of the position, (4, N, n_rows).
    steady = np.einsum("irn,kn->kir", C, S)
    for k in range(4):
        steady[k, :, 0] -= (within - tau) ** k / factorial(k)
    X = np.empty((count, 4, len(lifted.A)))
    X[0] = -S[::-1]  # basis p steps the (3 - p)-th derivative
    for n in range(1, count):
        X[n] = X[n - 1] @ lifted.A.T
    fading = np.einsum("irn,cpn->pcir", C, X).reshape(4, count * N, len(rows))
    steady_in = np.tile(steady, (1, count, 1))
    begun = np.repeat(T * np.arange(count), N)
    total = np.zeros((count * N, 1))
    at = np.zeros((len(seen), count * N, len(signals)))
    for phase in range(N):
        early = phase * T_v
        answer = sum(early**p / factorial(p) * fading[p] for p in range(4))
        age = begun + early
        answer = answer + sum(
            (age ** (3 - k) / factorial(3 - k))[:, None] * steady_in[k] for k in range(4)
        )
        total[phase:] += answer[: len(total) - phase, :1]
        for place, i in enumerate(seen):
            at[place, i + phase :: N] = answer[i : len(total) - phase : N, 1:]
    # A step just before a sample is not heard before it: until then the answer is nothing.
    return np.vstack([(total / N).T, at.transpose(0, 2, 1).reshape(-1, count * N)])


def within_cycle(loop: SampledLoop, signals: Array) -> list[int]:
    """Return at which velocity cycles of a position cycle signals are looked at.

    Those at which steady acceleration, and steady jerk, ask for most of the first signal.
    """
    if not len(signals):
        return []
    lifted, N = loop.lifted, loop.controller.cycles
    C = signals[:1] @ lifted.C.reshape(N, signals.shape[1], -1)
    largest = np.abs(C @ following_states(lifted, 3).T)[:, :, 2:]  # (N, 1, derivatives)
    return sorted({int(i) for i in largest.argmax(axis=0).ravel()})


def _extended(answer: Array, size: int) -> Array:
    missing = size - answer.shape[1]
    if not missing:
        return answer
    slope = answer[:, -1] - answer[:, -2]
    return np.hstack([answer, answer[:, -1:] + slope[:, None] * np.arange(1, missing + 1)])
