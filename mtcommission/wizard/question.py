"""One question, and what a typed reply to it means."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from mtcommission.control_kinds.kinds import KINDS
from mtcommission.errors import Refused
from mtcommission.messages.message import Message
from mtcommission.units.quantities import (
    DIGITS,
    FORCE,
    GAIN,
    INERTIA,
    MASS,
    NUMBER,
    RATIO,
    TORQUE,
    Dimension,
    convert_to,
    parse_quantity,
)

Answers = Mapping[str, str]
"""What was typed, by dotted key: the profile's own keys, or the wizard's beside them."""

LONGEST_TEXT = 400

ACCEPTED = "wizard.accepted"
"""Key of the answers under which those stand, with blanks between, that are only defaults: the
profile must not credit them to anybody's data sheet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """What is asked.

    Parameters
    ----------
    key
        Dotted key under which the answer is kept.
    dimension
        What a number must measure; None for texts and choices.
    choices
        Allowed words; empty for free input.
    default
        Taken on an empty reply; "" if there is none.
    example
        Shown where there is no default.
    low, high
        Plausible range [SI]; outside it a warning is given. Where it has no negative part,
        negative values are refused.
    is_optional
        Whether an empty reply leaves the value out.
    motor_turn
        How far the motor turns per travel [rad/m], so that inertia or torque at its shaft is taken
        for a mass or a force, too; 0: not known, or without meaning.
    measured
        Under which circumstances the value is found, where that changes where to look; ""
        otherwise.
    """

    key: str
    dimension: Dimension | None = None
    choices: tuple[str, ...] = ()
    default: str = ""
    example: str = ""
    low: float = -inf
    high: float = inf
    is_optional: bool = False
    motor_turn: float = 0.0
    measured: str = ""

    @property
    def decides(self) -> bool:
        """Whether its default, where it was only accepted, is an assumption."""
        return self.dimension is not None or self.key == "control.kind"

    @property
    def plain(self) -> Message:
        """The question, one line."""
        return self._message("")

    @property
    def text(self) -> Message:
        """The question, with what an empty reply means where it may be left out."""
        if not self.is_optional:
            return self.plain
        return Message("ask-or-leave-empty", text=self.plain, meaning=self._message("-empty"))

    @property
    def where(self) -> Message:
        """Where to find the value."""
        return self._message(f"-{self.measured}-where" if self.measured else "-where")

    def _message(self, ending: str) -> Message:
        """A text of the catalogue, by the key without the numbers of elements."""
        parts = self.key.split(".")
        number = next((int(part) + 1 for part in parts if part.isdigit()), 0)
        words = [part for part in parts if not part.isdigit()]
        if len(words) > 2:  # below a table of signals the last part is one of them
            words = words if words[1] == "modes" else words[:2]
        kind = "-".join(words).replace("_", "-")
        check = "-check" if self.key == "pair.stiffness" and self.is_optional else ""
        return Message(f"ask-{kind}{check}{ending}", number=number, name=parts[-1])


def title(choice: str) -> Message:
    """Return how a choice is shown; what is kept is the choice itself."""
    return Message(f"control-kind-{choice}" if choice in KINDS else f"choice-{slug(choice)}")


def slug(choice: str) -> str:
    """Return a choice as part of a key of the catalogue."""
    return re.sub(r"[^a-z]+", "-", choice.lower()).strip("-")


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """An accepted reply.

    Parameters
    ----------
    text
        As the profile will hold it: decimal point, unit added where it was left out.
    warning
        What is unusual about it; None if nothing is.
    taken_as
        How a number is read that was typed without a unit, or with a comma; "" for any other.
    """

    text: str
    warning: Message | None = None
    taken_as: str = ""


def read_reply(question: Question, typed: str, *, titles: Sequence[str] = ()) -> Reply:
    """Return the meaning of a reply.

    Parameters
    ----------
    question
        What was asked.
    typed
        What was typed, not a command.
    titles
        The choices as they were shown, if that was in another language.

    Raises
    ------
    Refused
        With what was got and what to type instead.

    Examples
    --------
    >>> from mtcommission.units.quantities import STIFFNESS
    >>> reply = read_reply(Question(key="k", dimension=STIFFNESS), "44,41")
    >>> reply.text, reply.taken_as
    ('44.41 N/m', '44.41 N/m')
    """
    text = typed.strip() or question.default
    if not text:
        if question.is_optional:
            return Reply(text="")
        kind = "reply-missing-example" if question.example else "reply-missing"
        raise Refused(Message(kind, example=question.example))
    if question.choices:
        return Reply(text=_choose(text, question.choices, titles or question.choices))
    if question.dimension is None:
        return Reply(text=_free_text(text))
    return _quantity(question, question.dimension, text)


def _choose(text: str, choices: Sequence[str], titles: Sequence[str]) -> str:
    numbers = {str(number): word for number, word in enumerate(choices, start=1)}
    if text in numbers:
        return numbers[text]
    wanted = text.lower()
    for shown in (titles, choices):
        pairs = list(zip(shown, choices, strict=True))
        starts = [word for title, word in pairs if title.lower().startswith(wanted)]
        exact = [word for title, word in pairs if title.lower() == wanted]
        if len(starts) == 1 or exact:
            return (exact or starts)[0]
    listed = ", ".join(f"{number} {word}" for number, word in enumerate(titles, start=1))
    raise Refused(Message("reply-no-choice", got=text, choices=listed))


def _free_text(text: str) -> str:
    if not text.isprintable():
        raise Refused(Message("reply-unprintable"))
    if len(text) > LONGEST_TEXT:
        raise Refused(Message("reply-too-long", length=len(text), most=LONGEST_TEXT))
    return text


def _quantity(question: Question, dimension: Dimension, text: str) -> Reply:
    at_shaft = _from_shaft(question, dimension, text)
    if at_shaft:
        return replace(_quantity(question, dimension, at_shaft), taken_as=at_shaft)
    value = parse_quantity(text, dimension, decimal_comma=True)
    plain = text.replace("\t", " ").strip().replace("\N{MINUS SIGN}", "-")
    digits = DIGITS.match(plain)
    if digits is not None:
        plain = digits[0].replace(",", ".") + plain[digits.end() :]
    is_bare = NUMBER.fullmatch(plain) is not None
    if is_bare and dimension.si:
        plain = f"{plain} {dimension.si}"
    unit = f" {dimension.si}" if dimension.si else ""
    if question.low >= 0.0 and (value < 0.0 or (value == 0.0 and question.low > 0.0)):
        kind = "reply-not-positive" if question.low > 0.0 else "reply-negative"
        raise Refused(Message(kind, got=plain, unit=unit))
    if dimension is RATIO and question.high <= 1.0 <= abs(value):
        percent = Message("reply-percent-is", percent=f"{100.0 * value:g}")
        meant = Message("reply-percent-meant", meant=plain)
        raise Refused(
            Message(
                "reply-beyond-one",
                got=plain,
                percent=percent if is_bare else None,
                meant=meant if is_bare and abs(value) < 100.0 else None,
            )
        )
    warning = None
    if not question.low <= value <= question.high:
        warning = Message("reply-unusual", got=plain, common=show_common(question))
    is_share = dimension is not RATIO or question.high <= 1.0
    is_doubtful = (is_bare or "," in text) and is_share
    taken_as = _in_other_words(plain, value, dimension) if is_doubtful else ""
    return Reply(text=plain, warning=warning, taken_as=taken_as)


AT_SHAFT = {MASS: (INERTIA, 2), FORCE: (TORQUE, 1)}
"""What a mass and a force are at the motor's shaft, and the power of its turn per travel."""


