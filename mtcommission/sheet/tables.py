"""The printing kit: what a table consists of, and the words and numbers in its cells.

A table is a list of quantities (name, where it is found in a row's item, unit) and of items; a
column is a quantity, or an item where items are set beside each other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter, itemgetter
from typing import Any

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import DIGITS
from mtcommission.record.machine import MachineEntry, Profile
from mtcommission.sheet.document import HASH_DIGITS, Cell, Column, Document, Formula, Table

DASH = "–"
TENTHS = ("dB", "°")
"""Units whose values are printed to a tenth."""


def words_for(machine: MachineEntry, language: str) -> Catalogue:
    """Return the texts of a language for an axis.

    Raises
    ------
    InputError
        If there is no such language.
    """
    if language not in LANGUAGES:
        message = Message("option-one-of", got=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
    return Catalogue(language, rotary=machine.motion == "rotary", follows=machine.follows)


def document_of(words: Catalogue, machine: MachineEntry, profile: Profile, **own: Any) -> Document:
    """Return a document about an axis; ``own``: title, created and sections."""
    return Document(
        language=words.language,
        machine=machine.name,
        axis=f"{words.text('axis')} {machine.axis}",
        identity=words.text("identity", name=profile.name, hash=profile.sha256[:HASH_DIGITS]),
        disclaimer=words.text("disclaimer"),
        **own,
    )


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity of an item of the record, and how it is printed."""

    name: str | Message  # text of the catalogue, or what stands as it is
    value: str | Callable[[Any], object]  # attribute of the item, or a function of it
    unit: str | Callable[[Any], str] | None = None
    """SI, as on a linear axis, or a function of the item; "%": a ratio; None: words, flush left."""
    missing: str = ""  # text of the catalogue where there is no value; "": a dash
    width: float = 1.0
    digits: int = 0  # 0: the usual ones

    def head(self, words: Catalogue) -> str:
        """Return the name, to stand over a column or in front of a row."""
        if isinstance(self.name, Message):
            return words.say(self.name)
        return words.known(self.name, self.name)

    def of(self, item: object) -> object:
        """Return the value [SI]."""
        return attrgetter(self.value)(item) if isinstance(self.value, str) else self.value(item)

    def within(self, part: Callable[[Any], object]) -> Quantity:
        """Return the same quantity of a part of an item."""
        return replace(self, value=lambda item: self.of(part(item)))

    def show(self, item: object, words: Catalogue) -> str:
        """Return the value as printed."""
        unit = self.unit(item) if callable(self.unit) else self.unit or ""
        return show(self.of(item), words, unit, self.missing, self.digits)

    def cell(self, item: object, words: Catalogue) -> Cell:
        """Return the value as a table holds it."""
        found = self.of(item)
        return found if isinstance(found, Formula) else self.show(item, words)


MASS = Quantity("name-moving-mass", "moving_mass", "kg")
FREQUENCY = Quantity("name-frequency", "frequency_hz", "Hz")
DAMPING = Quantity("name-damping-ratio", "damping_ratio", "%")
SETTLING = Quantity("settling-time", "settling_time", "s", "not-settled")
RESIDUAL = Quantity("residual", "residual_deviation", "m", "not-settled")
PEAK = Quantity("peak-deviation", "peak_deviation", "m")
MAX_FORCE = Quantity("max-force", "max_force", "N")
RMS_FORCE = Quantity("requirement-rms-force", "rms_force", "N")
ACCELERATION = Quantity("acceleration", "acceleration", "m/s^2")
JERK_TIME = Quantity("jerk-time", "jerk_time", "s")
CORNER = (
    Quantity("payload", "payload", "kg"),
    Quantity("frequencies", "frequency_factor", "%"),
    Quantity("dampings", "damping_factor", "%"),
)
STATE = Quantity("machine-state", lambda item: item.state or None, width=1.4)
GAIN_MARGIN = Quantity("gain-margin", "gain_margin_db", "dB", "unlimited")
PHASE_MARGIN = Quantity("phase-margin", "phase_margin_deg", "°", "unlimited")
SENSITIVITY = Quantity("sensitivity-peak", "sensitivity_peak", "", digits=3)
BANDWIDTH = Quantity("bandwidth", "bandwidth_hz", "Hz")
STIFFNESS = Quantity("dynamic-stiffness", "dynamic_stiffness", "N/m")
PATH_GAINS = (
    Quantity("Kv", "Kv", "1/s", width=1.2),
    Quantity("Kp", "Kp", "N s/m", width=1.2),
    Quantity("Tn", "Tn", "s", width=1.2),
)


