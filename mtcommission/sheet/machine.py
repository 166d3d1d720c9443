"""Appendix: machine and axis data, modes, moves and requirements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.machine import Datum, ModeEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.basis import datum, datum_name
from mtcommission.sheet.document import Block, Table, note
from mtcommission.sheet.tables import Quantity, pairs, show, table

REQUIRED = ("requirements.", "moves")
"""Beginnings of the keys that say what is required, not what the machine is."""

LONGEST_SOURCE = 28
"""Letters of a source that fits into its column; a longer one stands once, with a number."""


def machine_data(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the machine's data with their sources, and its modes."""
    text, machine, plant = words.text, record.machine, record.plant
    numbers = _numbers(record)
    rank = text("of-states", rank=plant.controllability_rank, count=len(plant.states))
    rows = (
        (text("machine-row"), machine.name),
        (text("axis-row"), machine.axis),
        (text("motion-row"), text("rotary" if words.rotary else "linear")),
        (text("source"), _numbered(machine.source, numbers)),
        (text("name-moving-mass"), show(plant.moving_mass, words, "kg")),
        (text("controllability"), rank),
    )
    data = [item for item in record.data if not item.key.startswith(REQUIRED)]
    yield pairs(words, text("rigid-caption"), rows, width=2.0)
    yield _data(record, "data-caption", data, words)
    for source in numbers:
        if source != machine.source:
            yield note(_numbered(source, numbers))
    yield _modes(record, words)


def requirements(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the moves and what is required of them."""
    data = [item for item in record.data if item.key.startswith(REQUIRED)]
    yield _data(record, "requirements-caption", data, words)


def _numbers(record: Record) -> dict[str, str]:
    """The sources too long to be repeated in each row, and their numbers."""
    named = [record.machine.source, *(item.source for item in record.data)]
    users = [source for source in dict.fromkeys(named) if isinstance(source, str)]
    longer = (source for source in users if len(source) > LONGEST_SOURCE)
    return {source: f"[{number}]" for number, source in enumerate(longer, start=1)}


def _numbered(source: str, numbers: dict[str, str]) -> str:
    return f"{numbers[source]} {source}" if source in numbers else source


def _data(record: Record, caption: str, data: Iterable[Datum], words: Catalogue) -> Table:
    numbers, units = _numbers(record), record.plant.units

    def cited(item: Datum) -> Words:
        return (
            numbers.get(item.source, item.source) if isinstance(item.source, str) else item.source
        )

    columns = (
        Quantity("quantity", lambda item: datum_name(item, words), width=1.3),
        Quantity("value", lambda item: datum(item, units, words), "", width=0.8),
        Quantity("key", "key", width=1.5),
        Quantity("source", cited, width=1.1),
    )
    return table(words, caption, columns, data)


def _modes(record: Record, words: Catalogue) -> Table:
    def share(mode: ModeEntry) -> float:
        # Below a motor that follows, q hangs back: the plant has -q for its F.
        return -mode.tcp_gain if words.follows else mode.tcp_gain

    columns = (
        Quantity("mode", "name", width=1.4),
        Quantity("frequency", "frequency_hz", "Hz"),
        Quantity("damping-ratio", "damping_ratio", "%"),
        Quantity("name-tcp-gain", share, "1/kg"),
        Quantity("name-measured-gain", "measured_gain", "1/kg"),
    )
    return table(words, "modes-caption", columns, record.plant.modes)
