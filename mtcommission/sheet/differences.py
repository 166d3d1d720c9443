"""What changed between two records: machine and requirements, limits, result, loop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.record.loop import Margins
from mtcommission.record.machine import Datum, datum, datum_name
from mtcommission.record.record import Record
from mtcommission.sheet.document import Block, Paragraph, note
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
    yield note(
        words.text(
            "compared-with",
            machine=before.machine.name,
            axis_name=before.machine.axis,
            created=before.created,
            name=before.profile.name,
            hash=before.profile.sha256,
        )
    )
    limits = [ACCELERATION, Quantity("jerk", "jerk", "m/s^3"), JERK_TIME]
    limits.append(Quantity("bound-by-column", "bound_by"))
    recommended = before.limits.recommended, after.limits.recommended
    inputs = list(_inputs(before, after, words))
    if not inputs:
        yield Paragraph(text=words.text("no-changed-inputs"))
    outcome = [
        *_of(limits, recommended, words),
        *_result(before, after, words),
        *_loop(before, after, words),
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


def _of(
    quantities: Iterable[Quantity], both: tuple[object, object], words: Catalogue, prefix: str = ""
) -> Iterator[Change]:
    """The changes of some quantities of two items."""
    for one in quantities:
        values = one.of(both[0]), one.of(both[1])
        shown = one.show(both[0], words), one.show(both[1], words)
        yield from _change(prefix + one.head(words), values, shown, words)


def _change(
    name: str, values: tuple[object, object], shown: tuple[str, str], words: Catalogue
) -> Iterator[Change]:
    """The change of a value, if there is one."""
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
    machine = [Quantity(*one) for one in named.items()]
    yield from _of(machine, (before.machine, after.machine), words)
    old, new = ({item.key: item for item in record.data} for record in (before, after))
    # In the order of the sheet, then what has gone.
    for key, item in (new | {key: item for key, item in old.items() if key not in new}).items():
        both = old.get(key), new.get(key)
        shown = _datum(both[0], before, words), _datum(both[1], after, words)
        values = tuple(one and one.value for one in both)
        yield from _change(datum_name(item, words), (values[0], values[1]), shown, words)
    yield from _of([Quantity("version", "version")], (before.tool, after.tool), words)


def _datum(item: Datum | None, record: Record, words: Catalogue) -> str:
    return words.text("not-stated") if item is None else datum(item, record.plant.units, words)


def _result(before: Record, after: Record, words: Catalogue) -> Iterator[Change]:
    text = words.text
    verdict = before.assessment, after.assessment
    yield from _of([Quantity("verdict-met", "met")], verdict, words)
    recommended = before.limits.recommended, after.limits.recommended
    yield from _of([SETTLING, RESIDUAL, PEAK], recommended, words)
    optimal = Quantity(f"{text('control-time-optimal')}, {text('final-time')}", "time.t_f", "s")
    nominal = [
        wide(one, 1.0, name=f"{one.head(words)}, {text('nominal')}")
        for one in (SETTLING, MAX_FORCE)
    ]
    moves = zip(before.moves, after.moves, before.optima, after.optima, strict=False)
    for number, (was, now, *optima) in enumerate(moves, start=1):
        titles = move_title(was.move, number, words), move_title(now.move, number, words)
        if titles[0] != titles[1]:
            yield from _change(text("move", number=number), titles, titles, words)
            continue
        prefix = f"{titles[1]}: "
        yield from _of(nominal, (was.response, now.response), words, prefix)
        yield from _of([optimal], (optima[0], optima[1]), words, prefix)


def _loop(before: Record, after: Record, words: Catalogue) -> Iterator[Change]:
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
