"""What traces say, for terminal, page and JSON: every table and sentence once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, to_json
from mtcommission.record.shape import to_plain
from mtcommission.sheet.document import Block, Column, Paragraph, Table, Tone, note
from mtcommission.sheet.tables import DASH, Quantity, table
from mtcommission.verify.checks import Check, Verdict, what_of
from mtcommission.verify.feedforward import FeedForward, suggest_feedforward
from mtcommission.verify.refine import Parameter, Refined, refine
from mtcommission.verify.renew import NewLimits
from mtcommission.verify.verify import Verification

Entry = dict[str, object]


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What traces say of a record, of the machine and of its control."""

    found: Verification
    refined: Refined  # parameters as the traces show them
    fed: FeedForward | None  # None where a trace shows no following error
    limits: NewLimits | None = None  # what they lead to; None: not asked for


def report(found: Verification) -> Report:
    """Return what the traces of a verification say beyond its verdict."""
    return Report(found=found, refined=refine(found), fed=suggest_feedforward(found))


def say_verdict(verdict: Verdict, words: Catalogue) -> str:
    """Return the verdict of one check in words."""
    return words.text(f"verify-verdict-{verdict.value.replace(' ', '-')}")


def say_check(check: Check, words: Catalogue) -> str:
    """Return what was checked."""
    what = words.say(what_of(check))
    return f"{words.text(check.part.value, number=check.move)}: {what}" if check.move else what


def say_detail(found: Verification, words: Catalogue) -> str:
    """Return how much was recorded, and whether the control obeyed."""
    obeyed = {True: "yes", False: "no", None: "unknown"}[found.obeyed]
    return words.text("verify-detail", moves=len(found.recorded), obeyed=obeyed)


def known_first(checks: Sequence[Check]) -> list[Check]:
    """Return checks, those that tell something first."""
    return sorted(checks, key=lambda check: check.verdict is Verdict.UNKNOWN)


def _shown(value: float | None, unit: str, words: Catalogue, digits: int = 4) -> str:
    """A value in its unit; a ratio per cent."""
    if unit:
        return words.format.quantity(value, unit, digits=digits)
    return DASH if value is None else words.format.percent(value, digits=digits)


def check_row(check: Check, words: Catalogue) -> tuple[str, ...]:
    """Return promise, prediction with its corners, bound, measured value and verdict."""
    predicted, low, high, limit, measured = (
        _shown(value, check.unit, words)
        for value in (check.predicted, check.low, check.high, check.limit, check.measured)
    )
    if check.low != check.high:
        predicted += f" ({low} … {high})"
    if check.measured is not None and check.uncertainty is not None:
        measured += f" ± {_shown(check.uncertainty, check.unit, words, 2)}"
    allowed = DASH if check.limit is None else f"≤ {limit}"
    return say_check(check, words), predicted, allowed, measured, say_verdict(check.verdict, words)


