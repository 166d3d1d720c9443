"""What recorded circles say, for terminal, page and JSON."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, to_json
from mtcommission.group.verify import CircleBeside, CircleVerification
from mtcommission.sheet.document import Block, Bullets, LinePlot
from mtcommission.sheet.plots import FOURTH, OTHER, THIRD, Curve, Signals, line_plot
from mtcommission.verify.checks import Verdict
from mtcommission.verify.page import set_verification, source_table, verdict_blocks
from mtcommission.verify.report import Entry, check_entry

MOST_PLOTS = 6
"""Circles that are drawn."""

MOST_LARGE = 4
"""Values in the headline."""

DIRECTIONS = {1: "counterclockwise", -1: "clockwise"}


def say_found(found: CircleVerification) -> list[Message]:
    """Return each circle, and what was found of the squareness."""
    said = [
        Message("group-recorded-caption", number=number, **_told(one))
        for number, one in enumerate(found.circles, start=1)
    ]
    if (square := found.squareness) is None:
        return [*said, Message("group-squareness-unknown")]
    values = {"value": 1e6 * square.value, "uncertainty": 1e6 * square.uncertainty}
    return [*said, Message("group-squareness-found", **values)]


def _told(circle: CircleBeside) -> dict[str, Any]:
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
        **_told(one),
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
    said = tuple(map(words.say, say_found(found)))
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
        alt="verify-plot",
        link="circles",
        number=number,
        verdict=found.headline,
        **_told(one),
    )
