"""The sheet of axes that move together: what to enter, circles and corners, what to measure."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import isclose
from typing import Any

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import pretty_unit
from mtcommission.controls.row import (
    AT_CORNERS,
    PATH_ACCELERATION,
    PATH_JERK,
    WAIT,
    Key,
    Setting,
)
from mtcommission.controls.syntax import Entry
from mtcommission.group.contours import Pair, Trace, trace_circles
from mtcommission.group.export import Part, type_in_group
from mtcommission.group.group import UNBOUND
from mtcommission.group.page import contour_panel, draw_ballbar, micrometres
from mtcommission.group.record import AxisEntry, GroupRecord
from mtcommission.machine.checks import filter_rows, name_filter, say_filter
from mtcommission.record.machine import say_assumed
from mtcommission.sheet.document import (
    HASH_DIGITS,
    BigValue,
    Block,
    Bullets,
    Column,
    Document,
    Form,
    Headline,
    Paragraph,
    Section,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.html import set_html
from mtcommission.sheet.pdf import set_pdf
from mtcommission.sheet.tables import DASH, Quantity, capitalised, pairs, show, table, words_for
from mtcommission.sheet.verdict import check_columns, entry_name, show_typed

JUST_BELOW = 0.999
"""Of a ceiling that bounds nothing, for it was rounded."""

TYPED: dict[Key, str] = {
    (Setting.ACCELERATION, ""): "acceleration",
    (Setting.RISE_TIME, ""): "group-rise-time",
    (Setting.JERK, ""): "jerk",
    (Setting.JERK_TIME, ""): "jerk-time",
    PATH_ACCELERATION: "group-path-acceleration",
    PATH_JERK: "group-path-jerk",
    AT_CORNERS: "group-corners",
    (Setting.AVERAGE, ""): "setpoint-filter",
    (Setting.SECOND_AVERAGE, ""): "setpoint-filter",
    (Setting.SHAPER, ""): "setpoint-filter",
    (Setting.SHAPER_FREQUENCY, ""): "setpoint-filter",
    (Setting.SHAPER_DAMPING, ""): "setpoint-filter",
    (Setting.POSITION_GAIN, ""): "Kv",
    (Setting.VELOCITY_GAIN, ""): "Kp",
    (Setting.INTEGRAL_TIME, ""): "Tn",
    (Setting.FORCE_FEEDFORWARD, ""): "group-feedforward",
    (Setting.REFERENCE_DELAY, ""): "group-balancing",
    WAIT: "group-wait",
}
"""What axes and path are told, and what it is called; the export has all the rest."""

PATH = (("acceleration", "m/s^2"), ("jerk", "m/s^3"))

HOW = ("group-measure-centre", "group-measure-turn", "group-measure-peaks")


def print_group(
    record: GroupRecord, pair: Pair, *, language: str = "en", with_pdf: bool = True
) -> dict[str, bytes]:
    """Return the sheet of a group: HTML that works offline, and its two pages as PDF, A4.

    ``pair``: as the record has it, or as the group had it that the record is of.

    Raises
    ------
    ComputationError
        PRINTING_FAILED with the compiler's message.
    """
    words = words_of(record, language)
    found = compose_group(record, pair, words)
    html = set_html(found, panel=contour_panel(record, pair, words))
    files = {"sheet.html": html.encode()}
    if with_pdf:
        files["sheet.pdf"] = set_pdf(replace(found, sections=found.pages))
    return files


def words_of(record: GroupRecord, language: str) -> Catalogue:
    """Return the texts of a language for the axes of a group."""
    return words_for(record.axes[0].machine, language)


def compose_group(record: GroupRecord, pair: Pair, words: Catalogue) -> Document:
    """Return the sheet of a group: values to enter, circles and corners, and what is assumed."""
    text = words.text
    profiles = [
        text("identity", name=axis.profile.name, hash=axis.profile.sha256[:HASH_DIGITS])
        for axis in record.axes
    ]
    pages = {"verdict": first_page(record, words), "contours": second_page(record, pair, words)}
    assumed = Bullets(items=tuple(map(words.say, record.assumptions)))
    assumptions = Section(
        key="assumptions", heading=text("assumptions"), blocks=(assumed,), is_appendix=True
    )
    return Document(
        language=words.language,
        title=text("group-title"),
        machine=record.axes[0].machine.name,
        axis=text("group-axes-named", axes=", ".join(axis.name for axis in record.axes)),
        identity="; ".join(profiles),
        created=record.created,
        disclaimer=text("disclaimer"),
        sections=(
            *(
                Section(key=key, heading=text(f"group-{key}-heading"), blocks=tuple(blocks))
                for key, blocks in pages.items()
            ),
            assumptions,
        ),
    )


def first_page(record: GroupRecord, words: Catalogue) -> Iterator[Block]:
    """Yield verdict, what to enter, requirements, on what it rests."""
    yield headline(record, words)
    if record.warnings:
        yield Bullets(items=tuple(map(words.say, record.warnings)), tone=Tone.WARNING)
    try:
        parts = type_in_group(record)
    except InputError as refused:
        parts = [Part(name=name, entries=()) for name in (*(axis.name for axis in record.axes), "")]
        why = words.text("entry-none", why=refused.faults[0].message)
        yield Paragraph(text=why, tone=Tone.WARNING)
    yield _entries(record, parts, words)
    if filters := [_force_filters(axis, words) for axis in record.axes if axis.loop.force_filters]:
        said = words.text("group-force-filters", filters="; ".join(filters))
        yield Paragraph(text=said, tone=Tone.WARNING)
    yield note(" ".join(_bounds(record, words)))
    yield _checks(record, words)
    yield pairs(
        words,
        "basis-caption",
        _rests_on(record, words),
        first="axis-row",
        width=11.0,
    )
    # What is assumed of an axis alone stands below the pages, as on its own sheet.
    sentences = [item for item in record.assumptions if isinstance(item, Message)]
    own = [item for item in sentences if item.kind.startswith("group-")]
    yield note(" ".join(map(words.say, own)))


def headline(record: GroupRecord, words: Catalogue) -> Headline:
    """Return verdict, limits of the path, filter, and what is not kept."""
    text, met, path = words.text, record.assessment.met, record.path
    said = [text("group-tolerance", tolerance=record.tolerance, feed=record.feed) + "."]
    missed = [words.say(check.label) for check in record.assessment.checks if not check.met]
    if missed:
        said.append(text("group-missed", checks=", ".join(missed)))
    values = [
        BigValue(
            label=text(f"group-path-{name}"),
            value=show(getattr(path, name), words, unit, "group-path-none"),
        )
        for name, unit in _paths(record)
    ]
    (label, kind), *numbers = filter_rows(record.filter, words)
    filter_value = ", ".join(number for _, number in numbers)
    values.append(
        BigValue(label=capitalised(kind), value=filter_value)
        if numbers
        else BigValue(label=label, value=kind)
    )
    return Headline(
        is_met=met,
        verdict=text("verdict-met" if met else "verdict-not-met"),
        detail=" ".join(said),
        values=tuple(values),
    )


def _paths(record: GroupRecord) -> Sequence[tuple[str, str]]:
    return PATH[:1] if record.axes[0].loop.jerk == "none" else PATH


def _force_filters(axis: AxisEntry, words: Catalogue) -> str:
    named = ", ".join(words.say(name_filter(item)) for item in axis.loop.force_filters)
    return f"{axis.name}: {named}"


def _parameter(entry: Entry, words: Catalogue) -> str:
    """What the control calls it, and whether that was read in a maker's text."""
    return f"{entry_name(entry, words)}{'' if entry.row.is_verified else ' (?)'}"