def _from_shaft(question: Question, dimension: Dimension, text: str) -> str:
    """A value that was typed for the motor's shaft, as at the axis; "" for any other."""
    if not question.motor_turn or dimension not in AT_SHAFT or NUMBER.fullmatch(text.strip()):
        return ""
    own, power = AT_SHAFT[dimension]
    try:
        value = parse_quantity(text, own, decimal_comma=True)
    except Refused:
        return ""
    return f"{value * question.motor_turn**power:.6g} {dimension.si}"


def _in_other_words(plain: str, value: float, dimension: Dimension) -> str:
    """A number with the unit it was given, and the second unit that is as usual for it."""
    if dimension is RATIO:
        return f"{plain} = {100.0 * value:g} %"
    if dimension is GAIN:
        return f"{plain} = {convert_to(value, '(m/min)/mm'):.4g} (m/min)/mm"
    return plain


def list_accepted(answers: Answers) -> tuple[str, ...]:
    """Return the keys of answers that are defaults which were only accepted.

    Examples
    --------
    >>> list_accepted(note_accepted({"drive.force_lag": "2 ms"}, "drive.force_lag"))
    ('drive.force_lag',)
    """
    return tuple(answers.get(ACCEPTED, "").split())


def note_accepted(answers: Answers, *keys: str) -> dict[str, str]:
    """Return the answers with some more that are only defaults."""
    return {**answers, ACCEPTED: " ".join(dict.fromkeys((*list_accepted(answers), *keys)))}


def note_stated(answers: Answers, key: str) -> dict[str, str]:
    """Return the answers with one that somebody stated.

    Examples
    --------
    >>> given = {"drive.max_force": "1 N", "drive.force_lag": "1 s", "wizard.accepted": "drive"}
    >>> note_stated(given, "drive.max_force")["wizard.accepted"]
    'drive.force_lag'
    """
    left: list[str] = []
    rest = {name: text for name, text in answers.items() if name != ACCEPTED}
    for one in list_accepted(answers):
        if key.startswith(f"{one}."):  # a profile may name a whole table
            left += [name for name in rest if name.startswith(f"{one}.") and name != key]
        elif one != key:
            left.append(one)
    return note_accepted(rest, *left) if left else rest


def show_common(question: Question) -> Message:
    """Return the common range of a quantity as people write it.

    Examples
    --------
    >>> from mtcommission.units.quantities import STIFFNESS
    >>> show_common(Question(key="", dimension=STIFFNESS, low=1e4, high=1e10))
    Message('wizard-span', low='10 kN/m', high='10 GN/m')
    """
    unit = question.dimension.si if question.dimension else ""
    if question.dimension is RATIO and question.high > 1.0:  # no share, as of a gear
        return Message("wizard-span", low=f"{question.low:g}", high=f"{question.high:g}")
    return Message("wizard-span", low=_shown(question.low, unit), high=_shown(question.high, unit))


SMALL = ((1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"))
LARGE = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""))


def _shown(value: float, unit: str) -> str:
    """Return a round SI number as people write it: 500 us, not 0.0005 s."""
    if not unit:
        return f"{100.0 * value:g} %"
    scales: tuple[tuple[float, str], ...] = ()
    if unit in ("s", "m", "rad"):
        scales = SMALL
    elif unit.startswith("N"):
        scales = LARGE
    for size, prefix in scales:
        if abs(value) >= size * (1.0 - 1e-9):
            return f"{value / size:.6g} {prefix}{unit}"
    return f"{value:.15g} {unit}"


def si_value(answers: Answers, key: str, dimension: Dimension) -> float | None:
    """Return an answer as SI number; None while it is not known, or wrong in a file."""
    try:
        return parse_quantity(answers.get(key, ""), dimension, decimal_comma=True)
    except Refused:
        return None  # asked, or named by the profile's reader, in its turn
