"""Record of a group and recorded circles -> what holds: each circle beside its prediction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, to_json
from mtcommission.group.contours import Pair, every_circle, trace_circles
from mtcommission.group.judged import PEAK
from mtcommission.group.record import GroupRecord, read_pair
from mtcommission.group.recorded import CircularTrace, FittedCircle, Found, fit_circles
from mtcommission.sheet.document import Block, Bullets, LinePlot
from mtcommission.sheet.plots import FOURTH, OTHER, THIRD, Curve, Signals, line_plot
from mtcommission.verify.checks import Check, Part, Verdict, judge, judge_all, judged, what_of
from mtcommission.verify.report import (
    Entry,
    check_entry,
    set_verification,
    source_table,
    verdict_blocks,
)

Array = NDArray[np.float64]

MODEL = 0.1e-6
"""What a prediction itself may be off [m] (issue: 0.1 µm or 1 %, held to by a second program)."""

MODEL_SHARE = 0.01

FRICTION_SHARE = 0.1
"""By how much a peak may exceed the prediction before that is wrong (empirical: as for moves)."""

APART = 0.5
"""Of the largest angular velocity, by which circles must differ, directions counted, for their
squareness to be told from unequal delays (design choice)."""

LARGEST_SCALE = 100e-6
"""What pitch and temperature make of a length at most [-] (empirical: 11 µm/m and K of steel)."""

RADIUS, FORM, DELAY = "radius", "form", "delay"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircleBeside:
    """A circle and what the record makes of it, in every pair of corners, the nominal first."""

    fitted: FittedCircle
    radius: Array  # deviation of the mean radius, (n_pairs,) [m]
    ellipse: NDArray[np.complex128]  # E, (n_pairs,) [m]
    predicted: Array  # deviation of the radius at each sample, nominal, (n,) [m]
    peaks: tuple[Array, Array]  # what it adds at most, by axis: (n_corners,) [m]; empty without

    @property
    def uncertainty(self) -> Array:
        """Of the fit, with what the tails of the peaks may add to it, shape (5,) [m]."""
        oval = np.real(self.ellipse[0] * np.exp(-2j * self.fitted.angle))
        tails = self.predicted - self.radius[0] - oval
        return np.asarray(self.fitted.uncertainty + np.abs(self.fitted.design @ tails))

    def skew(self, squareness: Found | None) -> Found:
        """Return Im E [m] without what the angle of the axes makes of it, as far as known."""
        value, unsure = float(self.fitted.found[4]), float(self.uncertainty[4])
        if squareness is None:
            return Found(value=value, uncertainty=unsure)
        half = 0.5 * self.fitted.radius
        return Found(
            value=value - half * squareness.value,
            uncertainty=unsure + half * squareness.uncertainty,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CircleVerification:
    """What recorded circles say about a group."""

    record: GroupRecord
    traces: tuple[CircularTrace, ...]
    circles: tuple[CircleBeside, ...]
    squareness: Found | None  # by which the axes' angle is less than a right one [rad]
    checks: tuple[Check, ...]
    warnings: tuple[Message, ...]

    @property
    def verdict(self) -> Verdict:
        """Over all checks."""
        return judge_all(self.checks)

    @property
    def headline(self) -> Message:
        """The verdict in words; it names what cannot be told, unless something does not hold."""
        if self.verdict is not Verdict.UNKNOWN:
            return Message(f"verify-verdict-{self.verdict.value.replace(' ', '-')}")
        unknown = [one for one in self.checks if one.verdict is Verdict.UNKNOWN]
        return Message("verify-verdict-except", what=tuple(dict.fromkeys(map(what_of, unknown))))

    @property
    def sentences(self) -> list[Message]:
        """Each circle, and what was found of the squareness."""
        said = [
            Message("group-recorded-caption", number=number, **_said_of(one))
            for number, one in enumerate(self.circles, start=1)
        ]
        if (square := self.squareness) is None:
            return [*said, Message("group-squareness-unknown")]
        values = {"value": 1e6 * square.value, "uncertainty": 1e6 * square.uncertainty}
        return [*said, Message("group-squareness-found", **values)]


def verify_circles(record: GroupRecord, traces: Sequence[CircularTrace]) -> CircleVerification:
    """Return what recorded circles say about the record of a group.

    Raises
    ------
    InputError
        A trace holds no circle of at least a turn at constant feed.
    """
    pair = read_pair(record)
    fades = max(axis.fades for axis in pair)
    circles = [foresee(pair, one) for trace in traces for one in fit_circles(trace, fades)]
    squareness = find_squareness(circles)
    checks = [
        check
        for number, one in enumerate(circles, start=1)
        for check in (*_check_size(record, number, one, squareness), *_peaks(record, number, one))
    ]
    return CircleVerification(
        record=record,
        traces=tuple(traces),
        circles=tuple(circles),
        squareness=squareness,
        checks=tuple(checks),
        warnings=tuple(dict.fromkeys(_warn(record, traces, circles))),
    )


def foresee(pair: Pair, circle: FittedCircle) -> CircleBeside:
    """Return a circle beside what the record makes of that radius, feed and direction."""
    found = every_circle(pair, np.array([circle.omega]))
    ellipse, own = circle.radius * found.ellipse[:, 0], ((circle.radius, circle.feed),)
    peaks = []
    for axis in pair:
        every = axis.reversals(own, tuple(range(len(axis.tuned.loops))))
        is_known = axis.machine.drive.has_friction
        peaks.append(np.abs(every[0]).max(axis=1) if is_known else np.zeros(0))
    # Clockwise it is the same circle, seen in a mirror.
    (trace,), turned = trace_circles(pair, own), circle.direction * circle.angle
    order = np.argsort(trace.angle)
    predicted = np.interp(turned, trace.angle[order], trace.deviation[order], period=2.0 * pi)
    return CircleBeside(
        fitted=circle,
        radius=circle.radius * found.radius[:, 0],
        ellipse=ellipse if circle.direction > 0 else np.conj(ellipse),
        predicted=predicted,
        peaks=(peaks[0], peaks[1]),
    )


def find_squareness(circles: Sequence[CircleBeside]) -> Found | None:
    """Return by how much the angle of the axes is less than a right one [rad]; None: unknown.

    Unequal delays make an ellipse that turns over with the direction and grows with the feed, axes
    that are not square one that does neither.
    """
    turning = np.array([one.fitted.direction * one.fitted.omega for one in circles])
    if float(np.ptp(turning)) < APART * float(np.abs(turning).max()):
        return None
    half = np.array([0.5 * one.fitted.radius for one in circles])
    excess = np.array([one.fitted.found[4] - one.ellipse[0].imag for one in circles])
    inverse = np.linalg.pinv(np.column_stack([half, -turning * half]))[0]
    unsure = np.abs(inverse) @ np.array([one.uncertainty[4] for one in circles])
    return Found(value=float(inverse @ excess), uncertainty=float(unsure))


def _judge(
    key: str,
    number: int,
    found: Found,
    predicted: Array,
    slack: float,
    *,
    unit: str = "m",
    of: str = "",
) -> Check:
    """A value beside its prediction in every pair of corners."""
    low, high = float(predicted.min()), float(predicted.max())
    least, most = found.value - found.uncertainty, found.value + found.uncertainty
    # Less of an oval or a peak than was promised is no fault.
    verdict = judge(least, most, -inf if key in (FORM, PEAK) else low - slack, high + slack)
    return judged(
        key,
        unit,
        verdict,
        predicted=predicted,
        seen=(found.value, found.uncertainty),
        part=Part.CIRCLE,
        move=number,
        mode=of,
    )


def _check_size(
    record: GroupRecord, number: int, circle: CircleBeside, squareness: Found | None
) -> Iterator[Check]:
    """Radius, oval and delay."""
    fitted, (mean, _, _, gain, _) = circle.fitted, circle.fitted.found
    unsure, skew = circle.uncertainty, circle.skew(squareness)
    slack = max(MODEL, MODEL_SHARE * float(np.abs(circle.radius).max()))
    told = Found(value=float(mean), uncertainty=float(unsure[0]))
    radius = _or_scale(_judge(RADIUS, number, told, circle.radius, slack), fitted.radius)
    if fitted.is_assumed and radius.verdict is not Verdict.HOLDS:
        radius = radius.doubted(Message("group-radius-assumed", radius=fitted.radius))
    yield radius
    size = 2.0 * np.abs(circle.ellipse)
    slack = max(MODEL, MODEL_SHARE * float(size.max()))
    form = Found(
        value=2.0 * float(np.hypot(gain, skew.value)),
        uncertainty=2.0 * float(np.hypot(unsure[3], skew.uncertainty)),
    )
    # E to a difference of delays, of the second axis less the first one.
    per = -2.0 * fitted.direction / fitted.feed
    delay = Found(value=per * skew.value, uncertainty=abs(per) * skew.uncertainty)
    first, second = record.plane
    checks = (
        _judge(FORM, number, form, size, slack),
        _judge(
            DELAY,
            number,
            delay,
            per * circle.ellipse.imag,
            abs(per) * slack,
            unit="s",
            of=f"{second} - {first}",
        ),
    )
    excess = 2.0 * (skew.value - float(circle.ellipse[0].imag)) / fitted.radius
    doubt = Message("group-one-direction", squareness=_told(1e6 * excess))
    for check in checks:
        if squareness is None and check.verdict is not Verdict.HOLDS:
            check = check.doubted(doubt)
        yield _or_scale(check, 2.0 * fitted.radius) if check.key == FORM else check


def _or_scale(check: Check, size: float) -> Check:
    """A size that is off by no more than scales may be cannot be told."""
    off = abs((check.measured or 0.0) - (check.predicted or 0.0))
    if check.verdict is not Verdict.FAILS or off > LARGEST_SCALE * size:
        return check
    return check.doubted(Message("group-may-be-scale", scale=_told(1e6 * off / size)))


def _peaks(record: GroupRecord, number: int, circle: CircleBeside) -> Iterator[Check]:
    """What friction throws the tool off where an axis reverses."""
    for place, (name, peaks) in enumerate(zip(record.plane, circle.peaks, strict=True)):
        if record.axis(name).machine.follows:
            continue
        peak = circle.fitted.peak(place)
        if peak and peaks.size:
            slack = MODEL + FRICTION_SHARE * float(peaks.max())
            yield _judge(PEAK, number, peak, peaks, slack, of=name)
        else:
            yield Check(
                part=Part.CIRCLE,
                key=PEAK,
                move=number,
                mode=name,
                unit="m",
                measured=peak.value if peak else None,
                uncertainty=peak.uncertainty if peak else None,
                reason=Message("group-friction-unknown", name=name)
                if peak
                else Message("group-peak-not-seen"),
            )


def _told(value: float) -> float:
    """With two digits, so that circles alike give one reason."""
    return float(f"{value:.2g}")


def _warn(
    record: GroupRecord, traces: Sequence[CircularTrace], circles: Sequence[CircleBeside]
) -> Iterator[Message]:
    for trace in traces:
        yield from trace.remarks
    for one in (circle.fitted for circle in circles):
        if one.is_assumed:
            yield Message("group-trace-radius", file=one.trace.file, radius=one.radius)
        a, (most, _) = one.feed**2 / one.radius, record.limits.on_circles
        if a > most * (1.0 + MODEL_SHARE):
            yield Message("group-trace-too-fast", file=one.trace.file, got=a, most=most)


# Terminal, page and JSON

MOST_PLOTS = 6
"""Circles that are drawn."""

MOST_LARGE = 4
"""Values in the headline."""

DIRECTIONS = {1: "counterclockwise", -1: "clockwise"}


def _said_of(circle: CircleBeside) -> dict[str, Any]:
    own = circle.fitted
    return {
        "file": own.trace.file,
        "radius": own.radius,
        "feed": own.feed,
        "direction": DIRECTIONS[own.direction],
        "turns": own.turns,
    }


def circles_entry(found: CircleVerification) -> Entry:
    """Return what was found as JSON has it; SI."""
    first, square = found.circles[0].fitted, found.squareness
    return {
        "verdict": found.verdict.value,
        "record": found.record.checksum,
        "traces": [{"file": one.file, "sha256": one.sha256} for one in found.traces],
        "setpoint": {
            "velocity": first.feed,
            "acceleration": first.feed**2 / first.radius,
            "jerk": first.feed**3 / first.radius**2,
            "obeyed": None,
        },
        "circles": [_circle_entry(one, found) for one in found.circles],
        "squareness": square and {"value": square.value, "uncertainty": square.uncertainty},
        "checks": [check_entry(one) for one in found.checks],
        "noise_floor": max(one.fitted.noise for one in found.circles),
        "refined": {},
        "warnings": [to_json(warning) for warning in found.warnings],
    }


def _circle_entry(one: CircleBeside, found: CircleVerification) -> Entry:
    own = one.fitted
    peaks = {name: own.peak(place) for place, name in enumerate(found.record.plane)}
    return {
        **_said_of(one),
        "radius_is_assumed": own.is_assumed,
        "centre": own.centre.tolist(),
        "radius_deviation": float(own.found[0]),
        "gain_ellipse": float(own.found[3]),
        "delay_ellipse": one.skew(found.squareness).value,
        "quadrant_peak": {name: peak.value for name, peak in peaks.items() if peak},
    }


def print_circles(found: CircleVerification, *, created: str, language: str) -> str:
    """Return the page, which works offline."""
    words, axes = Catalogue(language), found.record.axes
    said = tuple(map(words.say, found.sentences))
    order = (Verdict.FAILS, Verdict.UNKNOWN, Verdict.HOLDS)
    known = [one for one in found.checks if one.measured is not None]
    large = sorted(known, key=lambda one: order.index(one.verdict))[:MOST_LARGE]
    plots = enumerate(found.circles[:MOST_PLOTS], start=1)
    parts: dict[str, list[Block]] = {
        "verdict": [
            *verdict_blocks(
                found.checks,
                words,
                headline=found.headline,
                is_met=found.verdict is Verdict.HOLDS,
                warnings=found.warnings,
                detail=said[0],
                large=large,
            ),
            Bullets(items=said),
        ],
        "overlay": [_plot(number, one, found, words) for number, one in plots],
        "sources": [
            source_table(
                found.traces,
                lambda one: ", ".join(f"{name} = {own}" for own, name in one.columns.items()),
                words,
            )
        ],
    }
    return set_verification(
        parts,
        words,
        machine=axes[0].machine.name,
        axes=[axis.name for axis in axes],
        profiles=[axis.profile for axis in axes],
        created=created,
    )


def _plot(number: int, one: CircleBeside, found: CircleVerification, words: Catalogue) -> LinePlot:
    """Deviation of the radius over the angle, measured, fitted and predicted, of the first turn."""
    own, tolerance = one.fitted, found.record.tolerance
    within = np.flatnonzero(np.abs(own.angle - own.angle[0]) <= 2.0 * pi)
    degrees = np.mod(own.angle[within], 2.0 * pi) * 180.0 / pi
    within, degrees = within[np.argsort(degrees)], np.sort(degrees)
    curves = [
        Curve(words.text(f"group-line-{name}"), degrees, curve[within], style)
        for name, curve, style in (
            ("measured", own.deviation, FOURTH),
            ("fitted", own.fitted, OTHER),
            ("predicted", one.predicted, THIRD),
        )
    ]
    limits = (tolerance, -tolerance)
    name, band = words.text("group-plot-deviation"), words.text("verify-line-band")
    return line_plot(
        words,
        f"circle-{number}",
        [Signals(name, "m", curves, limits, band)],
        x=(words.text("group-plot-angle"), ""),
        text="group-recorded",
        link="circles",
        number=number,
        **_said_of(one),
    )