def _bound(record: GroupRecord, name: str, words: Catalogue) -> str:
    """What it bounds: nothing where the limits of the axes do, which hold in every direction."""
    told = getattr(record.path, name)
    limits = {axis.name: getattr(axis.limits.recommended, name) for axis in record.axes}
    least = min(limits, key=lambda axis: limits[axis])
    if told is None or told > max(limits.values()) * UNBOUND * JUST_BELOW:
        return words.text("group-bound-by-axes")
    if isclose(told, limits[least], rel_tol=1e-3):
        return words.text("group-bound-by-axis", name=least)
    return words.text("group-bound-by-tolerance")


def _with_unit(entry: Entry, words: Catalogue) -> str:
    unit = pretty_unit(entry.row.unit)
    return f"{_parameter(entry, words)} [{unit}]" if unit else _parameter(entry, words)


def _number(typed: str, entry: Entry, words: Catalogue) -> str:
    """What is typed in, without the unit that stands beside the parameter."""
    return show_typed(typed, replace(entry, row=replace(entry.row, unit="")), words)


def _entries(record: GroupRecord, parts: Sequence[Part], words: Catalogue) -> Table:
    """What is typed in for each axis and the path, today's value before it where it is stated.

    Of what a control has by modes, the first.
    """
    text, rows = words.text, []
    own = [{one.row.key: one for one in reversed(part.entries)} for part in parts]
    has_old = any(entry.old for axis in own for entry in axis.values())
    has_path = bool(own[-1])
    for key, label in TYPED.items():
        *of_axes, of_path = [part.get(key) for part in own]
        # Of controls whose names tell the axis, one name for each.
        names = dict.fromkeys(_with_unit(entry, words) for entry in (*of_axes, of_path) if entry)
        if not names and key != WAIT:
            continue
        cells = [words.known(label, label), " / ".join(names) or DASH]
        for axis, entry in zip(record.axes, of_axes, strict=True):
            new = _number(entry.value, entry, words) if entry else DASH
            if key == WAIT and not entry:
                new = show(axis.wait, words, "s")
            old = _number(entry.old, entry, words) if entry and entry.old else DASH
            cells += [old, new] if has_old else [new]
        if has_path:
            cells.append(_number(of_path.value, of_path, words) if of_path else DASH)
        rows.append(tuple(cells))
    settled = [show(axis.settling_time, words, "s", "not-settled") for axis in record.axes]
    cells = [cell for one in settled for cell in ((DASH, one) if has_old else (one,))]
    rows.append((text("group-settles"), DASH, *cells, *([DASH] if has_path else [])))
    columns = [
        Column(head=text("quantity"), width=1.9),
        Column(head=text("parameter"), width=2.5 if has_old and len(own) > 3 else 3.4),
    ]
    for axis in record.axes:
        old_head, new_head = (text(f"group-axis-{key}", name=axis.name) for key in ("today", "new"))
        heads = [old_head, new_head] if has_old else [axis.name]
        columns += [Column(head=head, is_number=True) for head in heads]
    if has_path:
        columns.append(Column(head=text("group-path-column"), is_number=True))
    return Table(caption=text("group-typed-caption"), columns=tuple(columns), rows=tuple(rows))


