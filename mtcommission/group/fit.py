"""A recorded circle -> centre, radius, ellipse and the peaks where its axes reverse.

Where an axis reverses, friction throws the tool off for a while; there the ellipse is not fitted:

    r(θ) = R + a cos θ + b sin θ + Re E cos 2θ + Im E sin 2θ

a and b are what is left of the centre. Unequal gains make Re E = R (g_x - g_y)/2, unequal delays
Im E = ± v (d_x - d_y)/2, the sign that of the direction, axes that are off a right angle by s
Im E = R s/2 in either.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.circle import AFTER
from mtcommission.group.traces import CircularTrace
from mtcommission.identify.formats.contents import refuse

Array = NDArray[np.float64]

NEAR = 0.02
"""Share of the radius within which a sample belongs to the circle (design choice)."""

SAME_TRAVEL = 0.1
"""By how much the travel of an axis may differ from its setpoint's; more is a wrong unit or column
(design choice)."""

STEADY = 0.05
"""Share of the feed within which it is constant."""

SMOOTHED = 2.5 * pi / 180.0
"""Angle to either side over which the feed is seen."""

SETTLED = 0.2
"""From the beginning of a constant feed on, what is left out where a turn remains [s]."""

TURN = 2.0 * pi * (1.0 - 1e-3)
"""What counts as a whole turn."""

BEFORE, BEHIND = 2.0 * pi / 180.0, 40.0 * pi / 180.0
"""Angle before a reversal, and at most behind it, that belongs to its peak."""

SIGMAS = 2.0
"""Standard deviations of an uncertainty."""

WHOLE = 1e-3
"""Of what a radius is taken to be a multiple where no setpoint was recorded [m]."""

FILTERED = 20e-6
"""By how much the radius of a recorded setpoint may be off a whole one, for it is recorded behind
the setpoint filter (design choice) [m]."""

LARGEST, SMALLEST = 2.0, 0.5e-3
"""Radii of circle tests; others are a wrong unit [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A value with its uncertainty."""

    value: float
    uncertainty: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedCircle:
    """A stretch of at least a turn at constant feed."""

    trace: CircularTrace
    radius: float  # nominal [m]
    is_assumed: bool  # whether that is only the nearest whole millimetre
    feed: float  # [m/s]
    direction: int  # 1 counterclockwise, -1 clockwise
    centre: tuple[float, float]  # [m]
    angle: Array  # of the tool about the centre, shape (n,) [rad]
    deviation: Array  # its distance from the centre less the nominal radius, shape (n,) [m]
    fitted: Array  # the same of the ellipse
    noise: float  # of a sample [m]
    design: Array  # that takes samples to the coefficients, shape (5, n)
    mean: Found  # mean radius less the nominal one [m]
    gain: Found  # Re E [m]
    skew: Found  # Im E [m]

    @property
    def omega(self) -> float:
        """Angular velocity [rad/s]."""
        return self.feed / self.radius

    @property
    def turns(self) -> float:
        """How often it goes round."""
        return float(np.ptp(self.angle)) / (2.0 * pi)

    def since(self, axis: int) -> Array:
        """Return the time since the last reversal of an axis of the plane, shape (n,) [s]."""
        return np.asarray(_behind(self.angle, axis, self.direction) / self.omega)

    def peak(self, axis: int) -> Found | None:
        """Return how far reversals of an axis throw the tool off [m]; None: none was seen."""
        left = self.deviation - self.fitted
        own = _behind(self.angle, axis, self.direction)
        window = min(AFTER * self.omega, BEHIND)
        inside = (own <= window) | (own >= pi - BEFORE)
        ends = np.flatnonzero(np.diff(inside.astype(int)))
        found, counts = [], []
        for begin, end in pairwise([-1, *ends, inside.size - 1]):
            piece = left[begin + 1 : end + 1]
            is_whole = begin >= 0 and end < inside.size - 1
            if is_whole and inside[begin + 1] and piece.size > 2:
                found.append(_largest(piece))
                counts.append(piece.size)
        if not found:
            return None
        white = self.noise * sqrt(2.0 * log(max(counts)))
        value = float(np.median([one.value for one in found]))
        spread = float(np.std([one.value for one in found])) / sqrt(len(found))
        coarse = max(one.uncertainty for one in found)
        return Found(value=value, uncertainty=white + spread + coarse)


def _largest(piece: Array) -> Found:
    """The largest deviation, and how much more it may have been between two samples."""
    k = int(np.clip(np.abs(piece).argmax(), 1, piece.size - 2))
    between = abs(float(piece[k - 1] - 2.0 * piece[k] + piece[k + 1])) / 8.0
    return Found(value=float(np.abs(piece).max()), uncertainty=between)


def _behind(angle: Array, axis: int, direction: int) -> Array:
    """Angle travelled since the last reversal of an axis, less than half a turn."""
    return np.asarray(np.mod(direction * (angle - 0.5 * pi * axis), pi))


def fit_circles(trace: CircularTrace) -> list[FittedCircle]:
    """Return every stretch of at least a turn at constant feed.

    Raises
    ------
    InputError
        There is none, or no circle at all.
    """
    told = trace.points if trace.reference is None else trace.reference
    centre, radius = _find_circle(told)
    if not SMALLEST <= radius <= LARGEST:
        raise refuse(trace.file, "group-trace-size", radius=radius)
    off = np.abs(np.hypot(*(told - centre).T) - radius)
    on = off <= NEAR * radius
    if on.mean() < 0.5:
        worst = int(off.argmax())
        raise refuse(
            trace.file, "group-trace-no-circle", line=trace.line(worst), off=float(off[worst])
        )
    angle = np.unwrap(np.arctan2(*(told - centre).T[::-1]))
    rate = _rate(trace.t, angle)
    _require_same_travel(trace, on)
    found, longest = [], (0.0, 0)
    for begin, end in _stretches(on, rate):
        span = abs(float(angle[end] - angle[begin]))
        longest = max(longest, (span, end))
        settled = int(np.searchsorted(trace.t, trace.t[begin] + SETTLED))
        if settled < end and abs(float(angle[end] - angle[settled])) >= TURN:
            begin = settled
        if span >= TURN:
            found.append(_fit(trace, slice(begin, end + 1), centre, radius, angle))
    if not found:
        got, last = longest
        raise refuse(
            trace.file, "group-trace-arc", line=trace.line(last), got=round(got * 180.0 / pi)
        )
    return found


def _require_same_travel(trace: CircularTrace, on: NDArray[np.bool_]) -> None:
    """Raise InputError where actual positions travel otherwise than the setpoint."""
    if trace.reference is None:
        return
    names = list(trace.columns.values())
    for column in (0, 1):
        told = float(np.ptp(trace.reference[on, column]))
        ratio = float(np.ptp(trace.points[on, column])) / told
        if abs(ratio - 1.0) > SAME_TRAVEL:
            name, reference = names[column], names[2 + column]
            raise refuse(
                trace.file, "verify-other-travel", name=name, reference=reference, ratio=ratio
            )


def _find_circle(points: Array) -> tuple[Array, float]:
    """Centre and radius by least squares, of the samples that lie on a circle."""
    centre = 0.5 * (points.max(axis=0) + points.min(axis=0))
    radius = 0.25 * float(np.ptp(points, axis=0).sum())
    for _ in range(4):
        distance = np.hypot(*(points - centre).T)
        near = np.abs(distance - radius) <= NEAR * radius
        if near.sum() < 3:
            break
        own = points[near] - centre
        A = np.column_stack([2.0 * own, np.ones(len(own))])
        (a, b, c), *_ = np.linalg.lstsq(A, (own**2).sum(axis=1), rcond=None)
        centre, radius = centre + np.array([a, b]), sqrt(max(c + a**2 + b**2, 0.0))
    return centre, radius


def _rate(t: Array, angle: Array) -> Array:
    """Angular velocity, over a few degrees at each sample [rad/s]."""
    step = float(np.abs(np.diff(angle)).mean())
    width = int(np.clip(round(SMOOTHED / max(step, 1e-9)), 1, max(angle.size // 8, 1)))
    n = np.arange(angle.size)
    before, behind = np.maximum(n - width, 0), np.minimum(n + width, angle.size - 1)
    return np.asarray((angle[behind] - angle[before]) / (t[behind] - t[before]))


def _stretches(on: NDArray[np.bool_], rate: Array) -> Iterator[tuple[int, int]]:
    """First and last sample of each stretch on the circle at constant feed."""
    fast = float(np.quantile(np.abs(rate[on]), 0.9))
    state = np.where(on & (np.abs(rate) > 0.5 * fast), np.sign(rate), 0.0)
    ends = [0, *(np.flatnonzero(np.diff(state)) + 1).tolist(), state.size]
    for begin, end in pairwise(ends):
        if state[begin] == 0.0:
            continue
        usual = float(np.median(rate[begin:end]))
        steady = np.abs(rate[begin:end] - usual) <= STEADY * abs(usual)
        bounds = [0, *(np.flatnonzero(np.diff(steady.astype(int))) + 1).tolist(), steady.size]
        runs = [(b - a, a, b) for a, b in pairwise(bounds) if steady[a]]
        if runs:
            _, a, b = max(runs)
            yield begin + a, begin + b - 1


def _fit(
    trace: CircularTrace, part: slice, centre: Array, radius: float, told: Array
) -> FittedCircle:
    turned = float(told[part][-1] - told[part][0])
    direction = 1 if turned > 0.0 else -1
    whole, is_assumed = max(round(radius / WHOLE), 1) * WHOLE, trace.reference is None
    nominal = whole if is_assumed or abs(radius - whole) <= FILTERED else radius
    feed = nominal * abs(turned) / float(trace.t[part][-1] - trace.t[part][0])
    points = trace.points[part]
    middle = _find_circle(points)[0]
    window = min(AFTER * feed / nominal, BEHIND)
    for _ in range(3):
        own = points - middle
        angle, off = np.unwrap(np.arctan2(own[:, 1], own[:, 0])), np.hypot(*own.T) - nominal
        behind = [_behind(angle, axis, direction) for axis in (0, 1)]
        kept = np.all([(b > window) & (b < pi - BEFORE) for b in behind], axis=0)
        waves = [f(k * angle) for k in (1, 2) for f in (np.cos, np.sin)]
        A = np.column_stack([np.ones(angle.size), *waves])
        design = np.zeros((A.shape[1], angle.size))
        design[:, kept] = np.linalg.pinv(A[kept])
        found = design @ off
        middle = middle + found[1:3]
    left = off - A @ found
    rest = left[kept]
    spread = float(np.sqrt(rest @ rest / max(rest.size - A.shape[1], 1)))
    alike = float(np.clip(rest[1:] @ rest[:-1] / max(rest @ rest, 1e-300), 0.0, 0.999))
    sigma = SIGMAS * spread * np.sqrt((design**2).sum(axis=1) * (1.0 + alike) / (1.0 - alike))
    return FittedCircle(
        trace=trace,
        radius=nominal,
        is_assumed=is_assumed,
        feed=feed,
        direction=direction,
        centre=(float(middle[0]), float(middle[1])),
        angle=angle,
        deviation=off,
        fitted=A @ found,
        noise=float(np.std(np.diff(rest))) / sqrt(2.0),
        design=design,
        mean=Found(value=float(found[0]), uncertainty=float(sigma[0])),
        gain=Found(value=float(found[3]), uncertainty=float(sigma[3])),
        skew=Found(value=float(found[4]), uncertainty=float(sigma[4])),
    )
