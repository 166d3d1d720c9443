"""Words and numbers of a verification, the same on terminal and page."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.units.axis_units import LINEAR, ROTARY
from mtcommission.verify.checks import Check, Verdict, what_of
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.new_limits import Limits, NewLimits
from mtcommission.verify.refine import Parameter, Refined

HEADS = ("what", "predicted", "allowed", "measured", "verdict")
"""Columns of the table of checks."""


def say_verdict(verdict: Verdict, words: Catalogue) -> str:
    """Return the verdict of one check in words."""
    return words.text(f"verify-verdict-{verdict.value.replace(' ', '-')}")


def say_check(check: Check, words: Catalogue) -> str:
    """Return what was checked."""
    what = words.say(what_of(check))
    return f"{words.text('move', number=check.move)}: {what}" if check.move else what


def check_row(check: Check, words: Catalogue) -> tuple[str, ...]:
    """Return a row of the table of checks."""
    form = words.format

    def value(number: float | None) -> str:
        if check.unit == "":
            return form.percent_if_known(number)
        return form.quantity(number, check.unit)

    predicted = value(check.predicted)
    if check.low is not None and check.low != check.high:
        predicted += f" ({value(check.low)} … {value(check.high)})"
    measured = value(check.measured)
    if check.measured is not None and check.uncertainty is not None:
        shown = (
            form.percent(check.uncertainty, digits=2)
            if check.unit == ""
            else form.quantity(check.uncertainty, check.unit, digits=2)
        )
        measured += f" ± {shown}"
    return (
        say_check(check, words),
        predicted,
        "–" if check.limit is None else f"≤ {value(check.limit)}",
        measured,
        f"{say_verdict(check.verdict, words)}: {words.say(check.reason)}",
    )


def parameter_row(one: Parameter, words: Catalogue) -> tuple[str, ...]:
    """Return name, old and new value of a parameter, and what to make of it."""
    form = words.format
    what = words.text(f"verify-parameter-{one.key.replace('_', '-')}")
    if one.mode:
        what = words.text("of-mode", name=what, mode=one.mode)

    def value(number: float, digits: int = 4) -> str:
        if one.unit == "":
            return form.percent(number, digits=digits)
        return form.quantity(number, one.unit, digits=digits)

    note = "changed" if one.has_changed else "same"
    return (
        what,
        value(one.old),
        f"{value(one.new.value)} ± {value(2.0 * one.new.sigma, 2)}",
        words.text(f"verify-parameter-is-{note}"),
    )


def say_test(refined: Refined, words: Catalogue) -> str:
    """Return what the refined machine leaves of the moves that were held back; "" for nothing."""
    before, after = refined.unexplained_before, refined.unexplained_after
    if before is None or after is None or not refined.parameters:
        return ""
    note = words.text("verify-tested", moves=refined.tested, before=before, after=after)
    if refined.force_unexplained is not None:
        note += " " + words.text("verify-force-left", share=refined.force_unexplained)
    return note


def say_feedforward(fed: FeedForward, words: Catalogue) -> str:
    """Return what the values would bring."""
    before, after = (words.format.axis(value, "m", digits=3) for value in (fed.before, fed.after))
    return words.text("verify-feedforward-brings", moves=fed.tested, before=before, after=after)


def limit_rows(limits: NewLimits, words: Catalogue) -> list[tuple[str, str, str]]:
    """Return acceleration, jerk, settling time and verdict, old beside new."""
    unit = ROTARY if words.rotary else LINEAR
    form = words.format

    def column(one: Limits | None) -> list[str]:
        if one is None:
            return ["–"] * 4
        return [
            form.quantity(one.acceleration, unit.acceleration.si),
            form.quantity(one.jerk, unit.jerk.si),
            form.quantity(one.settling_time, "s", missing=words.text("not-settled")),
            words.text("yes" if one.met else "no"),
        ]

    heads = [
        words.text(f"verify-limit-{key}") for key in ("acceleration", "jerk", "settling", "met")
    ]
    return list(zip(heads, column(limits.old), column(limits.new), strict=True))