def say_reasons(checks: Sequence[Check], words: Catalogue) -> list[str]:
    """Return why promises do not hold or cannot be told: each reason once."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for check in known_first(checks):
        if check.verdict is not Verdict.HOLDS:
            why = say_verdict(check.verdict, words), words.say(check.reason)
            grouped.setdefault(why, []).append(say_check(check, words))
    return [f"{verdict} ({why}): {', '.join(names)}" for (verdict, why), names in grouped.items()]


def list_differences(told: Report, words: Catalogue) -> list[Block]:
    """Return what is different from the record: parameters, and the limits that follow."""
    say, blocks, refined, fed = words.text, list[Block](), told.refined, told.fed
    if refined.parameters:
        blocks.append(_parameters("parameter", refined.parameters, words))
    if told.found.unexplained is not None:
        blocks.append(note(say("verify-unexplained", share=told.found.unexplained)))
    before, after = refined.unexplained_before, refined.unexplained_after
    if before is not None and after is not None and refined.parameters:
        tested = say("verify-tested", moves=refined.tested, before=before, after=after)
        if refined.force_unexplained is not None:
            tested += " " + say("verify-force-left", share=refined.force_unexplained)
        blocks.append(note(tested))
    if fed is not None:
        blocks.append(_parameters("feedforward", fed.values, words))
        old, new = (words.format.axis(value, "m", digits=3) for value in (fed.before, fed.after))
        brings = say("verify-feedforward-brings", moves=fed.tested, before=old, after=new)
        blocks.append(note(brings))
    if told.limits is not None:
        blocks.append(_limits(told.limits, words))
        if told.limits.failure:
            failure = say("warning", warning=words.say(told.limits.failure))
            blocks.append(Paragraph(text=failure, tone=Tone.WARNING))
    return blocks


def _parameters(kind: str, values: Sequence[Parameter], words: Catalogue) -> Table:
    """Name, old and new value of each, and what to make of it."""

    def name(one: Parameter) -> str:
        what = words.text(f"verify-parameter-{one.key.replace('_', '-')}")
        return words.text("of-mode", name=what, mode=one.mode) if one.mode else what

    def new(one: Parameter) -> str:
        value, error = _shown(one.new.value, one.unit, words), 2.0 * one.new.sigma
        return f"{value} ± {_shown(error, one.unit, words, 2)}"

    def meaning(one: Parameter) -> Message:
        return Message(f"verify-parameter-is-{'changed' if one.has_changed else 'same'}")

    columns = (
        Quantity(f"verify-head-{kind}", name, width=1.6),
        Quantity("verify-head-old", lambda one: _shown(one.old, one.unit, words), ""),
        Quantity("verify-head-new", new, "", width=1.6),
        Quantity("meaning", meaning, width=1.6),
    )
    caption = f"verify-caption-{kind}s"
    return table(words, caption, columns, values, strong=lambda one: one.has_changed)


LIMITS = (
    Quantity("verify-limit-acceleration", "acceleration", "m/s^2"),
    Quantity("verify-limit-jerk", "jerk", "m/s^3"),
    Quantity("verify-limit-settling", "settling_time", "s", "not-settled"),
    Quantity("verify-limit-met", "met"),
)


def _limits(limits: NewLimits, words: Catalogue) -> Table:
    """Acceleration, jerk, settling time and verdict, old beside new."""
    both, heads = (limits.old, limits.new), ("verify-head-old", "verify-head-new")
    return Table(
        caption=words.text("verify-caption-limits"),
        columns=(
            Column(head="", width=1.4),
            *(Column(head=words.text(head), is_number=True) for head in heads),
        ),
        rows=tuple(
            (one.head(words), *(one.show(own, words) if own else DASH for own in both))
            for one in LIMITS
        ),
    )


def verification_entry(told: Report) -> Entry:
    """Return what was found as JSON has it; SI, ``limit`` null where nothing is required."""
    found, refined, fed, limits = told.found, told.refined, told.fed, told.limits
    by_key = {check.key: check.measured for check in found.checks}
    setpoint = ("velocity", "acceleration", "jerk")
    return {
        "verdict": found.verdict.value,
        "record": found.record.checksum,
        "traces": [{"file": one.file, "sha256": one.sha256} for one in found.traces],
        "setpoint": {
            **{key: by_key.get(f"setpoint {key}") for key in setpoint},
            "obeyed": found.obeyed,
        },
        "checks": [check_entry(check) for check in found.checks],
        "shift": found.shift,
        "modes": [
            {
                "name": mode.name,
                "frequency_hz": seen.frequency_hz.value,
                "damping_ratio": seen.damping_ratio.value,
                "amplitude": seen.amplitude,
                "move": number,
            }
            for number, one in enumerate(found.recorded, start=1)
            for mode, seen in zip(found.rebuilt.plant.modes, one.modes, strict=True)
            if seen is not None
        ],
        "noise_floor": found.noise_floor,
        "unexplained": found.unexplained,
        "refined": {one.name: _parameter(one) for one in refined.parameters},
        "held_back": {
            "moves": refined.tested,
            "unexplained_before": refined.unexplained_before,
            "unexplained_after": refined.unexplained_after,
            "force_unexplained": refined.force_unexplained,
        },
        "feedforward": fed
        and {
            "values": {one.key: _parameter(one) for one in fed.values},
            "moves_held_back": fed.tested,
            "deviation_before": fed.before,
            "deviation_after": fed.after,
        },
        "limits": limits and {"old": to_plain(limits.old), "new": to_plain(limits.new)},
        "warnings": [to_json(warning) for warning in found.warnings],
    }


def _parameter(one: Parameter) -> Entry:
    new = {"new": one.new.value, "sigma": one.new.sigma}
    return {"old": one.old, **new, "unit": one.unit, "changed": one.has_changed}


def check_entry(check: Check) -> Entry:
    """Return a check as JSON has it."""
    values = ("unit", "predicted", "low", "high", "limit", "measured", "uncertainty")
    return {
        "name": check.name,
        check.part.value: check.move or None,
        "mode": check.mode or None,
        **{key: getattr(check, key) for key in values},
        "verdict": check.verdict.value,
        "reason": to_json(check.reason),
    }
