"""A recorded signal of one move beside its prediction, on the same clock and by the same rules."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from mtcommission.verify.prediction import ENCODER, FORCE, TOOL, Prediction, Rebuilt
from mtcommission.verify.setpoint import Motion
from mtcommission.verify.trace import Array, Channel, Role, Trace, resolution

Flags = NDArray[np.bool_]

REST = 0.1
"""Of the rest before a move, what offset and noise are taken from [s]."""

FEWEST = 8
"""Samples without which nothing is said."""

SMOOTHED = 0.2
"""Window of the smoothing by the period of the fastest mode: it takes 0.1 % of that mode."""

LEAST_SIGMAS = 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Beside:
    """One signal of one move."""

    role: Role  # Tool, encoder (also from a following error), acceleration of the tool, or force
    t: Array  # Times of the samples, in the trace's time [s]
    measured: Array  # Position relative to the rest before it, or force, shape (n,) [m, N]
    predicted: Array  # The same in every corner, shape (n_corners, n)
    # Of a position: from the delayed setpoint, shape (n,) [m]; else as ``measured``.
    deviation: Array
    predicted_deviation: Array  # Likewise, shape (n_corners, n)
    raw: Array  # ``deviation`` before smoothing
    # noise, slack: What noise and resolution may add to a largest value of ``deviation``, and what
    # they may hide of it.
    noise: float
    slack: float
    offset: float  # Taken off: mean at rest before the move

    @property
    def is_position(self) -> bool:
        """Whether it is the position of tool or encoder."""
        return self.role in (Role.TOOL, Role.ENCODER)

    @property
    def step(self) -> float:
        """Of the clock [s]."""
        return float(self.t[1] - self.t[0])

    def after(self, instant: float) -> Flags:
        """Return which samples are at or after an instant."""
        return self.t >= instant - 1e-9


def lay_beside(
    rebuilt: Rebuilt, trace: Trace, motion: Motion, prediction: Prediction, *, shift: float
) -> tuple[Beside, ...]:
    """Return every recorded signal of a move beside its prediction."""
    found = []
    for role in (Role.TOOL, Role.ENCODER, Role.FOLLOWING_ERROR, Role.ACCELERATION, Role.FORCE):
        channel = trace.find(role)
        if channel is None or (role is Role.FOLLOWING_ERROR and trace.find(Role.ENCODER)):
            continue
        t, values = channel.between(motion.begin - REST, motion.until)
        if t.size >= 4 * FEWEST:
            found.append(_lay(rebuilt, channel, motion, prediction, t, values, shift))
    return tuple(found)


def _lay(
    rebuilt: Rebuilt,
    channel: Channel,
    motion: Motion,
    prediction: Prediction,
    t: Array,
    values: Array,
    shift: float,
) -> Beside:
    tau = rebuilt.controller.reference_delay
    late = motion.sample(t - tau - shift)[:, 0]
    role, at = channel.role, t - shift
    before = t < motion.begin - channel.step
    offset = 0.0
    if role is Role.FORCE:
        measured, predicted = values, prediction.at(at, FORCE)
        deviation, predicted_deviation = measured, predicted
    elif role is Role.ACCELERATION:
        rate = np.gradient(prediction.at(at, TOOL), channel.step, axis=1)
        predicted = predicted_deviation = np.asarray(np.gradient(rate, channel.step, axis=1))
        offset = float(np.mean(values[before])) if before.sum() >= FEWEST else 0.0
        measured = deviation = values - offset
    else:
        column = TOOL if role is Role.TOOL else ENCODER
        predicted = prediction.at(at, column)
        predicted_deviation = predicted - late
        is_error = role is Role.FOLLOWING_ERROR
        deviation = -values if is_error else values - motion.start - late
        offset = float(np.mean(deviation[before])) if before.sum() >= FEWEST else 0.0
        deviation = deviation - offset
        measured = deviation + late
    width = 1 if role is Role.FORCE else _width(rebuilt, channel.step)
    smooth = _smoothed(deviation, width)
    sigma, grain = _sigma(deviation, smooth, before, width), resolution(values)
    sigmas = max(sqrt(2.0 * log(max(t.size / width, 2.0))), LEAST_SIGMAS)
    return Beside(
        role=Role.ENCODER if role is Role.FOLLOWING_ERROR else role,
        t=t,
        measured=measured,
        predicted=predicted,
        deviation=smooth,
        predicted_deviation=np.array([_smoothed(row, width) for row in predicted_deviation]),
        raw=deviation,
        noise=sigmas * sigma + 0.5 * grain,
        slack=LEAST_SIGMAS * sigma + 0.5 * grain,
        offset=offset,
    )


def _width(rebuilt: Rebuilt, step: float) -> int:
    """Samples that are smoothed over; 1 for none."""
    fastest = max(mode.frequency_hz for mode in rebuilt.plant.modes)
    width = int(SMOOTHED / fastest / step) | 1
    return width if width >= 5 else 1


def _smoothed(values: Array, width: int) -> Array:
    if width == 1 or values.size <= width:
        return values
    return np.asarray(savgol_filter(values, width, 2), dtype=np.float64)


def _sigma(values: Array, smooth: Array, before: Flags, width: int) -> float:
    """Standard deviation of what is left of the noise."""
    second = np.abs(np.diff(values, n=2))
    scatter = 1.4826 * float(np.median(second)) / sqrt(6.0)
    if width > 1:
        scatter *= sqrt(float(np.sum(savgol_coeffs(width, 2) ** 2)))
    at_rest = smooth[before]
    rest = float(np.std(at_rest)) if at_rest.size >= FEWEST else 0.0
    return max(rest, scatter if rest == 0.0 else min(scatter, 2.0 * rest))


def find_shift(rebuilt: Rebuilt, motion: Motion, beside: Beside) -> tuple[float, float]:
    """Return by how much a position comes later than predicted, and the standard error [s].

    Least squares of measured less predicted position over the setpoint's velocity; a second
    column takes what follows the acceleration (mass, stiffness).
    """
    tau = rebuilt.controller.reference_delay
    moving = (beside.t >= motion.begin + tau) & (beside.t <= motion.end + tau)
    if moving.sum() < FEWEST:
        return 0.0, float("inf")
    rows = motion.sample(beside.t[moving] - tau)[:, 1:3]
    if rows.shape[0] < FEWEST or not np.any(rows[:, 0]):
        return 0.0, float("inf")
    wanted = (beside.raw - beside.predicted_deviation[0])[moving]
    scale = np.abs(rows).max(axis=0)
    scale[scale == 0.0] = 1.0
    found, *_ = np.linalg.lstsq(rows / scale, wanted, rcond=None)
    rest = wanted - rows / scale @ found
    gram = np.linalg.pinv((rows / scale).T @ (rows / scale))
    # The rest is no white noise: some ten samples of it are worth one.
    sigma = sqrt(10.0 * float(rest @ rest) / max(rest.size - 2, 1) * float(gram[0, 0]))
    return -float(found[0]) / scale[0], sigma / scale[0]
