"""What traces say, for terminal, page and JSON: every table and sentence once."""

from __future__ import annotations

from collections.abc import Sequence

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import to_json
from mtcommission.record.shape import to_plain
from mtcommission.sheet.document import Block, Column, Paragraph, Table, Tone, note
from mtcommission.units.axis_units import LINEAR, ROTARY
from mtcommission.verify.checks import Check, Verdict, what_of
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.refine import Parameter, Refined
from mtcommission.verify.renew import Limits, NewLimits
from mtcommission.verify.verify import Verification

KNOWN = (Verdict.FAILS, Verdict.HOLDS)

Entry = dict[str, object]


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
    return sorted(checks, key=lambda check: check.verdict not in KNOWN)


def check_row(check: Check, words: Catalogue) -> tuple[str, ...]:
    """Return promise, prediction with its corners, bound, measured value and verdict."""
    return say_check(check, words), *check_cells(check, words)


def check_cells(check: Check, words: Catalogue) -> tuple[str, str, str, str]:
    """Return prediction with its corners, bound, measured value and verdict."""
    form = words.format

    def value(number: float | None, digits: int = 4) -> str:
        if check.unit == "":
            return "–" if number is None else form.percent(number, digits=digits)
        return form.quantity(number, check.unit, digits=digits)

    predicted, measured = value(check.predicted), value(check.measured)
    if check.low != check.high:
        predicted += f" ({value(check.low)} … {value(check.high)})"
    if check.measured is not None and check.uncertainty is not None:
        measured += f" ± {value(check.uncertainty, 2)}"
    return (
        predicted,
        "–" if check.limit is None else f"≤ {value(check.limit)}",
        measured,
        say_verdict(check.verdict, words),
    )


def say_reasons(checks: Sequence[Check], words: Catalogue) -> list[str]:
    """Return why promises do not hold or cannot be told: each reason once."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for check in known_first(checks):
        if check.verdict is not Verdict.HOLDS:
            why = say_verdict(check.verdict, words), words.say(check.reason)
            grouped.setdefault(why, []).append(say_check(check, words))
    return [f"{verdict} ({why}): {', '.join(names)}" for (verdict, why), names in grouped.items()]


def list_differences(
    found: Verification,
    refined: Refined,
    fed: FeedForward | None,
    limits: NewLimits | None,
    words: Catalogue,
) -> list[Block]:
    """Return what is different from the record: parameters, and the limits that follow."""
    say, blocks = words.text, list[Block]()
    if refined.parameters:
        blocks.append(_parameters("parameter", refined.parameters, words))
    if found.unexplained is not None:
        blocks.append(note(say("verify-unexplained", share=found.unexplained)))
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
    if limits is not None:
        blocks.append(_limits(limits, words))
        if limits.failure:
            failure = say("warning", warning=words.say(limits.failure))
            blocks.append(Paragraph(text=failure, tone=Tone.WARNING))
    return blocks


def _parameters(kind: str, values: Sequence[Parameter], words: Catalogue) -> Table:
    """Name, old and new value of each, and what to make of it."""
    say, form, rows = words.text, words.format, []
    for one in values:

        def value(number: float, digits: int = 4, unit: str = one.unit) -> str:
            if unit == "":
                return form.percent(number, digits=digits)
            return form.quantity(number, unit, digits=digits)

        what = say(f"verify-parameter-{one.key.replace('_', '-')}")
        meaning = say(f"verify-parameter-is-{'changed' if one.has_changed else 'same'}")
        rows.append(
            (
                say("of-mode", name=what, mode=one.mode) if one.mode else what,
                value(one.old),
                f"{value(one.new.value)} ± {value(2.0 * one.new.sigma, 2)}",
                meaning,
            )
        )
    return Table(
        caption=say(f"verify-caption-{kind}s"),
        columns=(
            Column(head=say(f"verify-head-{kind}"), width=1.6),
            Column(head=say("verify-head-old"), is_number=True),
            Column(head=say("verify-head-new"), is_number=True, width=1.6),
            Column(head=say("meaning"), width=1.6),
        ),
        rows=tuple(rows),
        strong_rows=tuple(place for place, one in enumerate(values) if one.has_changed),
    )


def _limits(limits: NewLimits, words: Catalogue) -> Table:
    """Acceleration, jerk, settling time and verdict, old beside new."""
    say, form, unit = words.text, words.format, ROTARY if words.rotary else LINEAR

    def column(one: Limits | None) -> list[str]:
        if one is None:
            return ["–"] * 4
        return [
            form.quantity(one.acceleration, unit.acceleration.si),
            form.quantity(one.jerk, unit.jerk.si),
            form.quantity(one.settling_time, "s", missing=say("not-settled")),
            say("yes" if one.met else "no"),
        ]

    names = [say(f"verify-limit-{key}") for key in ("acceleration", "jerk", "settling", "met")]
    return Table(
        caption=say("verify-caption-limits"),
        columns=(
            Column(head="", width=1.4),
            Column(head=say("verify-head-old"), is_number=True),
            Column(head=say("verify-head-new"), is_number=True),
        ),
        rows=tuple(zip(names, column(limits.old), column(limits.new), strict=True)),
    )


def verification_entry(
    found: Verification, refined: Refined, fed: FeedForward | None, limits: NewLimits | None
) -> Entry:
    """Return what was found as JSON has it; SI, ``limit`` null where nothing is required."""
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
                "frequency_hz": seen.frequency_hz,
                "damping_ratio": seen.damping_ratio,
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
    new, sigma = one.new.value, one.new.sigma
    changed = one.has_changed
    return {"old": one.old, "new": new, "sigma": sigma, "unit": one.unit, "changed": changed}


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
