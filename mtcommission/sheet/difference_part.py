"""What changed between two records: machine and requirements, limits, result, loop."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mtcommission.errors import Fault, InputError
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.messages.quantities import motion_unit
from mtcommission.record.schema.machine import Datum
from mtcommission.record.schema.record import Record
from mtcommission.sheet.machine_part import datum, datum_name
from mtcommission.sheet.model import Column, Paragraph, Section, Table, Tone
from mtcommission.sheet.values import decibel, degree, settling
from mtcommission.sheet.verdict_part import move_title

SAME = 1e-6
"""Relative difference below which two results are the same: the search rounds far above it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One thing before and after.

    Parameters
    ----------
    name
        What it is.
    before, after
        As printed.
    change
        The difference, in words or per cent.
    is_changed
        Whether there is one.
    """

    name: str
    before: str
    after: str
    change: str
    is_changed: bool


def differences(before: Record, after: Record, words: Catalogue) -> Section:
    """Return what changed from one record to another of the same kind of axis.

    Parameters
    ----------
    before, after
        Records; ``after`` is the one whose sheet is printed.
    words
        Of the language and the kind of axis.

    Raises
    ------
    InputError
        If one axis is linear and the other rotary.
    """
    motions = (before.machine.motion, after.machine.motion)
    if motions[0] != motions[1]:
        message = Message("compared-with-other-motion", got=motions[0], wanted=motions[1])
        raise InputError([Fault(where="--compare", message=message)])
    text, profile = words.text, before.profile
    inputs = [change for change in _inputs(before, after, words) if change.is_changed]
    sources = text(
        "compared-with",
        machine=before.machine.name,
        axis_name=before.machine.axis,
        created=before.created,
        name=profile.name,
        hash=profile.sha256,
    )
    return Section(
        key="differences",
        heading=text("differences-heading"),
        blocks=(
            Paragraph(text=sources, tone=Tone.NOTE),
            _table(text("changed-inputs"), inputs, words)
            if inputs
            else Paragraph(text=text("no-changed-inputs")),
            _table(text("changed-limits"), _limits(before, after, words), words),
            _table(text("changed-result"), _result(before, after, words), words),
            _table(text("changed-loop"), _loop(before, after, words), words),
        ),
    )


def _table(caption: str, changes: Iterable[Change], words: Catalogue) -> Table:
    text, rows = words.text, list(changes)
    return Table(
        caption=caption,
        columns=(
            Column(head=text("quantity"), width=2.0),
            Column(head=text("before"), width=1.4, is_number=True),
            Column(head=text("after"), width=1.4, is_number=True),
            Column(head=text("change"), is_number=True),
        ),
        rows=tuple((row.name, row.before, row.after, row.change) for row in rows),
        strong_rows=tuple(i for i, row in enumerate(rows) if row.is_changed),
    )


def _inputs(before: Record, after: Record, words: Catalogue) -> list[Change]:
    text = words.text
    rows = [
        _words(name, getattr(before.machine, key), getattr(after.machine, key), words)
        for name, key in (
            (text("machine-row"), "name"),
            (text("axis-row"), "axis"),
            (text("source"), "source"),
        )
    ]
    old = {item.key: item for item in before.data}
    new = {item.key: item for item in after.data}
    # In the order of the sheet, then what has gone.
    named = new | {key: item for key, item in old.items() if key not in new}
    rows += [
        _datum_change(item, (old.get(key), new.get(key)), (before, after), words)
        for key, item in named.items()
    ]
    tools = (before.tool.version, after.tool.version)
    return [*rows, _words(text("version"), *tools, words)]


def _datum_change(
    named: Datum,
    items: tuple[Datum | None, Datum | None],
    records: tuple[Record, Record],
    words: Catalogue,
) -> Change:
    shown = [
        words.text("not-stated") if item is None else datum(item, record.plant.units, words)
        for item, record in zip(items, records, strict=True)
    ]
    name = datum_name(named, words)
    before, after = (None if item is None else item.value for item in items)
    if isinstance(before, float | int) and isinstance(after, float | int):
        return _numbers(name, (before, after), (shown[0], shown[1]), words)
    return _words(name, shown[0], shown[1], words)


def _limits(before: Record, after: Record, words: Catalogue) -> list[Change]:
    text = words.text
    old, new = before.limits.recommended, after.limits.recommended
    return [
        _of_axis(text("acceleration"), (old.acceleration, new.acceleration), "m/s^2", words),
        _of_axis(text("jerk"), (old.jerk, new.jerk), "m/s^3", words),
        _quantity(text("jerk-time"), (old.jerk_time, new.jerk_time), "s", words),
        _words(text("bound-by-column"), words.say(old.bound_by), words.say(new.bound_by), words),
    ]


def _result(before: Record, after: Record, words: Catalogue) -> list[Change]:
    text, parts = words.text, (before.assessment, after.assessment)
    old, new = before.limits.recommended, after.limits.recommended
    verdicts = [text("yes") if part.met else text("no") for part in parts]
    rows = [
        _words(text("verdict-met"), verdicts[0], verdicts[1], words),
        _settling(text("settling-time"), (old.settling_time, new.settling_time), words),
        _of_axis(text("residual"), (old.residual_deviation, new.residual_deviation), "m", words),
        _of_axis(text("peak-deviation"), (old.peak_deviation, new.peak_deviation), "m", words),
    ]
    moves = zip(before.moves, after.moves, before.optima, after.optima, strict=False)
    for number, (was, now, reference, optimum) in enumerate(moves, start=1):
        titles = [move_title(move.move, number, words) for move in (was, now)]
        if titles[0] != titles[1]:
            rows.append(_words(text("move", number=number), titles[0], titles[1], words))
            continue
        settled = (was.response.settling_time, now.response.settling_time)
        forces = (was.response.max_force, now.response.max_force)
        times = (reference.time.t_f, optimum.time.t_f)
        rows += [
            _settling(f"{titles[1]}: {text('settling-time')}, {text('nominal')}", settled, words),
            _of_axis(f"{titles[1]}: {text('max-force')}, {text('nominal')}", forces, "N", words),
            _quantity(
                f"{titles[1]}: {text('time-optimal')}, {text('final-time')}", times, "s", words
            ),
        ]
    return rows


def _loop(before: Record, after: Record, words: Catalogue) -> list[Change]:
    text, old, new = words.text, before.loop, after.loop
    both = (old, new)
    rows = [
        _quantity(words.name("Kv"), (old.Kv, new.Kv), "1/s", words),
        _of_axis(words.name("Kp"), (old.Kp, new.Kp), "N s/m", words),
        _quantity(words.name("Tn"), (old.Tn, new.Tn), "s", words),
        _quantity(text("reference-delay"), (old.reference_delay, new.reference_delay), "s", words),
    ]
    feedback = [text("yes") if part.state_feedback else text("no") for part in both]
    rows.append(_words(text("state-feedback-used"), feedback[0], feedback[1], words))
    for name, key, show in (
        (text("gain-margin"), "gain_margin_db", decibel),
        (text("phase-margin"), "phase_margin_deg", degree),
    ):
        margins = [getattr(part.worst_corner, key, None) for part in both]
        shown = [show(value, words) for value in margins]
        rows.append(_words(f"{name}, {text('worst-corner')}", shown[0], shown[1], words))
    bandwidths = (old.bandwidth_hz, new.bandwidth_hz)
    return [*rows, _quantity(text("bandwidth"), bandwidths, "Hz", words)]


def _settling(name: str, values: tuple[float | None, float | None], words: Catalogue) -> Change:
    return _maybe(name, values, (settling(values[0], words), settling(values[1], words)), words)


def _quantity(
    name: str, values: tuple[float | None, float | None], unit: str, words: Catalogue
) -> Change:
    f = words.format
    return _maybe(name, values, (f.quantity(values[0], unit), f.quantity(values[1], unit)), words)


def _of_axis(
    name: str, values: tuple[float | None, float | None], unit: str, words: Catalogue
) -> Change:
    return _quantity(name, values, motion_unit(unit, rotary=words.rotary), words)


def _maybe(
    name: str, values: tuple[float | None, float | None], shown: tuple[str, str], words: Catalogue
) -> Change:
    before, after = values
    if before is None or after is None:
        return _words(name, shown[0], shown[1], words)
    return _numbers(name, (before, after), shown, words)


def _numbers(
    name: str, values: tuple[float, float], shown: tuple[str, str], words: Catalogue
) -> Change:
    before, after = values
    if abs(after - before) <= SAME * max(abs(before), abs(after)):
        return _words(name, shown[1], shown[1], words)
    # There is no share of nothing, and none across a change of sign.
    share = (
        words.format.signed_percent(after / before - 1.0)
        if before * after > 0.0
        else words.text("changed")
    )
    return Change(name=name, before=shown[0], after=shown[1], change=share, is_changed=True)


def _words(name: str, before: str, after: str, words: Catalogue) -> Change:
    is_changed = before != after
    change = words.text("changed") if is_changed else words.text("unchanged")
    return Change(name=name, before=before, after=after, change=change, is_changed=is_changed)