def _bounds(record: GroupRecord, words: Catalogue) -> Iterator[str]:
    """What binds the limits of each axis and of the path, why this filter, and corners."""
    for axis in record.axes:
        name, by = words.text("group-part-axis", name=axis.name), axis.limits.recommended.bound_by
        yield words.text("group-bound-of", name=name, by=by)
    for name, _ in _paths(record):
        by = _bound(record, name, words)
        yield words.text("group-bound-of", name=words.text(f"group-path-{name}"), by=by)
    yield f"{capitalised(say_filter(record.filter, words))}: {words.say(record.filter_reason)}."
    yield say_corners(record, words)


def say_corners(record: GroupRecord, words: Catalogue) -> str:
    """Return what the control is told for corners, or that it is told nothing."""
    told = record.corner_rule
    if told.value and told.name:
        return words.text("group-corner-told", kind=told.kind, name=told.name, value=told.value)
    return words.text("group-corner-no-arc" if told.kind == "arc" else "group-corner-no-value")


def _checks(record: GroupRecord, words: Catalogue) -> Table:
    name, where = Quantity("check", "label", width=2.9), Quantity("where", "where", width=7.85)
    # Rows that are not kept stand out; that leaves room for the place, and bold numbers need some.
    numbers = zip(check_columns(words), (1.55, 1.75, 1.5), strict=False)
    columns = name, *(replace(one, width=width) for one, width in numbers), where
    checks = record.assessment.checks
    return table(words, "checks-caption", columns, checks, strong=lambda check: not check.met)


def _rests_on(record: GroupRecord, words: Catalogue) -> list[tuple[str, str]]:
    """Where the data of the axes come from, and what of them nobody stated."""
    found: dict[str, list[str]] = {}
    for axis in record.axes:
        said = say_assumed(axis.data, axis.plant.units, words)
        assumed = [f"{words.text('basis-assumed')}: {'; '.join(said)}"] if said else []
        rests = ". ".join([words.say(axis.machine.source), *assumed])
        found.setdefault(rests, []).append(axis.name)
    return [(", ".join(names), rests) for rests, names in found.items()]