def place_columns(items: Iterable[Any]) -> tuple[Quantity, ...]:
    """Return the columns that tell a corner; without payload or state where none has one."""
    items = tuple(items)
    payload, *factors = CORNER
    return (
        *([STATE] if any(item.state for item in items) else []),
        *([payload] if any(item.payload for item in items) else []),
        *factors,
    )


def show(value: Any, words: Catalogue, unit: str = "", missing: str = "", digits: int = 0) -> str:
    """Return a value as printed: a number with its unit, a message said, truth as yes or no."""
    if value is None:
        return words.text(missing) if missing else DASH
    if isinstance(value, bool):
        return words.text("yes" if value else "no")
    if isinstance(value, Message | str):
        return words.say(value)
    if unit == "%":
        return words.format.percent(value, digits=digits or 3)
    return words.format.axis(
        round(value, 1) if unit in TENTHS else value, unit, digits=digits or DIGITS
    )


def member(key: str, mapping: str = "") -> Callable[[Any], object]:
    """Return what finds an entry of an item, or of a mapping that the item has; None without it."""
    return lambda item: (attrgetter(mapping)(item) if mapping else item).get(key)


def table(
    words: Catalogue,
    caption: str,
    columns: Iterable[Quantity],
    items: Iterable[object],
    *,
    strong: Callable[[Any], object] = lambda item: False,
    **values: Any,
) -> Table:
    """Return a table with a row for each item; ``values`` are those of the caption's text.

    No ``caption``: the heading above says what is in it.
    """
    columns, items = tuple(columns), tuple(items)
    return Table(
        caption=capitalised(words.text(caption, **values)) if caption else "",
        columns=tuple(
            Column(head=one.head(words), width=one.width, is_number=one.unit is not None)
            for one in columns
        ),
        rows=tuple(tuple(one.cell(item, words) for one in columns) for item in items),
        strong_rows=tuple(place for place, item in enumerate(items) if strong(item)),
    )


def beside(
    words: Catalogue,
    caption: str,
    rows: Iterable[Quantity],
    heads: Sequence[str],
    items: Sequence[object],
    *,
    first: str = "quantity",
    width: float = 1.6,
    **values: Any,
) -> Table:
    """Return a table with a row for each quantity and a column for each item."""
    return Table(
        caption=words.text(caption, **values),
        columns=(
            Column(head=words.text(first), width=width),
            *(Column(head=head, is_number=True) for head in heads),
        ),
        rows=tuple((row.head(words), *(row.cell(item, words) for item in items)) for row in rows),
    )


def pairs(
    words: Catalogue,
    caption: str,
    rows: Iterable[tuple[str, str]],
    *,
    first: str = "quantity",
    width: float = 1.6,
    **values: Any,
) -> Table:
    """Return a table of names and what is said of them."""
    columns = Quantity(first, itemgetter(0)), Quantity("value", itemgetter(1), width=width)
    return table(words, caption, columns, rows, **values)


def capitalised(text: str) -> str:
    """Return words with a capital at the beginning and the rest as it is."""
    return text[:1].upper() + text[1:]


def say_requirement(name: str, words: Catalogue) -> str:
    """Return the text of a requirement that a record names; another name stays as it is."""
    from mtcommission.limits.requirements import read_requirement  # slow to load

    try:
        return words.say(read_requirement(name).message)
    except ValueError:
        return name
