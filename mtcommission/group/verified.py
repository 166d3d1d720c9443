"""What recorded circles say, for terminal, page and JSON: every table and sentence once."""

from __future__ import annotations

import numpy as np

from mtcommission.group.verify import CircleBeside, CircleVerification
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message, to_json
from mtcommission.sheet.document import (
    BigValue,
    Block,
    Border,
    Bullets,
    Column,
    Headline,
    Line,
    LinePlot,
    Panel,
    Section,
    Table,
    Tone,
    document,
)
from mtcommission.sheet.html import set_html
from mtcommission.verify.checks import Check, Verdict
from mtcommission.verify.report import Entry, check_cells, check_entry, say_verdict

MOST_POINTS = 1500
"""Of a curve: those of one turn."""

MOST_PLOTS = 6
"""Circles that are drawn."""

MOST_LARGE = 4
"""Values in the headline."""

DIRECTIONS = {1: "counterclockwise", -1: "clockwise"}


def say_headline(found: CircleVerification) -> Message:
    """Return the verdict; it names what cannot be told, unless something does not hold."""
    unknown = [one for one in found.checks if one.decides and one.verdict is Verdict.UNKNOWN]
    if found.verdict is not Verdict.UNKNOWN or not unknown:
        return Message(f"verify-verdict-{found.verdict.value.replace(' ', '-')}")
    return Message("verify-verdict-except", what=tuple(dict.fromkeys(map(what_of, unknown))))


def what_of(check: Check) -> Message:
    """Return what was checked, of whichever circle."""
    return Message(f"group-circle-{check.key.replace(' ', '-')}", name=check.mode)


def rows_of(found: CircleVerification, words: Catalogue) -> list[tuple[str, ...]]:
    """Return circle and promise, prediction with its corners, measured value and verdict."""
    rows = list[tuple[str, ...]]()
    for check in found.checks:
        predicted, _, measured, verdict = check_cells(check, words)
        name = f"{check.move}: {words.say(what_of(check))}"
        rows.append((name, predicted, measured, verdict))
    return rows


def say_found(found: CircleVerification) -> list[Message]:
    """Return each circle, why something does not hold or cannot be told, and what was found."""
    record, said = found.record, list[Message]()
    for number, one in enumerate(found.circles, start=1):
        own = one.fitted
        said.append(
            Message(
                "group-circle-recorded",
                number=number,
                file=own.trace.file,
                radius=own.radius,
                feed=own.feed,
                direction=DIRECTIONS[own.direction],
                turns=own.turns,
            )
        )
    for reason in dict.fromkeys((one.verdict, one.reason) for one in found.checks):
        verdict, why = reason
        if verdict is not Verdict.HOLDS:
            which = [one for one in found.checks if (one.verdict, one.reason) == reason]
            said.append(
                Message(
                    "group-circle-reason",
                    verdict=Message(f"verify-verdict-{verdict.value.replace(' ', '-')}"),
                    why=why,
                    what=tuple(dict.fromkeys(map(what_of, which))),
                )
            )
    for check in found.checks:
        unsure = check.uncertainty or 0.0
        if check.key == "delay" and abs(check.measured or 0.0) > unsure:
            first, second = record.plane
            by = check.measured or 0.0
            later, sooner = (second, first) if by > 0.0 else (first, second)
            said.append(
                Message(
                    "group-delay-found",
                    number=check.move,
                    later=later,
                    sooner=sooner,
                    by=abs(by),
                    uncertainty=unsure,
                )
            )
    if found.squareness is None:
        said.append(Message("group-squareness-unknown"))
    else:
        square = found.squareness
        said.append(
            Message(
                "group-squareness-found",
                value=1e6 * square.value,
                uncertainty=1e6 * square.uncertainty,
            )
        )
    if found.scales is not None:
        mean, apart = found.scales
        said.append(
            Message(
                "group-scales-found",
                mean=1e6 * mean.value,
                apart=2e6 * apart.value,
                first=record.plane[0],
                second=record.plane[1],
            )
        )
    return said


def circles_entry(found: CircleVerification) -> Entry:
    """Return what was found as JSON has it; SI."""
    first = found.circles[0].fitted
    square = found.squareness
    return {
        "verdict": found.verdict.value,
        "record": found.record.checksum,
        "traces": [{"file": one.file, "sha256": one.sha256} for one in found.traces],
        "setpoint": {
            "velocity": first.feed,
            "acceleration": first.feed**2 / first.radius,
            "jerk": first.feed**3 / first.radius**2,
            "obeyed": None,
        },
        "circles": [_circle_entry(one, found) for one in found.circles],
        "squareness": square and {"value": square.value, "uncertainty": square.uncertainty},
        "scales": found.scales
        and [{"value": one.value, "uncertainty": one.uncertainty} for one in found.scales],
        "checks": [_named(one) for one in found.checks],
        "noise_floor": max(one.fitted.noise for one in found.circles),
        "refined": {},
        "warnings": [to_json(warning) for warning in found.warnings],
    }


def _named(check: Check) -> Entry:
    mode = f" {check.mode}" if check.mode else ""
    name = f"circle {check.move}: {check.key}{mode}"
    return {**check_entry(check), "name": name, "move": None, "mode": None, "circle": check.move}


