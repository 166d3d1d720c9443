"""Message -> text: the catalogue of a language, spoken for one kind of axis.

Texts are in Fluent's format (projectfluent.org). It was chosen over gettext because a text is
found by its key instead of by an English sentence, because its places have names, and because it
calls functions: ``{ LENGTH($band) }`` says in the catalogue which unit a value has, and prints
it as µm on a linear axis and as arc seconds on a rotary one. Only the texts that are asked for are
parsed: a command needs a few dozen out of a thousand.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from fluent.runtime import FluentBundle, FluentResource
from fluent.runtime.types import FluentNone, FluentNumber, fluent_number

from mtcommission.base.messages import TEXTS
from mtcommission.base.messages.message import Message, Value, printable
from mtcommission.base.messages.quantities import Formatter, functions_of

_ENTRY = re.compile(r"^(-?[a-zA-Z][\w-]*)[ ]*=[ ]*(.*(?:\n(?:[ }].*|(?=\n)))*)", re.MULTILINE)
"""A text begins at the margin; its further lines are indented, the last may close a bracket."""

_ELEMENT = re.compile(r"(.*)\[(\d+)\](\..*)")
"""Table, number and key of an element of an array."""

_SYMBOLS = {"position_gain": "Kv", "velocity_gain": "Kp", "integral_time": "Tn"}
"""Keys of the profile that are named by the symbols of the gains."""

_NO_WORD = re.compile(r"[^a-zA-Z0-9]+")
_REFERENCE = re.compile(r"\{\s*(-?[a-z][\w-]*)")


NAME = "name"
"""Kind of the message that is the name of a ``key`` of the profile."""

LONGEST = 2000
"""Letters of a part of a text; Fluent refuses 2500."""


class Catalogue:
    """The texts of one language for one kind of axis; raise KeyError if there is no such language.

    ``rotary``: torque for force, degrees for metres; ``follows``: acceleration for force.
    """

    def __init__(
        self, language: str = "en", *, rotary: bool = False, follows: bool = False
    ) -> None:
        self.language, self.rotary, self.follows = language, rotary, follows
        self.format = Formatter(
            rotary=rotary, decimal_mark=decimal_mark_of(language), follows=follows
        )
        self._bundle, self._loaded = _texts_of(language, rotary, follows)

    def say(self, message: Message | str) -> str:
        """Return the text of a message; one of the user's own stays as it is.

        Raises KeyError: the catalogue has no such kind. Raises ValueError: the text asks for a
        value that the message lacks, or for one of another type.

        Examples
        --------
        >>> Catalogue("de").say(Message("requirement-settling-time"))
        'Einschwingzeit'
        """
        if isinstance(message, str):
            return message
        if message.kind == NAME:
            return self.name(str(message.values["key"]))
        return self.text(message.kind, **message.values)

    def text(self, kind: str, /, **values: Value) -> str:
        """Return the text of a kind with values, as ``say`` does; ``KIND.PART`` is a part of it."""
        entry, _, part = kind.partition(".")
        source = entries_of(self.language)[entry]
        if not set("{\n") & set(source):
            return source  # most need no parser
        self._load(entry)
        found = self._bundle.get_message(entry)
        pattern = found.attributes.get(part) if part else found.value
        if pattern is None:
            raise KeyError(kind)
        axis = "open-loop" if self.follows else "rotary" if self.rotary else "linear"
        spoken = {name: self._spoken(value) for name, value in values.items()}
        text, faults = self._bundle.format_pattern(pattern, {**spoken, "axis": axis})
        if faults:
            raise ValueError(f"{self.language}: {kind}: {faults[0]}")
        return str(text)

    def known(self, kind: str, otherwise: str) -> str:
        """Return the text of a kind, or another one where the catalogue has no such kind."""
        return self.text(kind) if self.has(kind) else otherwise

    def own(self, scope: str, key: str, **values: Value) -> str:
        """Return the text that a page or table has of its own for a key, or that of all others."""
        kind = f"{scope}-{key}"
        return self.text(kind if self.has(kind) else key, **values)

    def name(self, key: str) -> str:
        """Return the name of a state, an output or a key of the profile as messages spell it."""
        element = _ELEMENT.search(key)
        if element:
            name = self.name(f"{element[1]}{element[3]}")
            if element[1].endswith("modes"):
                return self.text("of-mode", name=name, mode=element[2])
            return f"{self.text('move', number=element[2])}: {name}"
        whole = f"name-{_NO_WORD.sub('-', key).strip('-')}"
        if "." in key and self.has(whole):
            return self.text(whole)
        last = key.rpartition(".")[2]
        last = _SYMBOLS.get(last, last)
        kind = f"name-{_NO_WORD.sub('-', last).strip('-')}"
        coordinate, _, mode = last.partition("_")
        form = {"q": "mode-deflection", "v": "mode-rate"}.get(coordinate)
        return self.known(kind, self.text(form, mode=mode) if form and mode else last)

    def has(self, kind: str) -> bool:
        """Return whether there is a text of this kind, or a part of one."""
        entry, _, part = kind.partition(".")
        source = entries_of(self.language).get(entry)
        return source is not None and (not part or f" .{part} = " in source)

    def _spoken(self, value: Value) -> float | str | FluentNumber | FluentNone:
        """A value as Fluent takes it; messages inside are said, several joined by commas."""
        if isinstance(value, Message):
            return _shortened(self.say(value))
        if isinstance(value, tuple):
            return _shortened(", ".join(str(self._spoken(inner)) for inner in value))
        if isinstance(value, int):
            return fluent_number(value, useGrouping=False)
        if isinstance(value, str):
            return _shortened(printable(value))
        return "" if value is None else value

    def _load(self, kind: str) -> None:
        """Parse a text and those that it refers to."""
        waiting = [kind]
        while waiting:
            name = waiting.pop()
            if name in self._loaded:
                continue
            known = entries_of(self.language)
            self._bundle.add_resource(FluentResource(f"{name} = {known[name]}"))
            self._loaded.add(name)
            waiting += [other for other in _REFERENCE.findall(known[name]) if other in known]


def _shortened(text: str) -> str:
    """A part of a text as long as Fluent takes it, e.g. of a column's name of a whole page."""
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}…"


@cache
def _texts_of(language: str, rotary: bool, follows: bool) -> tuple[FluentBundle, set[str]]:
    """The texts parsed so far, and their keys; every catalogue of this kind shares them."""
    form = Formatter(rotary=rotary, decimal_mark=decimal_mark_of(language), follows=follows)
    functions = functions_of(form)
    return FluentBundle([language], functions=functions, use_isolating=False), set()


def decimal_mark_of(language: str) -> str:
    """Return the sign before the decimals of a number in a sentence."""
    return entries_of(language)["decimal-mark"]


@cache
def entries_of(language: str) -> Mapping[str, str]:
    """Return each text of a language by its key, unparsed."""
    found: dict[str, str] = {}
    for path in sorted((TEXTS / language).glob("*.ftl")):
        entries = _ENTRY.findall(path.read_text(encoding="utf-8"))
        found.update((key, text.strip()) for key, text in entries)
    return MappingProxyType(found)
