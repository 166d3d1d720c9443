"""Values that have a word where there is no number."""

from __future__ import annotations

from mtcommission.machine.requirement import read_requirement
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import join_by_and
from mtcommission.record.schema import AttainableEntry


def settling(value: float | None, words: Catalogue) -> str:
    """Return a settling time [s]; None is "not settled"."""
    return words.format.quantity(value, "s", missing=words.text("not-settled"))


def residual(value: float | None, words: Catalogue) -> str:
    """Return a residual deviation [m or rad]; None is "not settled"."""
    return words.format.axis(value, "m", missing=words.text("not-settled"))


def decibel(value: float | None, words: Catalogue) -> str:
    """Return a gain margin [dB]; None means that the curve never crosses."""
    shown = None if value is None else round(value, 1)
    return words.format.quantity(shown, "dB", missing=words.text("unlimited"))


def degree(value: float | None, words: Catalogue) -> str:
    """Return a phase margin [degrees]; None means that the curve never crosses."""
    shown = None if value is None else round(value, 1)
    return words.format.quantity(shown, "°", missing=words.text("unlimited"))


def say_requirement(name: str, words: Catalogue) -> str:
    """Return the text of a requirement that a record names; another name stays as it is."""
    try:
        return words.say(read_requirement(name).message)
    except ValueError:
        return name


def say_limiting(item: AttainableEntry, words: Catalogue) -> str:
    """Return the requirement that stands in the way, and those that must give way with it.

    Examples
    --------
    >>> item = AttainableEntry(requirement="settling time", limit=0.02, value=0.09, unit="s",
    ...     acceleration=1.8, jerk=64.0, together_with=["peak v_s"])
    >>> say_limiting(item, Catalogue())
    'settling time, together with peak v_s'
    """
    said = say_requirement(item.requirement, words)
    others = [read_requirement(name).message for name in item.together_with]
    if not others:
        return said
    return words.text("requirement-together-with", requirement=said, others=join_by_and(others))
