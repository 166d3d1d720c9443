"""Axes that move together, as the terminal shows them."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from decimal import ROUND_CEILING
from pathlib import Path

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.cli.terminal import Line, describe_table, heading, warn
from mtcommission.controls.row import round_number
from mtcommission.group.judged import PEAK
from mtcommission.group.record import AxisEntry, GroupRecord
from mtcommission.group.sheet import (
    corners_table,
    feeds_table,
    headline,
    in_micrometres,
    say_corners,
    say_peaks,
)
from mtcommission.sheet.tables import Quantity, member, show, table


def describe_group(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    """Return verdict, limits, circles and corners."""
    text, head = spoken.text, headline(record, spoken)
    names = ", ".join(axis.name for axis in record.axes)
    return [
        heading(text("group-axes", name=record.axes[0].machine.name, axes=names)),
        (head.verdict, f"bold {'green' if head.is_met else 'red'}"),
        *_missed(record, spoken),
        *_axes(record, spoken),
        "; ".join(f"{one.label}: {one.value}" for one in head.values),
        text("group-tolerance", tolerance=record.tolerance, feed=record.feed),
        *_circles(record, spoken),
        *describe_table(feeds_table(record, spoken)),
        *filter(None, [say_peaks(record, spoken)]),
        *describe_table(corners_table(record, spoken)),
        say_corners(record, spoken),
        *warn(spoken, record.warnings),
    ]


def say_next(record: GroupRecord, profiles: Sequence[Path], spoken: Catalogue) -> str:
    """Return the step that helps where a requirement is not met, the first that is in the way."""
    for axis, profile in zip(record.axes, profiles, strict=True):
        if not axis.assessment.met:
            return spoken.text("group-next-axis", name=axis.name, profile=shlex.quote(str(profile)))
    missed = [check for check in record.assessment.checks if not check.met]
    contours = [check for check in missed if check.name in ("circle", "line")]
    peaks = [check for check in missed if check.name.startswith(PEAK)]
    if not (contours or peaks):
        return spoken.text("group-next-path")
    # With which what was found keeps its reserve, in micrometres of two digits.
    enough = max((check.value or 0.0) / check.reserve for check in (*contours, *peaks))
    tolerance = f"{round_number(1e6 * enough, ROUND_CEILING, digits=2):f}um"
    if contours:
        return spoken.text("group-next-contour", tolerance=tolerance)
    names = tuple(check.name.removeprefix(PEAK).strip() for check in peaks)
    return spoken.text("group-next-peak", names=names, tolerance=tolerance)


def _missed(record: GroupRecord, spoken: Catalogue) -> Iterator[Line]:
    for check in record.assessment.checks:
        if not check.met:
            found = show(check.value, spoken, check.unit, "not-settled")
            limit = show(check.limit, spoken, check.unit)
            yield f"{spoken.say(check.label)}: {found} > {limit}", "red"


def _axes(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    def jerk(axis: AxisEntry) -> float | None:
        return None if axis.loop.jerk == "none" else axis.limits.recommended.jerk

    def delay(axis: AxisEntry) -> float:
        return record.feedforward[axis.name].delay

    columns = (
        Quantity("axis-row", "name"),
        Quantity("acceleration", "limits.recommended.acceleration", "m/s^2"),
        Quantity("jerk", jerk, "m/s^3", "no-jerk-limit"),
        Quantity("group-wait", "wait", "s"),
        Quantity("group-delay", delay, "s"),
        Quantity("terminal-head-settling-time", "settling_time", "s", "not-settled"),
    )
    return describe_table(table(spoken, "axis-row", columns, record.axes))


def _circles(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    first = record.circle[0]
    columns = (
        Quantity(
            Message("group-circle-of", radius=first.radius),
            lambda one: spoken.format.feed(one.feed),
        ),
        in_micrometres("group-radius-deviation", "radius_deviation", spoken),
        in_micrometres("group-form-deviation", "form_deviation", spoken),
        *(
            in_micrometres(Message("group-peak", name=name), member(name, "quadrant_peak"), spoken)
            for name in first.quadrant_peak
        ),
    )
    return describe_table(table(spoken, "axis-row", columns, record.circle))
