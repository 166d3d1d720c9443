"""Axes that move together, as the terminal shows them."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.terminal import Line, heading, heads, table, warn
from mtcommission.cli.verified_view import STYLES, describe_table
from mtcommission.group.record import GroupRecord
from mtcommission.group.sheet import corners_table, feeds_table
from mtcommission.group.verify import CircleVerification, say_found
from mtcommission.machine.checks import say_filter
from mtcommission.sheet.tables import show
from mtcommission.verify.report import check_row, say_reasons


def describe_group(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    """Return verdict, limits, circles and corners."""
    text, path = spoken.text, record.path
    names = ", ".join(axis.name for axis in record.axes)
    kind, style = ("verdict-met", "green") if record.assessment.met else ("verdict-not-met", "red")
    has_jerk = record.axes[0].loop.jerk != "none"
    missing = "group-path-none" if has_jerk else "no-jerk-limit"
    limits = ", ".join(
        (
            show(path.acceleration, spoken, "m/s^2", "group-path-none"),
            show(path.jerk, spoken, "m/s^3", missing),
        )
    )
    told = record.corner_rule
    return [
        heading(text("group-axes", name=record.axes[0].machine.name, axes=names)),
        (text(kind), f"bold {style}"),
        *_missed(record, spoken),
        *_axes(record, spoken),
        f"{text('group-filter')}: {say_filter(record.filter, spoken)}; "
        f"{text('group-path')}: {limits}",
        text("group-tolerance", tolerance=record.tolerance, feed=record.feed),
        *_circles(record, spoken),
        *describe_table(feeds_table(record, spoken)),
        *describe_table(corners_table(record, spoken)),
        text("group-corner-told", kind=told.kind, name=told.name, value=told.value)
        if told.value and told.name
        else text("group-corner-no-arc" if told.kind == "arc" else "group-corner-no-value"),
        *warn(spoken, record.warnings),
    ]


def describe_circles(found: CircleVerification, spoken: Catalogue) -> list[Line]:
    """Return the verdict on recorded circles, what was measured, and what was found."""
    record, say = found.record, spoken.text
    names = ", ".join(axis.name for axis in record.axes)
    heads_ = [say(f"verify-head-{name}") for name in ("what", "predicted", "measured")]
    rows = []
    for check in found.checks:
        what, predicted, _, measured, verdict = check_row(check, spoken)
        rows.append((what, predicted, measured, verdict))
    return [
        heading(say("group-axes", name=record.axes[0].machine.name, axes=names)),
        (spoken.say(found.headline), f"bold {STYLES[found.verdict]}"),
        *warn(spoken, found.warnings),
        "",
        *table([*heads_, ""], rows, [STYLES[one.verdict] for one in found.checks]),
        "",
        *say_reasons(found.checks, spoken),
        *map(spoken.say, say_found(found)),
    ]


def _missed(record: GroupRecord, spoken: Catalogue) -> Iterator[Line]:
    for check in record.assessment.checks:
        if not check.met:
            found = show(check.value, spoken, check.unit, "not-settled")
            limit = show(check.limit, spoken, check.unit)
            yield f"{spoken.say(check.label)}: {found} > {limit}", "red"


def _axes(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    names = heads(
        spoken, "group-axis", "acceleration", "jerk", "group-wait", "group-delay", "settling"
    )
    rows, text = [], spoken.text
    for axis in record.axes:
        best = axis.limits.recommended
        rows.append(
            [
                axis.name,
                show(best.acceleration, spoken, "m/s^2"),
                text("no-jerk-limit")
                if axis.loop.jerk == "none"
                else show(best.jerk, spoken, "m/s^3"),
                show(axis.wait, spoken, "s"),
                show(record.feedforward[axis.name].delay, spoken, "s"),
                show(axis.settling_time, spoken, "s", "not-settled"),
            ]
        )
    return table(names, rows)


def _circles(record: GroupRecord, spoken: Catalogue) -> list[Line]:
    text, form = spoken.text, spoken.format
    first = record.circle[0]
    peaks = list(first.quadrant_peak)
    names = [
        text("group-circle-of", radius=first.radius),
        text("group-radius-deviation"),
        text("group-form-deviation"),
        *(text("group-peak", name=axis) for axis in peaks),
    ]
    rows = [
        [
            form.feed(one.feed),
            show(one.radius_deviation, spoken, "m"),
            show(one.form_deviation, spoken, "m"),
            *(show(one.quadrant_peak[axis], spoken, "m") for axis in peaks),
        ]
        for one in record.circle
    ]
    return table(names, rows)