def _circle_entry(one: CircleBeside, found: CircleVerification) -> Entry:
    own = one.fitted
    peaks = {name: own.peak(place) for place, name in enumerate(found.record.plane)}
    return {
        "file": own.trace.file,
        "radius": own.radius,
        "radius_is_assumed": own.is_assumed,
        "feed": own.feed,
        "direction": DIRECTIONS[own.direction],
        "turns": own.turns,
        "centre": list(own.centre),
        "radius_deviation": own.mean.value,
        "gain_ellipse": own.gain.value,
        "delay_ellipse": one.skew.value,
        "quadrant_peak": {name: peak.value for name, peak in peaks.items() if peak},
    }


def print_circles(found: CircleVerification, *, created: str, language: str) -> str:
    """Return the page, which works offline."""
    words, record = Catalogue(language), found.record
    say, form = words.text, words.format
    axes = ", ".join(axis.name for axis in record.axes)
    sentences = tuple(map(words.say, say_found(found)))
    warnings = tuple(map(words.say, found.warnings))
    order = (Verdict.FAILS, Verdict.UNKNOWN, Verdict.HOLDS)
    known = [one for one in found.checks if one.measured is not None]
    largest = sorted(known, key=lambda one: order.index(one.verdict))[:MOST_LARGE]
    heads = ("what", "predicted", "measured", "verdict")
    table = Table(
        caption=say("verify-caption-checks"),
        columns=tuple(Column(head=say(f"verify-head-{head}")) for head in heads),
        rows=tuple(rows_of(found, words)),
        strong_rows=tuple(k for k, one in enumerate(found.checks) if one.verdict is Verdict.FAILS),
    )
    headline = Headline(
        is_met=found.verdict is Verdict.HOLDS,
        verdict=words.say(say_headline(found)),
        detail=sentences[0],
        values=tuple(
            BigValue(
                label=f"{one.move}: {words.say(what_of(one))}",
                value=form.quantity(one.measured, one.unit),
                aside=say_verdict(one.verdict, words),
            )
            for one in largest
        ),
    )
    sources = Table(
        caption=say("verify-caption-sources"),
        columns=tuple(
            Column(head=say(head))
            for head in ("identify-head-file", "verify-head-columns", "identify-head-hash")
        ),
        rows=tuple(
            (
                one.file,
                ", ".join(f"{name} = {own}" for own, name in one.columns.items()),
                one.sha256,
            )
            for one in found.traces
        ),
    )
    parts: dict[str, tuple[Block, ...]] = {
        "verdict": (
            headline,
            *([Bullets(items=warnings, tone=Tone.WARNING)] if warnings else []),
            table,
            Bullets(items=sentences),
        ),
        "overlay": tuple(
            _plot(number, one, found, words)
            for number, one in enumerate(found.circles[:MOST_PLOTS], start=1)
        ),
        "sources": (sources,),
    }
    page = document(
        words,
        script_note="identify-script-note",
        title=say("verify-title"),
        machine=record.axes[0].machine.name,
        axis=f"{say('axis')} {axes}",
        identity=", ".join(
            say("identity", name=axis.profile.name, hash=axis.profile.sha256[:12])
            for axis in record.axes
        ),
        created=created,
        disclaimer=say("verify-disclaimer"),
        sections=tuple(
            Section(key=key, heading=say(f"verify-part-{key}"), blocks=blocks)
            for key, blocks in parts.items()
        ),
    )
    return set_html(page, decimal_mark=form.decimal_mark)


def _plot(number: int, one: CircleBeside, found: CircleVerification, words: Catalogue) -> LinePlot:
    """Deviation of the radius over the angle, measured, fitted and predicted, of the first turn."""
    own = one.fitted
    within = np.flatnonzero(np.abs(own.angle - own.angle[0]) <= 2.0 * np.pi)
    within = within[:: max(within.size // MOST_POINTS, 1)]
    degrees = np.mod(own.angle[within], 2.0 * np.pi) * 180.0 / np.pi
    order = np.argsort(degrees)
    curves = {"measured": own.deviation, "fitted": own.fitted, "predicted": one.predicted}
    scale = words.format.scale_for([curve[within] for curve in curves.values()], "m")
    tolerance = found.record.tolerance / scale.size
    return LinePlot(
        key=f"circle-{number}",
        caption=words.say(say_found(found)[number - 1]),
        alt=words.text("verify-plot-alt", verdict=words.say(say_headline(found))),
        x_label=words.text("group-plot-angle"),
        x_is_log=False,
        link="circles",
        panels=(
            Panel(
                y_label=words.text("group-plot-deviation", unit=scale.unit),
                lines=tuple(
                    Line(
                        label=words.text(f"group-line-{name}"),
                        x=degrees[order],
                        y=curve[within][order] / scale.size,
                        style=style,
                    )
                    for style, (name, curve) in zip((4, 2, 3), curves.items(), strict=True)
                ),
                borders=tuple(
                    Border(label=words.text("verify-line-band"), y=value)
                    for value in (tolerance, -tolerance)
                ),
            ),
        ),
    )
