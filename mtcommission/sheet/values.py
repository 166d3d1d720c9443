"""Values that have a word where there is no number."""

from __future__ import annotations

from mtcommission.machine.shapers import name_shaper
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message, join_by_and
from mtcommission.record.schema.limits import Alternative, AttainableEntry, RuleResult
from mtcommission.record.schema.values import SetpointFilterEntry
from mtcommission.requirements.register import read_requirement

ROUNDED = 1.001
"""A ramp of one position cycle, with acceleration and jerk as rounded to what is typed."""


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


def is_of_calibration(item: RuleResult | Alternative) -> bool:
    """Return whether limits are those that ``calibrate_shaper`` would choose."""
    return isinstance(item.name, Message) and item.name.kind == "shaper-of-calibration"


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


def say_filter(item: SetpointFilterEntry | None, words: Catalogue) -> str:
    """Return a setpoint filter with its numbers; None is "none".

    Examples
    --------
    >>> say_filter(None, Catalogue())
    'none'
    """
    numbers = [value for _, value in _numbers(item, words)]
    return " ".join([_name(item, words), *([", ".join(numbers)] if numbers else [])])


def filter_rows(item: SetpointFilterEntry | None, words: Catalogue) -> list[tuple[str, str]]:
    """Return a setpoint filter as it is entered: its kind, then each of its numbers."""
    return [(words.text("setpoint-filter"), _name(item, words)), *_numbers(item, words)]


def _name(item: SetpointFilterEntry | None, words: Catalogue) -> str:
    if item is None:
        return words.text("no-setpoint-filter")
    count = len(item.shares)
    return words.text("filter-name", kind=item.kind, shaper=name_shaper(item.kind), count=count)


def _numbers(item: SetpointFilterEntry | None, words: Catalogue) -> list[tuple[str, str]]:
    """What is beside the kind, by its label."""
    text, f = words.text, words.format
    if item is None:
        return []
    if item.frequency_hz:
        return [
            (text("filter-of-frequency"), f.quantity(item.frequency_hz, "Hz")),
            (text("filter-of-damping"), f"ζ {f.number(item.damping_ratio)}"),
        ]
    times = [item.time or item.duration, item.second_time]
    labels = ("filter-of-length", "filter-of-second-length")
    return [
        (text(label), f.quantity(time, "s"))
        for label, time in zip(labels, times, strict=True)
        if time
    ]
