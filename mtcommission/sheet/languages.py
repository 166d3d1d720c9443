"""The languages that a sheet can be printed in."""

from __future__ import annotations

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message
from mtcommission.sheet.labels_de import GERMAN
from mtcommission.sheet.labels_en import ENGLISH, Labels

LANGUAGES: dict[str, Labels] = {"en": ENGLISH, "de": GERMAN}


def find_labels(language: str) -> Labels:
    """Return the texts of a language.

    Parameters
    ----------
    language
        Code, e.g. "en".

    Returns
    -------
    Labels

    Raises
    ------
    InputError
        If there is no such language.

    Examples
    --------
    >>> find_labels("en").verdict_met
    'All requirements met'
    """
    if language not in LANGUAGES:
        allowed = ", ".join(LANGUAGES)
        message = f'got "{language}", must be one of: {allowed}'
        raise InputError([Fault(where="--language", message=Message("verbatim", text=message))])
    return LANGUAGES[language]
