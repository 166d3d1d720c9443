"""A recorded circle -> centre, radius, ellipse and the peaks where its axes reverse.

Where an axis reverses, friction throws the tool off for a while; there the ellipse is not fitted:

    r(θ) = R + a cos θ + b sin θ + Re E cos 2θ + Im E sin 2θ

a and b are what is left of the centre. Unequal gains make Re E = R (g_x - g_y)/2, unequal delays
Im E = ± v (d_x - d_y)/2, the sign that of the direction, axes that are off a right angle by s
Im E = R s/2 in either.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.follow import AFTER
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

SEEN = 5
"""Samples about a reversal without which its peak is not told (design choice)."""

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
    centre: Array  # shape (2,) [m]
    angle: Array  # of the tool about the centre, shape (n,) [rad]
    deviation: Array  # its distance from the centre less the nominal radius, shape (n,) [m]
    fitted: Array  # the same of the ellipse
    noise: float  # of a sample [m]
    design: Array  # that takes samples to the coefficients, shape (5, n)
    found: Array
    """Mean radius less the nominal one, a, b, Re E, Im E, shape (5,) [m]."""
    uncertainty: Array  # of these, shape (5,) [m]

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
        """Return how far reversals of an axis throw the tool off [m]; None: none was seen.

        Of several the middle one; unsure by their spread, by the largest of so many samples' noise,
        and by what lies between two of these.
        """
        own = _behind(self.angle, axis, self.direction)
        inside = (own <= min(AFTER * self.omega, BEHIND)) | (own >= pi - BEFORE)
        off = self.deviation - self.fitted
        # The first and the last stretch may be cut.
        whole = [k for k in _stretches(inside) if k.start > 0 and k.stop < inside.size]
        whole = [k for k in whole if k.stop - k.start >= SEEN]
        if not whole:
            return None
        found, between = np.array([_largest(off[k]) for k in whole]).T
        white = self.noise * sqrt(2.0 * log(max(k.stop - k.start for k in whole)))
        spread = float(np.std(found)) / sqrt(len(found))
        unsure = white + spread + float(between.max())
        return Found(value=float(np.median(found)), uncertainty=unsure)


def _largest(piece: Array) -> tuple[float, float]:
    """The largest deviation, and how much more a parabola through its neighbours may reach."""
    k = int(np.clip(np.abs(piece).argmax(), 1, piece.size - 2))
    return float(np.abs(piece).max()), abs(float(piece[k - 1] - 2.0 * piece[k] + piece[k + 1])) / 8


def _stretches(inside: NDArray[np.bool_]) -> list[slice]:
    """Each stretch of samples that are inside."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
    return [slice(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _behind(angle: Array, axis: int, direction: int) -> Array:
    """Angle travelled since the last reversal of an axis, less than half a turn."""
    return np.asarray(np.mod(direction * (angle - 0.5 * pi * axis), pi))


def fit_circles(trace: CircularTrace) -> list[FittedCircle]:
    """Return the longest stretch at constant feed of each direction, of at least a turn.

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
    fast = 0.5 * float(np.quantile(np.abs(rate[on]), 0.9))
    found, longest = [], (0.0, 0)
    for sign in (1.0, -1.0):
        moving = on & (sign * rate > fast)
        usual = float(np.median(rate[moving])) if moving.any() else 0.0
        steady = moving & (np.abs(rate - usual) <= STEADY * abs(usual))
        part = max(_stretches(steady), key=lambda one: one.stop - one.start, default=slice(0, 1))
        turned = np.abs(angle[part.stop - 1] - angle[part])
        longest = max(longest, (float(turned[0]), part.stop - 1))
        settled = int(np.searchsorted(trace.t[part], trace.t[part.start] + SETTLED))
        if settled < turned.size and turned[settled] >= TURN:
            part = slice(part.start + settled, part.stop)
        if turned[0] >= TURN:
            found.append(_fit(trace, part, centre, radius, angle))
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
    travels = np.ptp(trace.points[on], axis=0) / np.ptp(trace.reference[on], axis=0)
    for name, reference, ratio in zip(names[:2], names[2:4], travels, strict=True):
        if abs(ratio - 1.0) > SAME_TRAVEL:
            raise refuse(
                trace.file,
                "verify-other-travel",
                name=name,
                reference=reference,
                ratio=float(ratio),
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


def _fit(
    trace: CircularTrace, part: slice, centre: Array, radius: float, told: Array
) -> FittedCircle:
    turned = float(told[part][-1] - told[part][0])
    direction = 1 if turned > 0.0 else -1
    whole, is_assumed = max(round(radius / WHOLE), 1) * WHOLE, trace.reference is None
    nominal = whole if is_assumed or abs(radius - whole) <= FILTERED else radius
    feed = nominal * abs(turned) / float(trace.t[part][-1] - trace.t[part][0])
    window = min(AFTER * feed / nominal, BEHIND)
    middle = centre
    for _ in range(4):  # What is left of the centre is seen to first order.
        own = trace.points[part] - middle
        angle, off = np.unwrap(np.arctan2(own[:, 1], own[:, 0])), np.hypot(*own.T) - nominal
        behind = [_behind(angle, axis, direction) for axis in (0, 1)]
        kept = np.all([(b > window) & (b < pi - BEFORE) for b in behind], axis=0)
        waves = [f(k * angle) for k in (1, 2) for f in (np.cos, np.sin)]
        A = np.column_stack([np.ones(angle.size), *waves])
        design = np.zeros((A.shape[1], angle.size))
        design[:, kept] = np.linalg.pinv(A[kept])
        found = design @ off
        middle = middle + found[1:3]
    rest = (off - A @ found)[kept]
    power = float(rest @ rest)
    # Neighbours that are alike tell so much less: as of a first-order process.
    alike = float(np.clip(rest[1:] @ rest[:-1] / max(power, 1e-300), 0.0, 0.999))
    variance = power / max(rest.size - A.shape[1], 1) * (1.0 + alike) / (1.0 - alike)
    return FittedCircle(
        trace=trace,
        radius=nominal,
        is_assumed=is_assumed,
        feed=feed,
        direction=direction,
        centre=middle,
        angle=angle,
        deviation=off,
        fitted=A @ found,
        noise=float(np.std(np.diff(rest))) / sqrt(2.0),
        design=design,
        found=found,
        uncertainty=SIGMAS * np.sqrt(variance * (design**2).sum(axis=1)),
    )
