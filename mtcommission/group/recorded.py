"""A recorded circle -> centre, radius, ellipse and the peaks where its axes reverse.

Recorded are two axes' positions, or a ballbar's radius over its angle. Where an axis reverses,
friction throws the tool off for a while; there the ellipse is not fitted:

    r(θ) = R + a cos θ + b sin θ + Re E cos 2θ + Im E sin 2θ

a and b are what is left of the centre. Unequal gains make Re E = R (g_x - g_y)/2, unequal delays
Im E = ± v (d_x - d_y)/2, the sign that of the direction, axes that are off a right angle by s
Im E = R s/2 in either.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.measured.columns import read_signal_unit
from mtcommission.measured.formats.recognise import read_contents, read_measured
from mtcommission.measured.formats.table import find_columns
from mtcommission.measured.measurement import Column, Lines, Signal, TimeContents, refuse
from mtcommission.measured.regression import correlation_length
from mtcommission.measured.signals import read_clock
from mtcommission.verify.setpoint import runs

Array = NDArray[np.float64]

ANGLE, RADIUS = "angle", "radius"
"""Columns of a ballbar."""

IN_GERMAN = {"winkel": ANGLE}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircularTrace:
    """A recorded file."""

    file: str  # name as it was given
    sha256: str  # of its bytes
    columns: Mapping[str, str]  # what the file calls those that were used, by our names
    t: Array  # rising, shape (n,) [s]
    points: Array  # actual positions, shape (n, 2) [m]
    reference: Array | None  # the same of the setpoint; None: not recorded
    lines: Lines  # of each sample in the file, shape (n,) or empty
    remarks: tuple[Message, ...]

    def line(self, sample: int) -> int:
        """Return the line of a sample; 0 where the file has none."""
        return int(self.lines[sample]) if self.lines.size else 0


def read_circular(name: str, said: Mapping[str, str], plane: Sequence[str]) -> CircularTrace:
    """Return what a file holds of two axes, given their names; ``said``: ``--columns``.

    Raises
    ------
    InputError
        It has no clock, no circle's columns, or units of something else.
    """
    data = read_measured(name)
    contents = read_contents(data, said, where=name)
    first, second = (axis.casefold() for axis in plane)
    actual, reference, polar = (first, second), (f"{first}_ref", f"{second}_ref"), (ANGLE, RADIUS)
    items = [item for item in contents.items if isinstance(item, TimeContents) and item.columns]
    if not items:
        raise refuse(name, "verify-no-time-record")
    found = _find(items[0].columns, said, (*actual, *reference, *polar), where=name)
    whole = [pair for pair in (actual, reference, polar) if found.keys() >= set(pair)]
    if actual not in whole and polar not in whole:
        there = tuple(column.name for column in items[0].columns)
        raise refuse(name, "group-trace-columns", found=there, first=first, second=second)
    columns = {own: found[own] for pair in whole for own in pair}
    remarks = [*contents.remarks]
    values = {}
    for own, column in columns.items():
        values[own] = _scale(column, is_angle=own == ANGLE, where=name) * column.values
        if not column.unit:
            remarks.append(Message("verify-si-assumed", name=column.name))
    if actual not in whole:
        values[first] = values[RADIUS] * np.cos(values[ANGLE])
        values[second] = values[RADIUS] * np.sin(values[ANGLE])
    told = np.column_stack([values[own] for own in reference]) if reference in whole else None
    clock = read_clock(items[0], said, where=name)
    return CircularTrace(
        file=name,
        sha256=sha256(data).hexdigest(),
        columns={own: column.name for own, column in columns.items()},
        t=clock.times,
        points=np.column_stack([values[own] for own in actual]),
        reference=told,
        lines=clock.lines,
        remarks=tuple(dict.fromkeys(remarks)),
    )


def _find(
    columns: Sequence[Column], said: Mapping[str, str], known: Sequence[str], *, where: str
) -> dict[str, Column]:
    """The column of each of our names, with its unit; ``--columns`` comes first."""
    chosen = find_columns([column.name for column in columns], said, known)
    taken = {own for own, _ in chosen.values()}
    found: dict[str, Column] = {}
    for place, column in enumerate(columns):
        plain = column.name.casefold().replace(" ", "_")
        plain = IN_GERMAN.get(plain, plain)
        own, unit = chosen.get(place, ("" if plain in taken else plain, None))
        if own in found:
            names = (found[own].name, column.name)
            raise refuse(where, "verify-two-columns", role=own, names=names)
        if own in known:
            found[own] = replace(column, unit=unit or column.unit)
    return found


def _scale(column: Column, *, is_angle: bool, where: str) -> float:
    """SI value of one unit of the file."""
    if not column.unit and is_angle:
        raise refuse(where, "group-trace-angle-unit", name=column.name)
    if not column.unit:
        return 1.0
    measured = read_signal_unit(column.unit)
    if measured and measured.signal is Signal.POSITION and measured.rotary is is_angle:
        return measured.scale
    kind = "group-trace-no-angle" if is_angle else "group-trace-no-length"
    raise refuse(where, kind, name=column.name, unit=column.unit)


# What it shows


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """What counts as a circle, as a turn and as a peak (design choices)."""

    near: float = 0.02  # share of the radius within which a sample belongs to the circle
    same_travel: float = 0.1  # by which an axis may travel otherwise than told; else a wrong unit
    steady: float = 0.05  # share of the feed within which it is constant
    smoothed: float = 2.5 * pi / 180.0  # angle to either side over which the feed is seen
    settled: float = 0.2  # left out where a constant feed begins, if a turn remains [s]
    turn: float = 2.0 * pi * (1.0 - 1e-3)  # what counts as a whole one
    before: float = 2.0 * pi / 180.0  # angle before a reversal that belongs to its peak
    behind: float = 40.0 * pi / 180.0  # the same behind it, at most
    seen: int = 5  # samples about a reversal without which its peak is not told
    sigmas: float = 2.0  # standard deviations of an uncertainty
    whole: float = 1e-3  # of what a radius is a multiple where no setpoint was recorded [m]
    filtered: float = 20e-6  # by which a recorded setpoint may be smaller, behind its filter [m]
    largest: float = 2.0  # radius of a circle test; others are a wrong unit [m]
    smallest: float = 0.5e-3


SETTINGS = Settings()


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
    window: float  # angle behind a reversal within which it throws the tool off [rad]
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

    def peak(self, axis: int) -> Found | None:
        """Return how far reversals of an axis throw the tool off [m]; None: none was seen.

        Of several the middle one; unsure by their spread, by the largest of so many samples' noise,
        and by what lies between two of these.
        """
        own = _behind(self.angle, axis, self.direction)
        inside = (own <= self.window) | (own >= pi - SETTINGS.before)
        off = self.deviation - self.fitted
        # The first and the last stretch may be cut.
        whole = [slice(*ends) for ends in runs(inside) if ends[0] > 0 and ends[1] < inside.size]
        whole = [k for k in whole if k.stop - k.start >= SETTINGS.seen]
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


def _behind(angle: Array, axis: int, direction: int) -> Array:
    """Angle travelled since the last reversal of an axis, less than half a turn."""
    return np.asarray(np.mod(direction * (angle - 0.5 * pi * axis), pi))


def fit_circles(trace: CircularTrace, fades: float) -> list[FittedCircle]:
    """Return the longest stretch at constant feed of each direction, of at least a turn.

    ``fades``: how long a reversal throws the tool off [s].

    Raises
    ------
    InputError
        There is none, or no circle at all.
    """
    told = trace.points if trace.reference is None else trace.reference
    centre, radius = _find_circle(told)
    if not SETTINGS.smallest <= radius <= SETTINGS.largest:
        raise refuse(trace.file, "group-trace-size", radius=radius)
    off = np.abs(np.hypot(*(told - centre).T) - radius)
    on = off <= SETTINGS.near * radius
    if on.mean() < 0.5:
        worst = int(off.argmax())
        message = Message("group-trace-no-circle", off=float(off[worst]))
        raise InputError.at(trace.file, message, line=trace.line(worst))
    angle = np.unwrap(np.arctan2(*(told - centre).T[::-1]))
    rate = _rate(trace.t, angle)
    _require_same_travel(trace, on)
    fast = 0.5 * float(np.quantile(np.abs(rate[on]), 0.9))
    found, longest = [], (0.0, 0)
    for sign in (1.0, -1.0):
        moving = on & (sign * rate > fast)
        usual = float(np.median(rate[moving])) if moving.any() else 0.0
        steady = moving & (np.abs(rate - usual) <= SETTINGS.steady * abs(usual))
        part = slice(*max(runs(steady), key=lambda ends: ends[1] - ends[0], default=(0, 1)))
        turned = np.abs(angle[part.stop - 1] - angle[part])
        longest = max(longest, (float(turned[0]), part.stop - 1))
        settled = int(np.searchsorted(trace.t[part], trace.t[part.start] + SETTINGS.settled))
        if settled < turned.size and turned[settled] >= SETTINGS.turn:
            part = slice(part.start + settled, part.stop)
        if turned[0] >= SETTINGS.turn:
            found.append(_fit(trace, part, centre, radius, angle, fades))
    if not found:
        got, last = longest
        message = Message("group-trace-arc", got=round(got * 180.0 / pi))
        raise InputError.at(trace.file, message, line=trace.line(last))
    return found


def _require_same_travel(trace: CircularTrace, on: NDArray[np.bool_]) -> None:
    """Raise InputError where actual positions travel otherwise than the setpoint."""
    if trace.reference is None:
        return
    names = list(trace.columns.values())
    travels = np.ptp(trace.points[on], axis=0) / np.ptp(trace.reference[on], axis=0)
    for name, reference, ratio in zip(names[:2], names[2:4], travels, strict=True):
        if abs(ratio - 1.0) > SETTINGS.same_travel:
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
        near = np.abs(distance - radius) <= SETTINGS.near * radius
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
    width = int(np.clip(round(SETTINGS.smoothed / max(step, 1e-9)), 1, max(angle.size // 8, 1)))
    n = np.arange(angle.size)
    before, behind = np.maximum(n - width, 0), np.minimum(n + width, angle.size - 1)
    return np.asarray((angle[behind] - angle[before]) / (t[behind] - t[before]))


def _fit(
    trace: CircularTrace, part: slice, centre: Array, radius: float, told: Array, fades: float
) -> FittedCircle:
    turned = float(told[part][-1] - told[part][0])
    direction = 1 if turned > 0.0 else -1
    is_assumed = trace.reference is None
    whole = max(round(radius / SETTINGS.whole), 1) * SETTINGS.whole
    nominal = whole if is_assumed or abs(radius - whole) <= SETTINGS.filtered else radius
    feed = nominal * abs(turned) / float(trace.t[part][-1] - trace.t[part][0])
    window = min(fades * feed / nominal, SETTINGS.behind)
    middle = centre
    for _ in range(4):  # What is left of the centre is seen to first order.
        own = trace.points[part] - middle
        angle, off = np.unwrap(np.arctan2(own[:, 1], own[:, 0])), np.hypot(*own.T) - nominal
        behind = [_behind(angle, axis, direction) for axis in (0, 1)]
        kept = np.all([(b > window) & (b < pi - SETTINGS.before) for b in behind], axis=0)
        waves = [f(k * angle) for k in (1, 2) for f in (np.cos, np.sin)]
        A = np.column_stack([np.ones(angle.size), *waves])
        design = np.zeros((A.shape[1], angle.size))
        design[:, kept] = np.linalg.pinv(A[kept])
        found = design @ off
        middle = middle + found[1:3]
    rest = (off - A @ found)[kept]
    variance = correlation_length(rest) * float(rest @ rest) / max(rest.size - A.shape[1], 1)
    return FittedCircle(
        trace=trace,
        radius=nominal,
        is_assumed=is_assumed,
        feed=feed,
        direction=direction,
        window=window,
        centre=middle,
        angle=angle,
        deviation=off,
        fitted=A @ found,
        noise=float(np.std(np.diff(rest))) / sqrt(2.0),
        design=design,
        found=found,
        uncertainty=SETTINGS.sigmas * np.sqrt(variance * (design**2).sum(axis=1)),
    )
