"""The languages that a sheet can be printed in."""

from __future__ import annotations

from mtcommission.errors import Fault, InputError
from mtcommission.messages.catalogue import LANGUAGES
from mtcommission.messages.message import Message


def require_language(language: str) -> None:
    """Refuse a language that there is not.

    Parameters
    ----------
    language
        Code, e.g. "en".

    Raises
    ------
    InputError
        If there is no such language.
    """
    if language not in LANGUAGES:
        message = Message("unknown-language", language=language, allowed=tuple(LANGUAGES))
        raise InputError([Fault(where="--language", message=message)])
