"""What traces say as one HTML page: the verdict first, measured over predicted, what differs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from mtcommission.messages.catalogue import Catalogue
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
from mtcommission.verify.beside import Recorded
from mtcommission.verify.checks import Verdict
from mtcommission.verify.columns import Role
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.refine import Refined
from mtcommission.verify.renew import NewLimits
from mtcommission.verify.report import (
    check_row,
    known_first,
    list_differences,
    say_check,
    say_detail,
    say_reasons,
    say_verdict,
)
from mtcommission.verify.trace import Array
from mtcommission.verify.verify import Verification

MOST_POINTS = 1500
"""Of a curve."""

MOST_PLOTS = 6
"""Moves that are drawn."""

LARGE = ("settling time", "residual deviation", "peak deviation", "max force")
"""Checks of the first move that stand in the headline."""


def print_verification(
    found: Verification,
    refined: Refined,
    fed: FeedForward | None,
    limits: NewLimits | None,
    *,
    created: str,
    language: str,
) -> str:
    """Return the page, which works offline."""
    record, machine = found.record, found.record.machine
    words = Catalogue(language, rotary=machine.motion == "rotary", follows=machine.follows)
    say = words.text
    warnings = tuple(map(words.say, found.warnings))
    parts: dict[str, Sequence[Block]] = {
        "verdict": (
            _headline(found, words),
            *([Bullets(items=warnings, tone=Tone.WARNING)] if warnings else []),
            _checks(found, words),
            Bullets(items=tuple(say_reasons(found, words))),
        ),
        "overlay": [
            _plot(f"move-{place}", one, found, words)
            for place, one in enumerate(found.recorded[:MOST_PLOTS], start=1)
            if one.beside
        ],
        "differences": list_differences(found, refined, fed, limits, words),
        "sources": [_sources(found, words)],
    }
    page = document(
        words,
        script_note="identify-script-note",
        title=say("verify-title"),
        machine=machine.name,
        axis=f"{say('axis')} {machine.axis}",
        identity=say("identity", name=record.profile.name, hash=record.profile.sha256[:12]),
        created=created,
        disclaimer=say("verify-disclaimer"),
        sections=tuple(
            Section(key=key, heading=say(f"verify-part-{key}"), blocks=tuple(blocks))
            for key, blocks in parts.items()
            if blocks
        ),
    )
    return set_html(page, decimal_mark=words.format.decimal_mark)


def _headline(found: Verification, words: Catalogue) -> Headline:
    return Headline(
        is_met=found.verdict is Verdict.HOLDS,
        verdict=words.say(found.headline),
        detail=say_detail(found, words),
        values=tuple(
            BigValue(
                label=say_check(check, words),
                value=words.format.quantity(check.measured, check.unit),
                aside=say_verdict(check.verdict, words),
            )
            for check in [one for one in found.checks if one.key in LARGE][: len(LARGE)]
        ),
    )


def _checks(found: Verification, words: Catalogue) -> Table:
    widths = {"what": 1.6, "predicted": 1.8, "allowed": 0.9, "measured": 1.4, "verdict": 0.9}
    checks = known_first(found)
    return Table(
        caption=words.text("verify-caption-checks"),
        columns=tuple(
            Column(head=words.text(f"verify-head-{head}"), width=width)
            for head, width in widths.items()
        ),
        rows=tuple(check_row(check, words) for check in checks),
        strong_rows=tuple(k for k, one in enumerate(checks) if one.verdict is Verdict.FAILS),
    )


def _sources(found: Verification, words: Catalogue) -> Table:
    heads = {"identify-head-file": 1.0, "verify-head-columns": 2.0, "identify-head-hash": 2.0}
    return Table(
        caption=words.text("verify-caption-sources"),
        columns=tuple(Column(head=words.text(head), width=width) for head, width in heads.items()),
        rows=tuple(
            (
                trace.file,
                ", ".join(f"{one.name} = {one.role.value}" for one in trace.channels),
                trace.sha256,
            )
            for trace in found.traces
        ),
    )


def _plot(key: str, one: Recorded, found: Verification, words: Catalogue) -> LinePlot:
    """Setpoint's acceleration, then each signal over its predicted band and their difference."""
    motion = one.motion
    length, force = ("rad", "N m") if words.rotary else ("m", "N")
    units = {Role.FORCE: force, Role.ACCELERATION: f"{length}/s^2"}
    t = np.linspace(motion.begin, motion.until, MOST_POINTS)
    setpoint = Line(label="setpoint", x=1e3 * (t - motion.begin), y=motion.sample(t)[:, 2], style=1)
    panels = [_panel(words, "acceleration", f"{length}/s^2", [setpoint])]
    band = found.rebuilt.machine.requirements.tcp_deviation
    for signal in one.beside:
        unit = units.get(signal.role, length)
        stride = max(signal.t.size // MOST_POINTS, 1)
        x = 1e3 * (signal.t[::stride] - motion.begin)
        rows = signal.predicted[:, ::stride]
        measured = signal.deviation[::stride]
        is_acceleration = signal.role is Role.ACCELERATION

        def line(name: str, y: Array, style: int, x: Array = x) -> Line:
            return Line(label=f"verify-line-{name}", x=x, y=y, style=style)

        panels += [
            _panel(
                words,
                f"{signal.role.value}{'-measured' if is_acceleration else ''}",
                unit,
                [
                    line("measured", measured, 4),
                    line("low", rows.min(axis=0), 2),
                    line("high", rows.max(axis=0), 2),
                ],
                borders=(band, -band) if signal.is_position else (),
            ),
            _panel(words, "difference", unit, [line("difference", measured - rows[0], 3)]),
        ]
    return LinePlot(
        key=key,
        caption=words.text("verify-plot-caption", file=one.trace.file, begin=motion.begin),
        alt=words.text("verify-plot-alt", verdict=words.say(found.headline)),
        x_label=words.text("verify-plot-time", unit=words.format.with_unit("", "ms").strip()),
        x_is_log=False,
        link="moves",
        panels=tuple(panels),
    )


def _panel(
    words: Catalogue, kind: str, unit: str, lines: Iterable[Line], *, borders: Sequence[float] = ()
) -> Panel:
    """Curves in SI, labelled by the names of texts, in the unit that fits them."""
    lines = list(lines)
    scale = words.format.scale_for([line.y for line in lines], unit)
    return Panel(
        y_label=words.text(f"verify-plot-{kind}", unit=scale.unit),
        lines=tuple(
            replace(line, label=words.text(line.label), y=line.y / scale.size) for line in lines
        ),
        borders=tuple(
            Border(label=words.text("verify-line-band"), y=value / scale.size) for value in borders
        ),
    )
