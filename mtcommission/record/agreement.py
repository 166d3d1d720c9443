"""What the entries of a record must have in common, beyond the form of each.

A record that was changed by hand or by another program and sealed again has the right forms, but
e.g. a series with fewer values than instants. Every printer would meet that somewhere inside.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from math import isfinite
from pathlib import Path

from mtcommission.errors import Fault, InputError, MtcommissionError
from mtcommission.messages.message import Message
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Series
from mtcommission.record.vocabulary import (
    find_missing_names,
    find_too_small,
    find_unknown_words,
    walk,
)

FOREIGN = (ArithmeticError, LookupError, ValueError)
"""What numbers that cannot be raise; anything else is a fault of ours, and ends as one."""

SHOWN = 160
"""Characters of such an error that a message shows."""


@contextmanager
def trusting(path: Path) -> Iterator[None]:
    """Translate what a record causes that contradicts itself in a way nobody looks for.

    Parameters
    ----------
    path
        Of the record, for the message.

    Raises
    ------
    InputError
        In place of the foreign error, whose text it tells.
    """
    try:
        yield
    except MtcommissionError:
        raise
    except FOREIGN as error:
        why = f"{type(error).__name__}: {error}"[:SHOWN]
        message = Message("record-contradicts", why=why)
        raise InputError([Fault(where=str(path), message=message)]) from error


def find_contradictions(record: Record) -> Iterator[Message]:
    """Yield each place at which entries of a record do not belong together.

    Parameters
    ----------
    record
        Of the right form.

    Yields
    ------
    Message
        The key, and what is wrong there.
    """
    yield from find_unknown_words(record)
    yield from find_missing_names(record)
    yield from find_too_small(record)
    for key, entries in _needed(record):
        if not entries:
            yield Message("record-empty", key=key)
    for key, lengths in _alike(record):
        if len(set(lengths)) > 1:
            counts = ", ".join(map(str, sorted(set(lengths))))
            yield Message("record-lengths-differ", key=key, counts=counts)
    for key, entry in walk("", record):
        # A motor that follows has no disturbance and no Bode plot: these series are empty.
        if isinstance(entry, Series) and not (record.machine.follows and not entry.t):
            steps = [after - before for before, after in pairwise(entry.t)]
            if not steps or not all(step >= 0.0 and isfinite(step) for step in steps):
                yield Message("record-times-fall", key=f"{key}.t")


def _needed(record: Record) -> Iterator[tuple[str, Sequence[object]]]:
    """Key and entries of what must not be empty."""
    yield "data", record.data
    yield "moves", record.moves
    yield "plant.states", record.plant.states
    yield "limits.landscape.acceleration", record.limits.landscape.acceleration
    yield "limits.landscape.jerk_time", record.limits.landscape.jerk_time
    for i, move in enumerate(record.moves, start=1):
        yield f"moves[{i}].corners", move.corners
    if record.what_if:
        yield "what_if.limits", record.what_if.limits
        yield "what_if.corners", record.what_if.corners
        yield "what_if.plant.signals", record.what_if.plant.signals


def _alike(record: Record) -> Iterator[tuple[str, Sequence[int]]]:
    """Key and lengths of what must be equally long."""
    plant, loop, limits = record.plant, record.loop, record.limits
    n = len(plant.states)
    yield "plant.A", [n, len(plant.A), len(plant.B), *map(len, plant.A)]
    yield "plant.outputs", [n, *map(len, plant.outputs.values())]
    closed = loop.closed_loop
    yield "loop.closed_loop.A", [len(closed.states), len(closed.A), *map(len, closed.A)]
    yield "loop.closed_loop.B", [len(closed.states), len(closed.B)]
    yield "loop.closed_loop.C", [len(closed.states), *map(len, closed.C)]
    yield "loop.closed_loop.outputs", [len(closed.outputs), len(closed.C), len(closed.D)]
    yield "loop.closed_loop.inputs", [len(closed.inputs), *map(len, (*closed.B, *closed.D))]
    observer = loop.observer
    yield "loop.observer.A", [len(observer.states), len(observer.A), *map(len, observer.A)]
    yield "loop.observer.C", [len(observer.states), *map(len, observer.C)]
    yield "loop.observer.L", [len(observer.states), len(observer.B), len(observer.L)]
    yield "moves", [len(record.moves), len(record.optima), len(record.comparisons)]
    yield "limits.recommended.valid_for", [len(record.moves), len(limits.recommended.valid_for)]
    if record.what_if:
        yield "what_if.moves", [len(record.moves), len(record.what_if.moves)]
    seen = limits.landscape
    rows, columns = len(seen.acceleration), len(seen.jerk_time)
    for name in ("settling_time", "residual_deviation", "usage"):
        values = getattr(seen, name)
        yield f"limits.landscape.{name}", [rows, len(values)]
        yield f"limits.landscape.{name}", [columns, *map(len, values)]
    for i, item in enumerate(limits.move_sizes, start=1):
        counts = [len(item.size), len(item.settling_time), len(item.residual_deviation)]
        yield f"limits.move_sizes[{i}]", counts
    error = record.robustness.frequency_error
    counts = [len(error.factor), len(error.settling_time), len(error.residual_deviation)]
    yield "robustness.frequency_error", counts
    for key, entry in walk("", record):
        if isinstance(entry, Series):
            yield key, [len(entry.t), *map(len, entry.signals.values())]
