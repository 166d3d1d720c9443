"""Message -> text: the catalogue of a language, spoken for one kind of axis.

Texts are in Fluent's format (projectfluent.org). It was chosen over gettext because a text is
found by its key instead of by an English sentence, because its places have names, and because it
calls functions: ``{ LENGTH($band) }`` says in the catalogue which unit a value has, and prints
it as µm on a linear axis and as arc seconds on a rotary one. Only the texts that are asked for are
parsed: a command needs a few dozen out of a thousand.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache, cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any

from fluent.runtime import FluentBundle, FluentResource
from fluent.runtime.types import FluentNone, FluentNumber, fluent_number

from mtcommission.messages.message import Message, Value
from mtcommission.messages.quantities import DIGITS, Formatter, symbol

TEXTS = Path(__file__).with_name("texts")

LANGUAGES: Mapping[str, str] = MappingProxyType({"en": ".", "de": ","})
"""Languages there are, and their decimal marks."""

UNITS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "LENGTH": ("m", "rad"),
        "VELOCITY": ("m/s", "rad/s"),
        "ACCELERATION": ("m/s^2", "rad/s^2"),
        "JERK": ("m/s^3", "rad/s^3"),
        "FORCE": ("N", "N m"),
        "MASS": ("kg", "kg m^2"),
        "STIFFNESS": ("N/m", "N m/rad"),
        "DAMPING": ("N s/m", "N m s/rad"),
        "COMPLIANCE": ("m/N", "rad/(N m)"),
        "GAIN": ("1/kg", "1/(kg m^2)"),
        "TIME": ("s", "s"),
        "FREQUENCY": ("Hz", "Hz"),
        "RATE": ("1/s", "1/s"),
        "DECIBEL": ("dB", "dB"),
        "DEGREE": ("°", "°"),
    }
)
"""Functions of the texts for quantities: SI unit on a linear axis and on a rotary one."""

PER_SI: Mapping[str, float] = MappingProxyType({"": 1.0, "ms": 1e3, "us": 1e6, "%": 100.0})
"""Units in which a text may ask for a plain number, and how many make one of SI."""

_ENTRY = re.compile(r"^(-?[a-zA-Z][\w-]*)[ ]*=", re.MULTILINE)
_NO_WORD = re.compile(r"[^a-zA-Z0-9]+")
_REFERENCE = re.compile(r"\{\s*(-?[a-z][\w-]*)")


class Catalogue:
    """The texts of one language for one kind of axis.

    Parameters
    ----------
    language
        One of ``LANGUAGES``.
    rotary
        Whether the axis turns: torque for force, degrees for metres.

    Raises
    ------
    KeyError
        There is no such language.
    """

    def __init__(self, language: str = "en", *, rotary: bool = False) -> None:
        self.language, self.rotary = language, rotary
        self.format = Formatter(rotary=rotary, decimal_mark=LANGUAGES[language])

    def say(self, message: Message | str) -> str:
        """Return the text of a message; one of the user's own stays as it is.

        Raises
        ------
        KeyError
            The catalogue has no such kind.
        ValueError
            The text asks for a value that the message lacks, or for one of another type.

        Examples
        --------
        >>> Catalogue("de").say(Message("requirement-settling-time"))
        'Einschwingzeit'
        """
        if isinstance(message, str):
            from mtcommission.sheet.phrases import say  # until the record holds messages

            return say(message, self)
        return self.text(message.kind, **message.values)

    def text(self, kind: str, /, **values: Value) -> str:
        """Return the text of a kind with values, as ``say`` does.

        Examples
        --------
        >>> Catalogue("en", rotary=True).text("requirement-rms-force")
        'RMS torque'
        """
        self._load(kind)
        found = self._bundle.get_message(kind)
        if found.value is None:
            raise KeyError(kind)
        axis = "rotary" if self.rotary else "linear"
        spoken = {name: self._spoken(value) for name, value in values.items()}
        text, faults = self._bundle.format_pattern(found.value, {**spoken, "axis": axis})
        if faults:
            raise ValueError(f"{self.language}: {kind}: {faults[0]}")
        return str(text)

    def known(self, kind: str, otherwise: str) -> str:
        """Return the text of a kind, or another one where the catalogue has no such kind."""
        return self.text(kind) if self.has(kind) else otherwise

    def name(self, key: str) -> str:
        """Return the name of a state, an output or a dotted key of the profile.

        Examples
        --------
        >>> words = Catalogue()
        >>> words.name("plant.base_mass"), words.name("v_phi"), words.name("q_column")
        ('Base mass', 'Tower rotation rate v_φ', 'Deflection of mode column')
        """
        last = key.rpartition(".")[2]
        kind = f"name-{_NO_WORD.sub('-', last).strip('-')}"
        coordinate, _, mode = last.partition("_")
        form = {"q": "mode-deflection", "v": "mode-rate"}.get(coordinate)
        return self.known(kind, self.text(form, mode=mode) if form and mode else last)

    def plain(self, value: float, digits: int, style: str) -> str:
        """Return a number as Python's format prints it, with the language's decimal mark.

        Examples
        --------
        >>> Catalogue("de").plain(1.25, 1, "e")
        '1,2e+00'
        """
        return f"{value:.{digits}{style}}".replace(".", self.format.decimal_mark)

    def has(self, kind: str) -> bool:
        """Return whether there is a text of this kind."""
        return kind in entries_of(self.language)

    @cached_property
    def _loaded(self) -> set[str]:
        return set()

    @cached_property
    def _bundle(self) -> FluentBundle:
        functions: dict[str, Callable[..., Any]] = {
            name: self._quantity(units[self.rotary]) for name, units in UNITS.items()
        }
        functions |= {
            "QUANTITY": lambda value, unit: self.format.quantity(_number(value), str(unit)),
            "NUMBER": lambda value, digits=4: self.format.number(
                _number(value) or 0.0, digits=int(digits)
            ),
            "PLAIN": self._plain,
            "SI": lambda value, quantity, digits=4: (
                f"{self._plain(value, digits)} {UNITS[str(quantity)][self.rotary]}"
            ),
            "SHARE": lambda value, digits=3: self.format.percent_if_known(
                _number(value), digits=int(digits)
            ),
            "CHANGE": lambda value: self.format.signed_percent(_number(value) or 0.0),
            "SYMBOL": lambda name: symbol(str(name)),
        }
        return FluentBundle([self.language], functions=functions, use_isolating=False)

    def _quantity(self, unit: str) -> Callable[..., str]:
        return lambda value, digits=DIGITS: self.format.quantity(
            _number(value), unit, digits=int(digits)
        )

    def _plain(
        self, value: object, digits: object = DIGITS, unit: str = "", style: object = "g"
    ) -> str:
        """A number as people type it, in a unit that the text writes."""
        number = PER_SI[unit] * (_number(value) or 0.0)
        return self.plain(number, int(str(digits)), str(style))

    def _spoken(self, value: Value) -> float | str | FluentNumber | FluentNone:
        """A value as Fluent takes it; messages inside are said, several joined by commas."""
        if isinstance(value, Message):
            return self.say(value)
        if isinstance(value, tuple):
            return ", ".join(str(self._spoken(inner)) for inner in value)
        if isinstance(value, int):
            return fluent_number(value, useGrouping=False)
        return "" if value is None else value

    def _load(self, kind: str) -> None:
        """Parse a text and those that it refers to."""
        waiting = [kind]
        while waiting:
            name = waiting.pop()
            if name in self._loaded:
                continue
            source = entries_of(self.language)[name]
            self._bundle.add_resource(FluentResource(source))
            self._loaded.add(name)
            known = entries_of(self.language)
            waiting += [other for other in _REFERENCE.findall(source) if other in known]


@cache
def entries_of(language: str) -> Mapping[str, str]:
    """Return the source of each text of a language, by its key, unparsed."""
    found: dict[str, str] = {}
    for path in sorted((TEXTS / language).glob("*.ftl")):
        found.update(_split(path.read_text(encoding="utf-8")))
    return MappingProxyType(found)


def _split(source: str) -> Iterator[tuple[str, str]]:
    """The entries of a file: each begins at the margin, its further lines are indented."""
    starts = [(match.start(), match[1]) for match in _ENTRY.finditer(source)]
    ends = [start for start, _ in starts[1:]] + [len(source)]
    for (start, key), end in zip(starts, ends, strict=True):
        yield key, source[start:end]


def _number(value: object) -> float | None:
    """A number as Fluent hands it over; an empty text stands for one that is not known."""
    return None if value == "" else float(value)  # type: ignore[arg-type]
