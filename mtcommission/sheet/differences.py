"""What changed between two records: machine and requirements, limits, result, loop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mtcommission.errors import Fault, InputError
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.loop import Margins
from mtcommission.record.machine import Datum, datum, datum_name
from mtcommission.record.record import Record
from mtcommission.sheet.document import Block, Paragraph, Table, note
from mtcommission.sheet.tables import (
    ACCELERATION,
    BANDWIDTH,
    DASH,
    GAIN_MARGIN,
    JERK_TIME,
    MAX_FORCE,
    PATH_GAINS,
    PEAK,
    PHASE_MARGIN,
    RESIDUAL,
    SETTLING,
    Quantity,
    capitalised,
    table,
    wide,
)
from mtcommission.sheet.verdict import move_title

SAME = 1e-6
"""Relative difference below which two results are the same: the search rounds far above it."""


class Change(NamedTuple):
    """One thing before and after as printed, and the difference, in words or per cent."""

    name: str
    before: str
    after: str
    change: str
    is_changed: bool


def differences(before: Record, after: Record, words: Catalogue) -> Iterator[Block]:
    """Yield what changed from one record to another, the one whose sheet is printed.

    Raises
    ------
    InputError
        If one axis is linear and the other rotary.
    """
    motions = (before.machine.motion, after.machine.motion)
    if motions[0] != motions[1]:
        message = Message("compared-with-other-motion", got=motions[0], wanted=motions[1])
        raise InputError([Fault(where="--compare", message=message)])
    profile = before.profile
    yield note(
        words.text(
            "compared-with",
            machine=before.machine.name,
            axis_name=before.machine.axis,
            created=before.created,
            name=profile.name,
            hash=profile.sha256,
        )
    )
    if inputs := [change for change in _inputs(before, after, words) if change.is_changed]:
        yield _table("changed-inputs", inputs, words)
    else:
        yield Paragraph(text=words.text("no-changed-inputs"))
    limits = [ACCELERATION, Quantity("jerk", "jerk", "m/s^3"), JERK_TIME]
    limits.append(Quantity("bound-by-column", "bound_by"))
    recommended = before.limits.recommended, after.limits.recommended
    yield _table("changed-limits", _of(limits, recommended, words), words)
    yield _table("changed-result", _result(before, after, words), words)
    yield _table("changed-loop", _loop(before, after, words), words)


def _table(caption: str, changes: Iterable[Change], words: Catalogue) -> Table:
    columns = (
        Quantity("quantity", "name", width=2.0),
        Quantity("before", "before", "", width=1.4),
        Quantity("after", "after", "", width=1.4),
        Quantity("change", "change", ""),
    )
    return table(words, caption, columns, changes, strong=lambda change: change.is_changed)


def _of(
    quantities: Iterable[Quantity], both: tuple[object, object], words: Catalogue, prefix: str = ""
) -> list[Change]:
    """The changes of some quantities of two items."""
    return [
        _change(
            prefix + one.head(words),
            (one.of(both[0]), one.of(both[1])),
            (one.show(both[0], words), one.show(both[1], words)),
            words,
        )
        for one in quantities
    ]


def _change(
    name: str, values: tuple[object, object], shown: tuple[str, str], words: Catalogue
) -> Change:
    before, after = values
    if not isinstance(before, float | int) or not isinstance(after, float | int):
        is_changed = shown[0] != shown[1]
        change = words.text("changed" if is_changed else "unchanged")
        return Change(name, *shown, change, is_changed)
    if abs(after - before) <= SAME * max(abs(before), abs(after)):
        return Change(name, shown[1], shown[1], words.text("unchanged"), is_changed=False)
    # There is no share of nothing, and none across a change of sign.
    share = words.text("changed")
    if before * after > 0.0:
        share = words.format.signed_percent(after / before - 1.0)
    return Change(name, *shown, share, is_changed=True)


def _inputs(before: Record, after: Record, words: Catalogue) -> list[Change]:
    named = {"machine-row": "name", "axis-row": "axis", "source": "source"}
    machine = [Quantity(*one) for one in named.items()]
    rows = _of(machine, (before.machine, after.machine), words)
    old, new = ({item.key: item for item in record.data} for record in (before, after))
    # In the order of the sheet, then what has gone.
    for key, item in (new | {key: item for key, item in old.items() if key not in new}).items():
        both = old.get(key), new.get(key)
        shown = _datum(both[0], before, words), _datum(both[1], after, words)
        values = tuple(one and one.value for one in both)
        rows.append(_change(datum_name(item, words), (values[0], values[1]), shown, words))
    return [*rows, *_of([Quantity("version", "version")], (before.tool, after.tool), words)]


def _datum(item: Datum | None, record: Record, words: Catalogue) -> str:
    return words.text("not-stated") if item is None else datum(item, record.plant.units, words)


def _result(before: Record, after: Record, words: Catalogue) -> list[Change]:
    text = words.text
    rows = _of([Quantity("verdict-met", "met")], (before.assessment, after.assessment), words)
    recommended = before.limits.recommended, after.limits.recommended
    rows += _of([SETTLING, RESIDUAL, PEAK], recommended, words)
    optimal = Quantity(f"{text('control-time-optimal')}, {text('final-time')}", "time.t_f", "s")
    nominal = [
        wide(one, 1.0, name=f"{one.head(words)}, {text('nominal')}")
        for one in (SETTLING, MAX_FORCE)
    ]
    moves = zip(before.moves, after.moves, before.optima, after.optima, strict=False)
    for number, (was, now, *optima) in enumerate(moves, start=1):
        titles = move_title(was.move, number, words), move_title(now.move, number, words)
        if titles[0] != titles[1]:
            rows.append(_change(text("move", number=number), titles, titles, words))
            continue
        prefix = f"{titles[1]}: "
        rows += _of(nominal, (was.response, now.response), words, prefix)
        rows += _of([optimal], (optima[0], optima[1]), words, prefix)
    return rows


def _loop(before: Record, after: Record, words: Catalogue) -> list[Change]:
    def worst(quantity: Quantity) -> Quantity:
        name = f"{quantity.head(words)}, {words.text('worst-corner')}"
        return wide(quantity, 1.0, name=name, value=lambda loop: shown(quantity, loop.worst_corner))

    def shown(quantity: Quantity, corner: Margins | None) -> str:
        return quantity.show(corner, words) if corner else DASH

    feedback = capitalised(words.text("has-state-feedback"))
    quantities: tuple[Quantity, ...] = (
        *(wide(gain, 1.0, name=words.name(str(gain.name))) for gain in PATH_GAINS),
        Quantity("reference-delay", "reference_delay", "s"),
        Quantity(feedback, lambda loop: bool(loop.state_feedback)),
        worst(GAIN_MARGIN),
        worst(PHASE_MARGIN),
        BANDWIDTH,
    )
    return _of(quantities, (before.loop, after.loop), words)
