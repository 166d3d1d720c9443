"""What a field of the record must keep beyond its form: rules behind its type, in ``Annotated``.

A record that was changed by hand or by another program and sealed again has the right forms, but
e.g. a series with fewer values than instants. Every printer would meet that somewhere inside.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

from mtcommission.messages.message import Message

LEAST = 1e-30
"""Of what something is divided by: far below what a run writes, far above what overflows."""

LONGEST_SYMBOL = 40
"""Characters of a unit."""

SIZES = ("velocity_step", "distance")
"""One of them says what a move is."""


@dataclass(frozen=True, slots=True)
class Place:
    """A value in a record: its key, the entry that holds it, and the record."""

    key: str
    value: Any
    entry: Any
    record: Any

    @property
    def names(self) -> tuple[str, Iterable[str]]:
        """Key and names of a mapping, or of a series' signals."""
        if isinstance(self.value, Mapping):
            return self.key, self.value
        return f"{self.key}.signals", self.value.signals


Rule: TypeAlias = Callable[[Place], Iterator[Message]]
"""Yields what is wrong."""


def one_of(*words: str, registered: Collection[str] = ()) -> Rule:
    """Return the rule that a word, or each name in a mapping or a series, is one of some.

    ``registered``: words to which some may be added later.
    """

    def check(at: Place) -> Iterator[Message]:
        key, found = (at.key, [at.value]) if isinstance(at.value, str) else at.names
        for got in found:
            if got not in (known := (*words, *registered)):
                yield Message("record-word-unknown", key=key, got=got, words=", ".join(known))

    return check


def at_least(least: float) -> Rule:
    """Return the rule that a number, or each of an array, is not smaller."""

    def check(at: Place) -> Iterator[Message]:
        got = min(at.value, default=least) if isinstance(at.value, list) else at.value
        if not got >= least:
            yield Message("record-too-small", key=at.key, got=got, least=least)

    return check


above_zero = at_least(LEAST)


def short(at: Place) -> Iterator[Message]:
    """Yield a mapping with a text that is too long for a symbol."""
    if any(len(text) > LONGEST_SYMBOL for text in at.value.values()):
        yield Message("record-text-too-long", key=at.key, most=LONGEST_SYMBOL)


def filled(at: Place) -> Iterator[Message]:
    """Yield an array that is empty."""
    if not at.value:
        yield Message("record-empty", key=at.key)


def long(*axes: str) -> Rule:
    """Return the rule that an array is as long as others of its entry, an axis each.

    ``""``: of any length; ``"/moves"``: as long as that array of the record.
    """

    def lengths(at: Place, value: Any, left: Sequence[str]) -> Iterator[tuple[int, int]]:
        if not left:
            return
        axis, *further = left
        if axis:
            other = getattr(at.record, axis[1:]) if axis[0] == "/" else getattr(at.entry, axis)
            yield len(value), len(other)
        for inner in value.values() if isinstance(value, Mapping) else value:
            yield from lengths(at, inner, further)

    def check(at: Place) -> Iterator[Message]:
        counts = {
            count for pair in lengths(at, at.value, axes) if pair[0] != pair[1] for count in pair
        }
        if counts:
            shown = ", ".join(map(str, sorted(counts)))
            yield Message("record-lengths-differ", key=at.key, counts=shown)

    return check


def found_in(names: Callable[[Any], Sequence[str]]) -> Rule:
    """Return the rule that a word is one of some names that the record holds elsewhere."""

    def check(at: Place) -> Iterator[Message]:
        yield from one_of(*names(at.record))(at)

    return check


def named(names: Callable[[Any], Sequence[str]]) -> Rule:
    """Return the rule that a mapping, or a series, has some names at least."""

    def check(at: Place) -> Iterator[Message]:
        key, found = at.names
        missing = [name for name in names(at.record) if name not in found]
        if missing:
            yield Message("record-names-missing", key=key, names=", ".join(missing))

    return check


def rising(at: Place) -> Iterator[Message]:
    """Yield instants that fall; where the motor follows there may be none."""
    steps = [after - before for before, after in pairwise(at.value)]
    is_missing = at.record.machine.follows and not at.value
    if not is_missing and (not steps or not all(step >= 0.0 for step in steps)):
        yield Message("record-times-fall", key=at.key)


def of_one_size(at: Place) -> Iterator[Message]:
    """Yield a move, or each of some, whose size is not said by exactly one key."""
    moves = [at.value] if isinstance(at.value, Mapping) else at.value
    for number, move in enumerate(moves, start=1):
        if sum(name in move for name in SIZES) != 1:
            key = at.key if move is at.value else f"{at.key}[{number}]"
            yield Message("record-move-of-no-size", key=key)
