"""What traces say, for terminal, page and JSON: every table and sentence once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import TypeVar

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, to_json
from mtcommission.record.limits import JudgedLimits
from mtcommission.record.machine import Profile
from mtcommission.sheet.document import (
    BigValue,
    Block,
    Bullets,
    Headline,
    LinePlot,
    Paragraph,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.html import set_parts
from mtcommission.sheet.plots import FOURTH, MAIN, OTHER, THIRD, Curve, Signals, line_plot
from mtcommission.sheet.tables import DASH, SETTLING, Quantity, table, words_for
from mtcommission.verify.beside import Recorded
from mtcommission.verify.checks import Check, Verdict, what_of
from mtcommission.verify.feedforward import FeedForward, suggest_feedforward
from mtcommission.verify.refine import NewLimits, Parameter, Refined, refine
from mtcommission.verify.trace import Role, Trace
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
        keys = {one.key for one in (*refined.parameters, *fed.values)}
        if keys >= {"mass", "feedforward_mass"}:
            blocks.append(note(say("verify-two-masses")))
    if told.limits is not None:
        rows = {"old": told.limits.old, "new": told.limits.new}
        shown = [(Message(f"verify-head-{name}"), one) for name, one in rows.items() if one]
        blocks.append(table(words, "verify-caption-limits", LIMITS, shown))
        if told.limits.failure:
            failure = say("warning", warning=words.say(told.limits.failure))
            blocks.append(Paragraph(text=failure, tone=Tone.WARNING))
    return blocks


def _parameters(kind: str, values: Sequence[Parameter], words: Catalogue) -> Table:

    def name(one: Parameter) -> str:
        own = f"verify-parameter-{one.key.replace('_', '-')}"
        what = words.known(own, words.name(one.key))
        return words.text("of-mode", name=what, mode=one.mode) if one.mode else what

    def new(one: Parameter) -> str:
        value, error = _shown(one.new.value, one.unit, words), 2.0 * one.new.sigma
        return f"{value} ± {_shown(error, one.unit, words, 2)}"

    def meaning(one: Parameter) -> Message:
        return Message("changed" if one.has_changed else "verify-parameter-is-same")

    columns = (
        Quantity("parameter", name, width=1.6),
        Quantity("verify-head-old", lambda one: _shown(one.old, one.unit, words), ""),
        Quantity("verify-head-new", new, "", width=1.6),
        Quantity("meaning", meaning, width=1.6),
    )
    caption = f"verify-caption-{kind}s"
    return table(words, caption, columns, values, strong=lambda one: one.has_changed)


LIMITS = (
    Quantity("", itemgetter(0), width=1.4),
    *(
        one.within(itemgetter(1))
        for one in (
            Quantity("acceleration", "acceleration", "m/s^2"),
            Quantity("jerk", "jerk", "m/s^3"),
            SETTLING,
            Quantity("verdict-met", "meets_requirements"),
        )
    ),
)


def verification_entry(told: Report) -> Entry:
    """Return what was found as JSON has it; SI, ``limit`` null where nothing is required."""
    found, refined, fed, limits = told.found, told.refined, told.fed, told.limits
    by_key = {check.key: check.measured for check in found.checks}
    setpoint = ("velocity", "acceleration", "jerk")
    return {
        "verdict": found.verdict.value,
        "headline": to_json(found.headline),
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
        "limits": limits and {"old": _reached(limits.old), "new": _reached(limits.new)},
        "warnings": [to_json(warning) for warning in found.warnings],
    }


def _reached(one: JudgedLimits | None) -> Entry | None:
    if one is None:
        return None
    return {
        "acceleration": one.acceleration,
        "jerk": one.jerk,
        "settling_time": one.settling_time,
        "met": one.meets_requirements,
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


T = TypeVar("T")

SETPOINT_POINTS = 1500
"""Of the setpoint's curve."""

MOST_PLOTS = 6
"""Moves that are drawn."""

LARGE = ("settling time", "residual deviation", "peak deviation", "max force")
"""Checks of the first move that stand in the headline."""

PANELS = {Role.FORCE: ("force", "N"), Role.ACCELERATION: ("acceleration-measured", "m/s^2")}
"""Text and unit of a signal that is no position."""


def print_verification(told: Report, *, created: str, language: str) -> str:
    """Return the page, which works offline."""
    found, machine = told.found, told.found.record.machine
    words = words_for(machine, language)
    large = [one for one in found.checks if one.key in LARGE][: len(LARGE)]
    parts: dict[str, Sequence[Block]] = {
        "verdict": verdict_blocks(
            found.checks,
            words,
            headline=found.headline,
            is_met=found.verdict is Verdict.HOLDS,
            warnings=found.warnings,
            detail=say_detail(found, words),
            large=large,
        ),
        "overlay": [
            _plot(f"move-{place}", one, found, words)
            for place, one in enumerate(found.recorded[:MOST_PLOTS], start=1)
            if one.beside
        ],
        "differences": list_differences(told, words),
        "sources": [source_table(found.traces, _roles, words)],
    }
    return set_verification(
        parts,
        words,
        machine=machine.name,
        axes=[machine.axis],
        profiles=[found.record.profile],
        created=created,
    )


