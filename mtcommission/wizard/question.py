"""One question, and what a typed reply to it means."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mtcommission.base.errors import Refused
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import (
    DIGITS,
    FORCE,
    GAIN,
    INERTIA,
    MASS,
    NUMBER,
    RATIO,
    TORQUE,
    convert_to,
    parse_quantity,
)
from mtcommission.controls.kinds import KINDS
from mtcommission.controls.wording import name_control
from mtcommission.machine.readers import Range, read_path, show_key
from mtcommission.wizard.answers import profile_key

LONGEST_TEXT = 400

AT_SHAFT = {MASS: (INERTIA, 2), FORCE: (TORQUE, 1)}
"""What a mass and a force are at the motor's shaft, and the power of its turn per travel."""

_POINT = re.compile(r"(?<=[0-9])\.(?=[0-9])")


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What is asked; range, words and example are those of the profile's schema."""

    key: str  # under which the answer is kept: the profile's own, or the wizard's
    allowed: Range | None = None  # of a number; None for texts and choices
    choices: tuple[str, ...] = ()  # allowed words; empty for free input
    default: str = ""  # taken on an empty reply; "" if there is none
    example: str = ""
    is_optional: bool = False  # whether an empty reply leaves the value out
    meant: float | str | bool | None = None  # by a profile without the key, SI or a word
    instead: Question | None = None  # another quantity that may be given
    variant: str = ""  # under which the value is found elsewhere: motor held
    motor_turn: float = 0.0
    """How far the motor turns per travel of the axis [rad/m], so that inertia or torque at its
    shaft is taken for a mass or a force, too; 0: not known, or without meaning."""

    def say(self, words: Catalogue) -> str:
        """Return the question, with what an empty reply means where it may be left out."""
        key = show_key(read_path(profile_key(self.key)))
        text = self._find("", words, most=1) or words.name(key)
        if not self.is_optional or self.choices or self.meant is not None:
            return text
        return words.text("ask-or-leave-empty", text=text, meaning=self._left_out(words))

    def where(self, words: Catalogue) -> str:
        """Return where to find the value; "" where its name says it."""
        own = self.variant and self._find(f"-{self.variant}-where", words, most=1)
        return own or self._find("-where", words)

    def hint(self, default: str, words: Catalogue) -> str:
        """Return the default, or an example, in brackets."""
        if default in self.choices:
            return f" [{title(default, words)}]"
        if default:
            return f" [{self.as_shown(default, words)}]"
        example = self.as_shown(self.example, words)
        return f" ({words.text('wizard-example-behind', example=example)})" if example else ""

    def explain(self, words: Catalogue) -> str:
        """Return all that is known about the question, for ``?``."""
        lines = [self.where(words)]
        if self.allowed:
            units = words.say(self.allowed.dimension.expected)
            lines.append(f"{units[0].upper()}{units[1:]}.")
        if self.example:
            example = self.as_shown(self.example, words)
            lines.append(words.text("wizard-example-behind", example=example))
        if self.is_optional:
            lines.append(words.text("wizard-leave-out"))
        return " ".join(filter(None, lines))

    def shown_default(self, words: Catalogue) -> str:
        """Return what is taken where nobody says otherwise."""
        if self.default:
            return self.default
        if self.meant is None or self._find("-empty", words):
            return self._left_out(words)
        if isinstance(self.meant, str | bool) or self.allowed is None:
            return title(str(self.meant), words)
        if self.key.endswith("_spread"):
            return words.format.percent(self.meant)
        return words.format.quantity(self.meant, self.allowed.dimension.si)

    def as_shown(self, text: str, words: Catalogue) -> str:
        """Return a quantity with the decimal mark of the language; the profile has a point."""
        return _POINT.sub(words.format.decimal_mark, text) if self.allowed else text

    def _left_out(self, words: Catalogue) -> str:
        table = f"ask-{self.key.partition('.')[0]}-empty"
        own = self._find("-empty", words)
        return own or words.known(table, words.text("ask-left-out"))

    def _find(self, ending: str, words: Catalogue, *, most: int = 9) -> str:
        """The text for the key, or for its last words: ask-gain-empty is that of any gain."""
        parts = re.findall(r"[a-z]+", self.key)
        kinds = [f"ask-{'-'.join(parts[i:])}{ending}" for i in range(len(parts))]
        number = next((int(part) + 1 for part in self.key.split(".") if part.isdigit()), 0)
        return next((words.text(one, number=number) for one in kinds[:most] if words.has(one)), "")