def second_page(record: GroupRecord, pair: Pair, words: Catalogue) -> Iterator[Block]:
    """Yield the circle test, feed over radius, speed over angle, and what to measure."""
    traces = _traces(record, pair)
    yield draw_ballbar(
        words,
        names=record.plane,
        radius=record.circle[0].radius,
        tolerance=record.tolerance,
        traces={words.format.feed(feed): trace for feed, trace in traces.items()},
    )
    yield feeds_table(record, words)
    if said := say_peaks(record, words):
        yield note(said)
    yield corners_table(record, words)
    yield _measurements(record, traces, words)
    first, second = record.plane
    how = (words.text(key, first=first, second=second) for key in HOW)
    yield Bullets(items=tuple(how), tone=Tone.NOTE)
    yield Form(fields=(words.text("measure-field-1"), words.text("measure-field-2")))


def feeds_table(record: GroupRecord, words: Catalogue) -> Table:
    """Return the largest feed of circles over their radius, and what forbids more."""
    columns: tuple[Quantity, ...] = (
        Quantity("group-radius", "radius", "m"),
        Quantity(
            "group-page-field-feed",
            lambda one: words.format.feed(one.feed) if one.feed else DASH,
            "",
        ),
        Quantity("bound-by-column", lambda one: _forbids(one, words), width=2.0),
    )
    every, tolerance = record.feed_over_radius, record.tolerance
    if any(one.without_peaks for one in every):
        columns += (
            Quantity(
                "group-feed-without-peaks",
                lambda one: words.format.feed((one.without_peaks or one).feed),
                "",
                width=1.5,
            ),
            Quantity(
                "bound-by-column",
                lambda one: _forbids(one.without_peaks or one, words),
                width=2.0,
            ),
        )
    return table(words, "group-feeds-caption", columns, every, tolerance=tolerance)


def say_peaks(record: GroupRecord, words: Catalogue) -> str:
    """Return why no feed keeps the tolerance where reversals do not even on the slowest circle."""
    slowest = record.circle[0]
    name, peak = max(slowest.quadrant_peak.items(), key=lambda one: one[1], default=("", 0.0))
    if peak <= record.tolerance:
        return ""
    feed, tolerance = slowest.feed, record.tolerance
    return words.text("group-peaks-forbid", name=name, peak=peak, feed=feed, tolerance=tolerance)


def corners_table(record: GroupRecord, words: Catalogue) -> Table:
    """Return the speed at corners over their angle, and what not to slow down costs."""
    columns = (
        Quantity("group-angle", "angle_deg", "°"),
        Quantity("group-corner-speed", lambda one: words.format.feed(one.speed), ""),
        in_micrometres("group-not-slowed", "deviation_without_slowing", words),
    )
    every, feed = record.speed_over_angle, record.feed
    return table(words, "group-corners-caption", columns, every, feed=feed)


def in_micrometres(
    name: str | Message, value: str | Callable[[Any], object], words: Catalogue
) -> Quantity:
    """Return a column of deviations that has one unit."""
    plain = Quantity(name, value)
    return replace(plain, value=lambda item: micrometres(plain.of(item), words), unit="")


def _traces(record: GroupRecord, pair: Pair) -> dict[float, Trace]:
    """The circles of the test in the nominal machine, by feed."""
    feeds = [one.feed for one in record.circle]
    return dict(zip(feeds, trace_circles(pair, record.circles), strict=True))


def _forbids(one: Any, words: Catalogue) -> str:
    said = words.say(one.bound_by)
    return f"{said} ({one.axis})" if one.axis else said


def _measurements(record: GroupRecord, traces: dict[float, Trace], words: Catalogue) -> Table:
    """Each figure of a circle test: calculated and, to be filled in, measured, by feed."""
    text, circles = words.text, record.circle
    columns = [Column(head=text("measurement"), width=2.4)]
    for circle in circles:
        columns.append(Column(head=words.format.feed(circle.feed), is_number=True))
        columns.append(Column(head=text("measured"), width=0.9))
    rows = [
        (text(f"group-measured-{key}"), [getattr(trace, key) for trace in traces.values()])
        for key in ("largest", "least", "circular")
    ]
    rows += [
        (text("group-check-peak", name=name), [one.quadrant_peak[name] for one in circles])
        for name in circles[0].quadrant_peak
    ]
    worst = [
        (text("group-worst-radius"), [one.radius_deviation for one in circles]),
        (text("group-worst-form"), [one.form_deviation for one in circles]),
    ]
    cells = [
        (label, *(cell for value in values for cell in (micrometres(value, words), blank)))
        for group, blank in ((rows, ""), (worst, DASH))
        for label, values in group
    ]
    caption = text("group-measure-caption", radius=circles[0].radius, tolerance=record.tolerance)
    return Table(caption=caption, columns=tuple(columns), rows=tuple(cells), is_form=True)
