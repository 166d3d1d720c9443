"""One question, and what a typed reply to it means."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf

from mtcommission.units.quantities import (
    DIGITS,
    GAIN,
    NUMBER,
    RATIO,
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
    text
        The question, one line.
    where
        Where to find the value, one line; shown with ``?`` and in the profile.
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
    """

    key: str
    text: str
    where: str
    dimension: Dimension | None = None
    choices: tuple[str, ...] = ()
    default: str = ""
    example: str = ""
    low: float = -inf
    high: float = inf
    is_optional: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """An accepted reply.

    Parameters
    ----------
    text
        As the profile will hold it: decimal point, unit added where it was left out.
    warning
        What is unusual about it; "" if nothing is.
    taken_as
        How a number is read that was typed without a unit, or with a comma; "" for any other.
    """

    text: str
    warning: str = ""
    taken_as: str = ""


def read_reply(question: Question, typed: str) -> Reply:
    """Return the meaning of a reply.

    Parameters
    ----------
    question
        What was asked.
    typed
        What was typed, not a command.

    Returns
    -------
    Reply

    Raises
    ------
    ValueError
        With what was got and what to type instead.

    Examples
    --------
    >>> from mtcommission.units.quantities import STIFFNESS
    >>> reply = read_reply(Question(key="k", text="?", where="", dimension=STIFFNESS), "44,41")
    >>> reply.text, reply.taken_as
    ('44.41 N/m', '44.41 N/m')
    """
    text = typed.strip() or question.default
    if not text:
        if question.is_optional:
            return Reply(text="")
        example = f", e.g. {question.example}" if question.example else ""
        raise ValueError(f"an answer is needed here{example}")
    if question.choices:
        return Reply(text=_choose(question, text))
    if question.dimension is None:
        return Reply(text=_free_text(text))
    return _quantity(question, question.dimension, text)


def _choose(question: Question, text: str) -> str:
    numbers = {str(number): word for number, word in enumerate(question.choices, start=1)}
    if text in numbers:
        return numbers[text]
    wanted = text.lower()
    starts = [word for word in question.choices if word.lower().startswith(wanted)]
    exact = [word for word in starts if word.lower() == wanted]
    if len(starts) == 1 or exact:
        return (exact or starts)[0]
    listed = ", ".join(f"{number} {word}" for number, word in numbers.items())
    raise ValueError(f'got "{text}"; choose one of: {listed}')


def _free_text(text: str) -> str:
    if not text.isprintable():
        raise ValueError("got control characters or bytes of another encoding; type plain text")
    if len(text) > LONGEST_TEXT:
        raise ValueError(f"got {len(text)} characters, at most {LONGEST_TEXT} are allowed")
    return text


def _quantity(question: Question, dimension: Dimension, text: str) -> Reply:
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
        sign = ">" if question.low > 0.0 else ">="
        raise ValueError(f"got {plain}, must be {sign} 0{unit}")
    if dimension is RATIO and abs(value) >= 1.0:
        percent = f", which is {100.0 * value:g} %" if is_bare else ""
        meant = f'; did you mean "{plain} %"?' if is_bare and abs(value) < 100.0 else ""
        raise ValueError(f"got {plain}{percent}; must be below 100 %{meant}")
    warning = ""
    if not question.low <= value <= question.high:
        warning = (
            f"{plain} is unusual; common are {show_common(question)}. "
            "Check number and unit, type < to change it."
        )
    taken_as = _in_other_words(plain, value, dimension) if is_bare or "," in text else ""
    return Reply(text=plain, warning=warning, taken_as=taken_as)


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


def show_common(question: Question) -> str:
    """Return the common range of a quantity as people write it.

    Examples
    --------
    >>> from mtcommission.units.quantities import STIFFNESS
    >>> show_common(Question(key="", text="", where="", dimension=STIFFNESS, low=1e4, high=1e10))
    '10 kN/m to 10 GN/m'
    """
    unit = question.dimension.si if question.dimension else ""
    return " to ".join(_shown(value, unit) for value in (question.low, question.high))


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
    except ValueError:
        return None  # asked, or named by the profile's reader, in its turn