def set_verification(
    parts: Mapping[str, Sequence[Block]],
    words: Catalogue,
    *,
    machine: str,
    axes: Sequence[str],
    profiles: Sequence[Profile],
    created: str,
) -> str:
    """Return the page of parts, by key of their heading."""
    say = words.text
    hashes = (say("identity", name=one.name, hash=one.sha256[:12]) for one in profiles)
    return set_parts(
        words,
        "verify",
        parts,
        machine=machine,
        axis=f"{say('axis')} {', '.join(axes)}",
        identity=", ".join(hashes),
        created=created,
        disclaimer=say("verify-disclaimer"),
    )


def verdict_blocks(
    checks: Sequence[Check],
    words: Catalogue,
    *,
    headline: Message,
    is_met: bool,
    warnings: Sequence[Message],
    detail: str,
    large: Sequence[Check],
) -> list[Block]:
    """Return the headline with some large values, warnings, every check, and reasons."""
    values = tuple(
        BigValue(
            label=say_check(check, words),
            value=words.format.quantity(check.measured, check.unit),
            aside=f"– {say_verdict(check.verdict, words)}",
        )
        for check in large
    )
    said, heading = tuple(map(words.say, warnings)), words.say(headline)
    return [
        Headline(is_met=is_met, verdict=heading, detail=detail, values=values),
        *([Bullets(items=said, tone=Tone.WARNING)] if said else []),
        _checks(known_first(checks), words),
        Bullets(items=tuple(say_reasons(checks, words))),
    ]


def _checks(checks: Sequence[Check], words: Catalogue) -> Table:
    what, predicted = "verify-head-what", "verify-head-predicted"
    widths = {what: 1.6, predicted: 1.8, "permitted": 0.9, "measured": 1.4, "verdict": 0.9}
    columns = (
        Quantity(head, itemgetter(k), width=width)
        for k, (head, width) in enumerate(widths.items())
        if head != "permitted" or any(one.limit is not None for one in checks)
    )
    failed = tuple(k for k, one in enumerate(checks) if one.fails)
    rows = [check_row(one, words) for one in checks]
    return replace(table(words, "verify-caption-checks", columns, rows), strong_rows=failed)


def source_table(traces: Sequence[T], roles: Callable[[T], str], words: Catalogue) -> Table:
    """Return file, columns and hash of each trace."""
    columns = (
        Quantity("identify-head-file", "file"),
        Quantity("verify-head-columns", roles, width=2.0),
        Quantity("SHA-256", "sha256", width=2.0),
    )
    return table(words, "verify-caption-sources", columns, traces)


def _roles(trace: Trace) -> str:
    return ", ".join(f"{one.name} = {role.value}" for role, one in trace.channels.items())


def _plot(key: str, one: Recorded, found: Verification, words: Catalogue) -> LinePlot:
    """Setpoint's acceleration, then each signal over its predicted band and their difference."""
    motion, say = one.motion, words.text
    t = np.linspace(motion.begin, motion.until, SETPOINT_POINTS)
    setpoint = Curve(say("setpoint"), t - motion.begin, motion.sample(t)[:, 2], OTHER)
    panels = [Signals(say("verify-setpoint-acceleration"), "m/s^2", [setpoint])]
    band = found.rebuilt.machine.requirements.tcp_deviation
    judged = one.find(Role.TOOL) or one.find(Role.ENCODER)
    for signal in one.beside:
        x, measured, rows = signal.t - motion.begin, signal.deviation, signal.predicted
        curves = [
            Curve(say("line-measured"), x, measured, MAIN),
            Curve(say("verify-line-low"), x, rows.min(axis=0), THIRD),
            Curve(say("verify-line-high"), x, rows.max(axis=0), THIRD),
        ]
        name, unit = PANELS.get(signal.role, (signal.role.value, "m"))
        # The band is one of the tool, which the encoder stands for where it alone was recorded.
        limits = (band, -band) if signal is judged else ()
        missed = Curve(say("verify-line-difference"), x, measured - rows[0], FOURTH)
        panels += [
            Signals(say(f"verify-plot-{name}"), unit, curves, limits, say("verify-line-tool-band")),
            Signals(say("verify-plot-difference"), unit, [missed]),
        ]
    return line_plot(
        words,
        key,
        panels,
        x=(say("verify-plot-time"), "s"),
        text="verify-plot",
        link="moves",
        file=one.trace.file,
        begin=motion.begin,
    )