def title(choice: str, words: Catalogue) -> str:
    """Return how a choice is shown; what is kept is the choice itself."""
    if choice in KINDS:
        return words.say(name_control(choice))
    slug = re.sub(r"[^a-z]+", "-", choice.lower()).strip("-")
    return words.known(f"choice-{slug}", words.known(choice, choice))


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """An accepted reply."""

    key: str  # of the question, or of what was given instead
    text: str  # as the profile will hold it: decimal point, unit added where it was left out
    taken_as: str = ""  # how a number is read that was typed without a unit, or with a comma


def read_reply(question: Question, typed: str, words: Catalogue) -> Reply:
    """Return the meaning of a reply; choices may be typed as they are shown.

    Raises
    ------
    Refused
        With what was got and what to type instead.
    """
    text = typed.strip() or question.default
    if not text:
        if question.is_optional:
            return Reply(key=question.key, text="")
        raise Refused(Message("reply-missing", example=question.example))
    if question.choices:
        shown = [title(choice, words) for choice in question.choices]
        return Reply(key=question.key, text=_choose(text, question.choices, shown))
    if not text.isprintable():
        raise Refused(Message("reply-unprintable"))
    if len(text) > LONGEST_TEXT:
        raise Refused(Message("text-too-long", length=len(text), most=LONGEST_TEXT))
    if question.allowed is None:
        return Reply(key=question.key, text=text)
    return _quantity(question, question.allowed, text)


def _choose(text: str, choices: Sequence[str], shown: Sequence[str]) -> str:
    numbers = {str(number): word for number, word in enumerate(choices, start=1)}
    if text in numbers:
        return numbers[text]
    wanted = text.lower()
    for names in (shown, choices):
        pairs = list(zip(names, choices, strict=True))
        starts = [word for name, word in pairs if name.lower().startswith(wanted)]
        exact = [word for name, word in pairs if name.lower() == wanted]
        if len(starts) == 1 or exact:
            return (exact or starts)[0]
    listed = ", ".join(f"{number} {word}" for number, word in enumerate(shown, start=1))
    raise Refused(Message("reply-no-choice", got=text, choices=listed))


def _quantity(question: Question, allowed: Range, text: str) -> Reply:
    dimension, plain = allowed.dimension, text.replace("\N{MINUS SIGN}", "-")
    digits = DIGITS.match(plain)
    if digits is not None and digits[0].count(",") == 1:
        plain = digits[0].replace(",", ".") + plain[digits.end() :]
    if at_axis := _from_shaft(question, allowed, plain):
        return replace(_quantity(question, allowed, at_axis), taken_as=at_axis)
    is_bare = NUMBER.fullmatch(plain) is not None
    plain = f"{plain} {dimension.si}".strip() if is_bare else plain
    try:
        value = allowed.number_of(plain)
    except Refused as error:
        other = question.instead
        if other is None or other.allowed is None or is_bare:
            raise
        try:
            return _quantity(other, other.allowed, plain)
        except Refused:
            raise error from None
    taken_as = plain if is_bare or plain != text else ""
    if taken_as and dimension is RATIO:
        taken_as = f"{plain} = {100.0 * value:g} %"
    elif taken_as and dimension is GAIN:
        taken_as = f"{plain} = {convert_to(value, '(m/min)/mm'):.4g} (m/min)/mm"
    return Reply(key=question.key, text=plain, taken_as=taken_as)


def _from_shaft(question: Question, allowed: Range, text: str) -> str:
    """A value that was typed for the motor's shaft, as at the axis; "" for any other."""
    dimension = allowed.dimension
    if not question.motor_turn or dimension not in AT_SHAFT or NUMBER.fullmatch(text):
        return ""
    own, power = AT_SHAFT[dimension]
    try:
        value = parse_quantity(text, own)
    except Refused:
        return ""
    return f"{value * question.motor_turn**power:.6g} {dimension.si}"
