"""Record of a group and recorded circles -> what holds: each circle beside its prediction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.circle import reversal_course
from mtcommission.group.fit import FittedCircle, Found, fit_circles
from mtcommission.group.held import HeldAxis, find_deviations, find_ellipses, read_plane
from mtcommission.group.record import GroupRecord
from mtcommission.group.traces import CircularTrace
from mtcommission.messages.message import Message
from mtcommission.verify.checks import KEPT, Check, Verdict, judge, judge_all

Array = NDArray[np.float64]

MODEL = 0.1e-6
"""What a prediction itself may be off [m] (issue: 0.1 µm or 1 %, held to by a second program)."""

MODEL_SHARE = 0.01

FRICTION_SHARE = 0.1
"""By how much a peak may exceed the prediction before that is wrong (empirical: as for moves)."""

APART = 0.5
"""Of the largest angular velocity, by which circles must differ, directions counted, for their
squareness to be told from unequal delays (design choice)."""

FASTER = 2.0
"""Of the slowest circle, how fast another must be for scales to be told from loops: what these do
has then grown to four times (design choice)."""

LARGEST_SCALE = 100e-6
"""What pitch and temperature make of a length at most [-] (empirical: 11 µm/m and K of steel)."""

RADIUS, FORM, DELAY, GAIN, PEAK = "radius", "form", "delay", "gain", "quadrant peak"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Foreseen:
    """What the record makes of a circle, in every pair of corners, the nominal one first."""

    radius: Array  # deviation of the mean radius, (n_pairs,) [m]
    ellipse: NDArray[np.complex128]  # E, (n_pairs,) [m]
    course: tuple[Array, Array]  # what friction adds to each sample, nominal, by axis [m]
    peak: tuple[Array, Array]  # what it adds at most, by axis: (n_corners,) [m]; empty without


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircleBeside:
    """A circle beside its prediction."""

    fitted: FittedCircle
    foreseen: Foreseen
    bias: Array  # what the tails of the peaks add to the fit, shape (5,) [m]
    mean: Found  # mean radius less the nominal one, without what scales make of it [m]
    gain: Found  # Re E, likewise [m]
    skew: Found  # Im E without what the squareness makes of it [m]

    @property
    def predicted(self) -> Array:
        """Deviation of the radius at each sample, nominal [m]."""
        angle, own = self.fitted.angle, self.foreseen
        oval = np.real(own.ellipse[0] * np.exp(-2j * angle))
        return np.asarray(own.radius[0] + oval + sum(own.course))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircleVerification:
    """What recorded circles say about a group."""

    record: GroupRecord
    traces: tuple[CircularTrace, ...]
    circles: tuple[CircleBeside, ...]
    squareness: Found | None  # by which the axes' angle is less than a right one [rad]
    scales: tuple[Found, Found] | None
    """By which the axes measure too long in the mean, and half of what the first one does so more
    than the second [-]."""
    checks: tuple[Check, ...]  # ``move`` is the number of the circle, from 1
    verdict: Verdict
    warnings: tuple[Message, ...]


def verify_circles(record: GroupRecord, traces: Sequence[CircularTrace]) -> CircleVerification:
    """Return what recorded circles say about the record of a group.

    Raises
    ------
    InputError
        A trace holds no circle of at least a turn at constant feed.
    """
    axes = read_plane(record)
    fitted = [one for trace in traces for one in fit_circles(trace)]
    beside = [_lay_beside(one, foresee(axes, one)) for one in fitted]
    squareness = find_squareness(beside)
    scales = find_scales(beside)
    beside = [_without(one, squareness, scales) for one in beside]
    checks = tuple(
        check
        for number, one in enumerate(beside, start=1)
        for check in _check(
            record, number, one, is_square=squareness is not None, is_scaled=scales is not None
        )
    )
    return CircleVerification(
        record=record,
        traces=tuple(traces),
        circles=tuple(beside),
        squareness=squareness,
        scales=scales,
        checks=checks,
        verdict=judge_all(checks),
        warnings=tuple(dict.fromkeys(_warn(record, traces, fitted))),
    )


def foresee(axes: tuple[HeldAxis, HeldAxis], circle: FittedCircle) -> Foreseen:
    """Return what the record makes of a circle of that radius, feed and direction."""
    omega = np.array([circle.omega])
    ellipse = find_ellipses(axes, omega)[:, 0] * circle.radius
    courses, peaks = [], []
    for place, axis in enumerate(axes):
        if not axis.machine.drive.has_friction:
            courses.append(np.zeros(circle.angle.size))
            peaks.append(np.zeros(0))
            continue
        every = [
            reversal_course(
                loop,
                axis.machine.drive,
                item=axis.setpoint_filter,
                radius=circle.radius,
                feed=circle.feed,
            )
            for loop in axis.tuned.loops
        ]
        peaks.append(np.array([np.abs(one).max() for one in every]))
        step = axis.tuned.controller.velocity_cycle
        t, own = circle.since(place), circle.angle - 0.5 * np.pi * place
        course = np.interp(t, step * np.arange(every[0].size), every[0], right=0.0)
        courses.append(course * np.abs(np.cos(own)))
    return Foreseen(
        radius=find_deviations(axes, omega).radius[:, 0] * circle.radius,
        ellipse=ellipse if circle.direction > 0 else np.conj(ellipse),
        course=(courses[0], courses[1]),
        peak=(peaks[0], peaks[1]),
    )


def _lay_beside(fitted: FittedCircle, foreseen: Foreseen) -> CircleBeside:
    bias = np.abs(fitted.design @ np.asarray(sum(foreseen.course)))
    return CircleBeside(
        fitted=fitted,
        foreseen=foreseen,
        bias=bias,
        mean=_unsure(fitted.mean, bias[0]),
        gain=_unsure(fitted.gain, bias[3]),
        skew=_unsure(fitted.skew, bias[4]),
    )


def _unsure(found: Found, more: float) -> Found:
    return Found(value=found.value, uncertainty=found.uncertainty + float(more))


def _less(found: Found, part: Found | None, times: float) -> Found:
    """A value without so many times another one; None: nothing is known of that."""
    if part is None:
        return found
    return Found(
        value=found.value - times * part.value,
        uncertainty=found.uncertainty + times * part.uncertainty,
    )


def find_squareness(circles: Sequence[CircleBeside]) -> Found | None:
    """Return by how much the angle of the axes is less than a right one [rad]; None: unknown.

    Unequal delays make an ellipse that turns over with the direction and grows with the feed, axes
    that are not square one that does neither.
    """
    turning = np.array([one.fitted.direction * one.fitted.omega for one in circles])
    if float(np.ptp(turning)) < APART * float(np.abs(turning).max()):
        return None
    radii = np.array([one.fitted.radius for one in circles])
    excess = np.array([one.fitted.skew.value - one.foreseen.ellipse[0].imag for one in circles])
    unsure = np.array([one.fitted.skew.uncertainty + one.bias[4] for one in circles])
    weights = 1.0 / np.maximum(unsure, 1e-12)
    A = 0.5 * np.column_stack([radii, -turning * radii]) * weights[:, None]
    inverse = np.linalg.pinv(A)
    value = float((inverse @ (excess * weights))[0])
    return Found(value=value, uncertainty=float(np.abs(inverse[0]).sum()))


def find_scales(circles: Sequence[CircleBeside]) -> tuple[Found, Found] | None:
    """Return by how much the axes measure too long, mean and half the difference; None: unknown.

    The slowest circle tells: what loops and filter do to a circle grows with the square of the
    feed, what pitch and temperature do not at all.
    """
    slow = min(circles, key=lambda one: one.fitted.omega)
    if max(one.fitted.omega for one in circles) < FASTER * slow.fitted.omega:
        return None
    radius, own = slow.fitted.radius, slow.foreseen
    pairs = ((slow.mean, own.radius[0]), (slow.gain, own.ellipse[0].real))
    mean, apart = (
        Found(value=(one.value - float(told)) / radius, uncertainty=one.uncertainty / radius)
        for one, told in pairs
    )
    return mean, apart


def _without(
    circle: CircleBeside, squareness: Found | None, scales: tuple[Found, Found] | None
) -> CircleBeside:
    """The circle without what scales and the angle of the axes make of it."""
    mean, apart = scales or (None, None)
    radius = circle.fitted.radius
    return replace(
        circle,
        mean=_less(circle.mean, mean, radius),
        gain=_less(circle.gain, apart, radius),
        skew=_less(circle.skew, squareness, 0.5 * radius),
    )


def _check(
    record: GroupRecord, number: int, circle: CircleBeside, *, is_square: bool, is_scaled: bool
) -> Iterator[Check]:
    """Every promise about a circle."""
    fitted, foreseen = circle.fitted, circle.foreseen
    slack = max(MODEL, MODEL_SHARE * float(np.abs(foreseen.radius).max()))

    def check(
        key: str, found: Found, predicted: Array, unit: str, slack: float, *, of: str = ""
    ) -> Check:
        low, high = float(predicted.min()), float(predicted.max())
        least, most = found.value - found.uncertainty, found.value + found.uncertainty
        # Less of an oval or a peak than was promised is no fault.
        bound = -inf if key in (FORM, PEAK) else low - slack
        verdict = judge(least, most, bound, high + slack)
        return Check(
            key=key,
            move=number,
            mode=of,
            unit=unit,
            predicted=float(predicted[0]),
            low=low,
            high=high,
            measured=found.value,
            uncertainty=found.uncertainty,
            verdict=verdict,
            reason=KEPT[verdict],
            decides=True,
        )

    def times(found: Found, scale: float) -> Found:
        return Found(value=scale * found.value, uncertainty=abs(scale) * found.uncertainty)

    def or_scale(check: Check, size: float) -> Check:
        off = abs((check.measured or 0.0) - (check.predicted or 0.0))
        if is_scaled or check.verdict is not Verdict.FAILS or off > LARGEST_SCALE * size:
            return check
        return check.doubted(Message("group-one-feed", scale=_told(1e6 * off / size)))

    radius = check(RADIUS, circle.mean, foreseen.radius, "m", slack)
    radius = or_scale(radius, fitted.radius)
    if fitted.is_assumed and radius.verdict is not Verdict.HOLDS:
        radius = radius.doubted(Message("group-radius-assumed", radius=fitted.radius))
    yield radius
    gain, skew = circle.gain, circle.skew
    form = Found(
        value=2.0 * float(np.hypot(gain.value, skew.value)),
        uncertainty=2.0 * float(np.hypot(gain.uncertainty, skew.uncertainty)),
    )
    size = 2.0 * np.abs(foreseen.ellipse)
    oval = max(MODEL, MODEL_SHARE * float(size.max()))
    # E to a difference of delays, of the second axis less the first one.
    per = -2.0 * fitted.direction / fitted.feed
    delay = times(skew, per)
    forms = check(FORM, form, size, "m", oval)
    first, second = record.plane
    foreseen_delay = per * foreseen.ellipse.imag
    later = f"{second} - {first}"
    delays = check(DELAY, delay, foreseen_delay, "s", abs(per) * oval, of=later)
    if not is_square:
        value = 2.0 * (skew.value - foreseen.ellipse[0].imag) / fitted.radius
        doubt = Message("group-one-direction", squareness=_told(1e6 * value))
        forms, delays = (
            one if one.verdict is Verdict.HOLDS else one.doubted(doubt) for one in (forms, delays)
        )
    larger = f"{first} - {second}"
    sizes = check(GAIN, times(gain, 2.0), 2.0 * foreseen.ellipse.real, "m", 2.0 * oval, of=larger)
    sizes = or_scale(sizes, 2.0 * fitted.radius)
    if sizes.verdict is Verdict.UNKNOWN and forms.verdict is Verdict.FAILS:
        forms = forms.doubted(sizes.reason)
    yield from (forms, delays, sizes)
    for place, (name, peaks) in enumerate(zip(record.plane, foreseen.peak, strict=True)):
        peak = fitted.peak(place)
        if record.axis(name).machine.follows:
            continue
        if peak is None:
            yield _unknown(number, name, Message("group-peak-not-seen"))
        elif not peaks.size:
            told = _unknown(number, name, Message("group-friction-unknown", name=name))
            yield replace(told, measured=peak.value, uncertainty=peak.uncertainty)
        else:
            more = MODEL + FRICTION_SHARE * float(peaks.max())
            yield check(PEAK, peak, peaks, "m", more, of=name)


def _told(value: float) -> float:
    """With two digits, so that circles alike give one reason."""
    return float(f"{value:.2g}")


def _unknown(number: int, name: str, reason: Message) -> Check:
    return Check(key=PEAK, move=number, mode=name, unit="m", reason=reason)


def _warn(
    record: GroupRecord, traces: Sequence[CircularTrace], circles: Sequence[FittedCircle]
) -> Iterator[Message]:
    for trace in traces:
        yield from trace.remarks
    for one in circles:
        if one.is_assumed:
            yield Message("group-trace-radius", file=one.trace.file, radius=one.radius)
        a, most = one.feed**2 / one.radius, record.path.acceleration
        if a > most * (1.0 + MODEL_SHARE):
            yield Message("group-trace-too-fast", file=one.trace.file, got=a, most=most)
