"""The language that the terminal speaks: that of ``--language``, one for a call of the program."""

from __future__ import annotations

from contextvars import ContextVar
from typing import TYPE_CHECKING, Annotated

import typer

from mtcommission.errors import Fault, InputError
from mtcommission.messages.languages import LANGUAGES
from mtcommission.messages.message import Message, Value

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.messages.catalogue import Catalogue

ENGLISH = "en"

_spoken = ContextVar("spoken", default=ENGLISH)
_rotary = ContextVar("rotary", default=False)
_follows = ContextVar("follows", default=False)


def choose(language: str) -> str:
    """Speak a language from now on.

    Parameters
    ----------
    language
        Code, e.g. "en".

    Returns
    -------
    str
        The same.

    Raises
    ------
    InputError
        If there is no such language.
    """
    if language not in LANGUAGES:
        message = Message("option-no-language", got=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
    _spoken.set(language)
    _rotary.set(False)
    _follows.set(False)
    return language


LanguageOption = Annotated[
    str,
    typer.Option(
        "--language",
        metavar="|".join(LANGUAGES),
        help="Language.",
        callback=choose,
        is_eager=True,
    ),
]


def speak_of(machine: Machine) -> None:
    """Speak of torques and angles from now on, if the axis turns; of no force, if it follows."""
    _rotary.set(machine.motion.value == "rotary")
    _follows.set(machine.drive.follows)


def words(*, rotary: bool | None = None) -> Catalogue:
    """Return the catalogue of the chosen language for a kind of axis: that of the machine read."""
    from mtcommission.messages.catalogue import Catalogue

    turns = _rotary.get() if rotary is None else rotary
    return Catalogue(_spoken.get(), rotary=turns, follows=_follows.get())


def say(kind: str, /, **values: Value) -> str:
    """Return a text of the command line itself."""
    return words().text(kind, **values)
