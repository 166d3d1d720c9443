"""The language that the terminal speaks: that of ``--language``, one for a call of the program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextvars import ContextVar
from itertools import pairwise
from typing import TYPE_CHECKING

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.languages import ENGLISH, LANGUAGES
from mtcommission.base.messages.message import Message, Value

if TYPE_CHECKING:
    from mtcommission.base.messages.catalogue import Catalogue
    from mtcommission.machine.machine import Machine

LOCALE = ("LC_ALL", "LC_MESSAGES", "LANG")
"""Variables of the environment that name a language, the first that is set counts (POSIX)."""

_spoken = ContextVar("spoken", default=ENGLISH)
_rotary = ContextVar("rotary", default=False)
_follows = ContextVar("follows", default=False)


def choose(language: str) -> str:
    """Speak a language from now on, or go on with the one that is spoken where "" is asked for.

    Raises
    ------
    InputError
        There is no such language.
    """
    if not language:
        return _spoken.get()
    if language not in LANGUAGES:
        message = Message("option-no-language", got=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
    _spoken.set(language)
    _rotary.set(False)
    _follows.set(False)
    return language


def find_language(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """Return the language asked for anywhere on the command line, else that of the environment.

    A language that there is not is refused where the option is read.

    Examples
    --------
    >>> find_language(["--language", "de", "run", "--help"], {})
    'de'
    >>> find_language(["--help"], {"LANG": "de_DE.UTF-8"}), find_language([], {"LANG": "C.UTF-8"})
    ('de', 'en')
    """
    asked = [text.removeprefix("--language=") for text in arguments if "--language=" in text]
    asked += [after for text, after in pairwise(arguments) if text == "--language"]
    locale = next((environment[key] for key in LOCALE if environment.get(key)), "")
    return next((one for one in (*asked, locale[:2]) if one in LANGUAGES), ENGLISH)


def spoken() -> str:
    """Return the language that is spoken."""
    return _spoken.get()


def has_text(kind: str) -> bool:
    """Return whether the language that is spoken has a text of a kind."""
    return words().has(kind)


SPOKEN = ""
"""Default of the option: the language that is spoken already."""


def speak_of(machine: Machine) -> None:
    """Speak of torques and angles from now on, if the axis turns; of no force, if it follows."""
    _rotary.set(machine.motion.value == "rotary")
    _follows.set(machine.drive.follows)


def words(*, rotary: bool | None = None) -> Catalogue:
    """Return the catalogue of the chosen language for a kind of axis: that of the machine read."""
    from mtcommission.base.messages.catalogue import Catalogue

    turns = _rotary.get() if rotary is None else rotary
    return Catalogue(_spoken.get(), rotary=turns, follows=_follows.get())


def say(kind: str, /, **values: Value) -> str:
    """Return a text of the command line itself."""
    return words().text(kind, **values)
