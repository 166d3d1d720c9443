"""Values that have a word where there is no number."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue


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
