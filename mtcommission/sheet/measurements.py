"""Page 4: what to measure at the machine, and signature; and what changed since a record."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial
from operator import attrgetter, itemgetter
from typing import TYPE_CHECKING, NamedTuple

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.checks import name_filter, say_filter
from mtcommission.record.machine import Datum, datum, datum_name
from mtcommission.record.moves import MoveEntry
from mtcommission.record.read_back import Verified
from mtcommission.record.record import Record
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Form,
    Paragraph,
    Subheading,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.tables import (
    ACCELERATION,
    BANDWIDTH,
    DAMPING,
    DASH,
    FREQUENCY,
    GAIN_MARGIN,
    JERK_TIME,
    MASS,
    MAX_FORCE,
    PATH_GAINS,
    PEAK,
    PHASE_MARGIN,
    RESIDUAL,
    RMS_FORCE,
    SETTLING,
    Quantity,
    capitalised,
    show,
    table,
)
from mtcommission.sheet.verdict import (
    find_band,
    find_number,
    move_title,
    permitted_margin,
    signature,
)

if TYPE_CHECKING:
    from mtcommission.record.exported import Export

HOW = tuple(f"measure-how-{i}" for i in range(1, 6))
HOW_FOLLOWED = HOW[0], HOW[3]
"""How each thing is measured; where the motor follows there is no loop, and no force known."""

OF_THE_LOOP = (
    "plant",
    "machine_states",
    "drive.force_lag",
    "requirements.payload",
    "requirements.frequency_spread",
    "requirements.damping_spread",
    "control",
)
"""Beginnings of the keys of data that the margins of a loop hang on."""

SAME = 1e-6
"""Relative difference below which two results are the same: the search rounds far above it."""


class Measurement(NamedTuple):
    """What to measure: a quantity of an item of the record, and what is permitted."""

    name: str
    quantity: Quantity
    item: object
    permitted: str = DASH
    key: str = ""  # how ``verify`` calls it


def fourth_page(
    record: Record, typed: Export | Message, words: Catalogue, verified: Verified | None
) -> Iterator[Block]:
    """Yield the measurements that confirm the record, with what was measured if it is known."""
    text, follows = words.text, record.machine.follows
    rows = list(_structure(record, words))
    if not follows:
        margins = (GAIN_MARGIN, PHASE_MARGIN, BANDWIDTH)
        rows += [
            Measurement(one.head(words), one, record.loop, permitted_margin(one, record, words))
            for one in margins
        ]
    for number, move in enumerate(record.moves, start=1):
        rows += _motion(record, move, number, words)
    titles = (move_title(one.move, number, words) for number, one in enumerate(record.moves, 1))
    how = tuple(map(text, HOW_FOLLOWED if follows else HOW))
    yield note(text("measure-note", moves="; ".join(titles)))
    yield Bullets(items=how, tone=Tone.NOTE)
    yield _table(rows, verified, words)
    if verified:
        tone = Tone.PLAIN if verified.verdict == "holds" else Tone.WARNING
        said = text("measure-verdict", verdict=verified.headline)
        yield Paragraph(text=said, tone=tone)
    yield Form(fields=(text("measure-field-1"), text("measure-field-2")))
    yield Subheading(text=text("signature-heading"))
    yield from signature(record, typed, words)


def _table(rows: list[Measurement], verified: Verified | None, words: Catalogue) -> Table:
    filled = [
        (row.name, row.quantity.show(row.item, words), row.permitted, *found)
        for row in rows
        for found in [_measured(row, verified, words)]
    ]
    last = "measured-by" if verified is None else "verdict"
    heads = ("measurement", "calculated", "permitted", "measured", "difference", last)
    columns = (
        Quantity(head, itemgetter(k), "" if k in (1, 2) else None, width=1.1 if k else 2.4)
        for k, head in enumerate(heads)
    )
    return replace(table(words, "measure-caption", columns, filled), is_form=True)


def _say_verdict(verdict: str, words: Catalogue) -> str:
    return words.text(f"verify-verdict-{verdict.replace(' ', '-')}")


def _measured(
    row: Measurement, verified: Verified | None, words: Catalogue
) -> tuple[str, str, str]:
    """Measured value, its difference from the calculated one, and the verdict; "" if not known."""
    found = verified.values.get(row.key) if verified else None
    if found is None:
        return "", "", ""
    said = _say_verdict(found.verdict, words) if found.verdict else ""
    if found.measured is None:
        return DASH, "", said

    def shown(value: float, digits: int) -> str:
        return show(value, words, str(row.quantity.unit), digits=digits)

    measured, value = shown(found.measured, 4), row.quantity.of(row.item)
    if found.uncertainty is not None:
        measured += f" ± {shown(found.uncertainty, 2)}"
    apart = shown(found.measured - value, 3) if isinstance(value, float) else ""
    return measured, apart, said


def _structure(record: Record, words: Catalogue) -> Iterator[Measurement]:
    plant = record.plant
    if not record.machine.follows:
        yield Measurement(MASS.head(words), MASS, plant, key="mass")
    for mode in plant.modes:
        for quantity, kind, key in (
            (FREQUENCY, "frequency", "frequency"),
            (DAMPING, "damping", "damping_ratio"),
        ):
            name = words.text("of-mode", name=quantity.head(words), mode=mode.name)
            spread = find_number(record, f"requirements.{kind}_spread")
            permitted = f"± {show(spread, words, '%')}" if spread else DASH
            yield Measurement(name, quantity, mode, permitted, f"{mode.name}.{key}")


def _motion(
    record: Record, move: MoveEntry, number: int, words: Catalogue
) -> Iterator[Measurement]:
    """Nominal values of one move; what is permitted is the requirement itself."""
    limits = {check.name: check.limit for check in record.assessment.checks}
    moving = [
        (SETTLING, "settling time", limits.get("settling time")),
        (RESIDUAL, "residual deviation", find_band(record)),
        (PEAK, "peak deviation", None),
    ]
    most = find_number(record, "drive.max_force")
    if most is None:  # the motor follows its setpoint
        moving += [(MAX_FORCE, "max force", limits.get("set force"))]
    else:
        # What a trace shows is the motor's force, behind its lag, with what it holds beside.
        beside = most - record.loop.motion_force
        force = Quantity("verify-max-force", lambda one: one.peaks["F"] + beside, "N")
        rms = (RMS_FORCE, "RMS force", limits.get("RMS force"))
        moving += [(force, "max force", most), rms]
    for quantity, key, permitted in moving:
        name = f"{words.text('move', number=number)}: {capitalised(quantity.head(words))}"
        allowed, key = show(permitted, words, str(quantity.unit)), f"move {number}: {key}"
        yield Measurement(name, quantity, move.response, allowed, key)


class Change(NamedTuple):
    """One thing before and after as printed, and the difference, in words or per cent."""

    name: str
    before: str
    after: str
    change: str


def differences(before: Record, after: Record, words: Catalogue) -> Iterator[Block]:
    """Yield what changed from one record to another, the one whose sheet is printed.

    Raises
    ------
    InputError
        If one axis is linear and the other rotary.
    """
    if before.machine.motion != after.machine.motion:
        message = Message("compared-with-other-motion", got=before.machine.motion)
        raise InputError([Fault(where="--compare", message=message)])
    text, machine, profile = words.text, before.machine, before.profile
    said = {"machine": machine.name, "axis_name": machine.axis, "name": profile.name}
    yield note(text("compared-with", **said, created=before.created, hash=profile.sha256))
    for remark in remark_on_comparison(before, after):
        yield Paragraph(text=words.say(remark), tone=Tone.WARNING)
    inputs = list(_inputs(before, after, words))
    if not inputs:
        yield Paragraph(text=text("no-changed-inputs"))
    outcome = [
        *_of(_limits(words), before, after, words),
        *_moves(before, after, words),
        *_of(_loop(words), before, after, words),
    ]
    columns = (
        Quantity("quantity", "name", width=2.0),
        Quantity("before", "before", "", width=1.4),
        Quantity("after", "after", "", width=1.4),
        Quantity("change", "change", ""),
    )
    for caption, changes in (("changed-inputs", inputs), ("changed-outcome", outcome)):
        if changes:
            yield table(words, caption, columns, changes)
    if any(list(_of([one], before, after, words)) for one in _gains(words)):
        causes = ", ".join(_of_the_loop(before, after, words))
        yield note(text("changed-gains" if causes else "changed-gains-by-moves", causes=causes))


def remark_on_comparison(before: Record, after: Record) -> tuple[Message, ...]:
    """Return a warning where the two records are of different axes."""
    one, other = (f"{item.name} {item.axis}" for item in (before.machine, after.machine))
    if one == other:
        return ()
    return (Message("compared-other-axis", before=one, after=other),)


def _of(
    quantities: Iterable[Quantity], before: object, after: object, words: Catalogue
) -> Iterator[Change]:
    for one in quantities:
        shown = one.show(before, words), one.show(after, words)
        yield from _change(one.head(words), (one.of(before), one.of(after)), shown, words)


def _change(
    name: str, values: tuple[object, object], shown: tuple[str, str], words: Catalogue
) -> Iterator[Change]:
    before, after = values
    change = words.text("changed")
    if isinstance(before, float | int) and isinstance(after, float | int):
        if abs(after - before) <= SAME * max(abs(before), abs(after)):
            return
        if before * after > 0.0:  # else there is no share
            change = words.format.signed_percent(after / before - 1.0)
    elif shown[0] == shown[1]:
        return
    yield Change(name, *shown, change)


def _inputs(before: Record, after: Record, words: Catalogue) -> Iterator[Change]:
    named = {"machine-row": "name", "axis-row": "axis", "source": "source"}
    machine = [Quantity(head, f"machine.{key}") for head, key in named.items()]
    yield from _of(machine, before, after, words)
    old, new = ({item.key: item for item in record.data} for record in (before, after))
    # In the order of the sheet, then what has gone.
    for key, item in (new | {key: item for key, item in old.items() if key not in new}).items():
        was, now = old.get(key), new.get(key)
        shown = _datum(was, before, words), _datum(now, after, words)
        values = was and was.value, now and now.value
        yield from _change(datum_name(item, words), values, shown, words)
    yield from _of([Quantity("version", "tool.version")], before, after, words)


def _of_the_loop(before: Record, after: Record, words: Catalogue) -> Iterator[str]:
    """Names of data of the axis that are new, and on which the margins of a loop hang."""
    old = {item.key: item.value for item in before.data}
    for item in after.data:
        if item.key.startswith(OF_THE_LOOP) and item.value != old.get(item.key):
            yield datum_name(item, words)


def _datum(item: Datum | None, record: Record, words: Catalogue) -> str:
    return words.text("not-stated") if item is None else datum(item, record.plant.units, words)


def _limits(words: Catalogue) -> Iterator[Quantity]:
    of_recommended = attrgetter("limits.recommended")
    limits = (ACCELERATION, Quantity("jerk", "jerk", "m/s^3"), JERK_TIME)
    for one in (*limits, Quantity("bound-by-column", "bound_by")):
        yield one.within(of_recommended)
    yield Quantity("setpoint-filter", partial(_setpoint_filter, words))
    yield Quantity("verdict-met", "assessment.met")
    yield from (one.within(of_recommended) for one in (SETTLING, RESIDUAL, PEAK))


def _loop(words: Catalogue) -> Iterator[Quantity]:
    of_loop = attrgetter("loop")
    yield from _gains(words)
    yield Quantity("reference-delay", "loop.reference_delay", "s")
    yield Quantity("change-force-filters", partial(_force_filters, words))
    feedback = capitalised(words.text("has-state-feedback"))
    yield Quantity(feedback, lambda record: bool(record.loop.state_feedback))
    for one in (GAIN_MARGIN, PHASE_MARGIN):
        name = f"{one.head(words)}, {words.text('worst-corner')}"
        yield Quantity(name, partial(_in_worst_corner, one, words))
    yield BANDWIDTH.within(of_loop)


def _gains(words: Catalogue) -> Iterator[Quantity]:
    for one in PATH_GAINS:
        yield replace(one, name=words.name(str(one.name))).within(attrgetter("loop"))


def _setpoint_filter(words: Catalogue, record: Record) -> str:
    return say_filter(record.limits.recommended.setpoint_filter, words)


def _force_filters(words: Catalogue, record: Record) -> str:
    named = [words.say(name_filter(item)) for item in record.loop.force_filters]
    return "; ".join(named) or words.text("no-setpoint-filter")


def _in_worst_corner(quantity: Quantity, words: Catalogue, record: Record) -> str:
    corner = record.loop.worst_corner
    return quantity.show(corner, words) if corner else DASH


def _moves(before: Record, after: Record, words: Catalogue) -> Iterator[Change]:
    text = words.text
    for place, (was, now) in enumerate(zip(before.moves, after.moves, strict=False)):
        titles = (move_title(was.move, place + 1, words), move_title(now.move, place + 1, words))
        if titles[0] != titles[1]:
            yield from _change(text("move", number=place + 1), titles, titles, words)
            continue
        for one in (SETTLING, MAX_FORCE):
            named = replace(one, name=f"{titles[1]}: {one.head(words)}, {text('nominal')}")
            yield from _of([named], was.response, now.response, words)
        name = f"{titles[1]}: {text('control-time-optimal')}, {text('final-time')}"
        optima = before.optima[place], after.optima[place]
        yield from _of([Quantity(name, "time.t_f", "s")], *optima, words)
