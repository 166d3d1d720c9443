"""What traces say as one HTML page: the verdict first, measured over predicted, what differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import itemgetter

import numpy as np

from mtcommission.messages.catalogue import Catalogue
from mtcommission.sheet.document import (
    BigValue,
    Block,
    Bullets,
    Headline,
    LinePlot,
    Section,
    Table,
    Tone,
    document,
)
from mtcommission.sheet.html import set_html
from mtcommission.sheet.plots import FOURTH, MAIN, OTHER, THIRD, Curve, Signals, line_plot
from mtcommission.sheet.tables import Quantity, table
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
from mtcommission.verify.trace import Trace
from mtcommission.verify.verify import Verification

SETPOINT_POINTS = 1500
"""Of the setpoint's curve."""

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
    columns = (
        Quantity(f"verify-head-{head}", itemgetter(k), width=width)
        for k, (head, width) in enumerate(widths.items())
    )
    checks = known_first(found)
    failed = tuple(k for k, one in enumerate(checks) if one.verdict is Verdict.FAILS)
    rows = [check_row(one, words) for one in checks]
    return replace(table(words, "verify-caption-checks", columns, rows), strong_rows=failed)


def _sources(found: Verification, words: Catalogue) -> Table:
    def roles(trace: Trace) -> str:
        return ", ".join(f"{one.name} = {one.role.value}" for one in trace.channels)

    columns = (
        Quantity("identify-head-file", "file"),
        Quantity("verify-head-columns", roles, width=2.0),
        Quantity("identify-head-hash", "sha256", width=2.0),
    )
    return table(words, "verify-caption-sources", columns, found.traces)


def _plot(key: str, one: Recorded, found: Verification, words: Catalogue) -> LinePlot:
    """Setpoint's acceleration, then each signal over its predicted band and their difference."""
    motion, say = one.motion, words.text
    t = np.linspace(motion.begin, motion.until, SETPOINT_POINTS)
    setpoint = Curve(say("setpoint"), t - motion.begin, motion.sample(t)[:, 2], OTHER)
    panels = [Signals(say("verify-plot-acceleration"), "m/s^2", [setpoint])]
    band = found.rebuilt.machine.requirements.tcp_deviation
    for signal in one.beside:
        x, measured, rows = signal.t - motion.begin, signal.deviation, signal.predicted
        curves = [
            Curve(say("verify-line-measured"), x, measured, MAIN),
            Curve(say("verify-line-low"), x, rows.min(axis=0), THIRD),
            Curve(say("verify-line-high"), x, rows.max(axis=0), THIRD),
        ]
        name, unit = PANELS.get(signal.role, (signal.role.value, "m"))
        limits = (band, -band) if signal.is_position else ()
        missed = Curve(say("verify-line-difference"), x, measured - rows[0], FOURTH)
        panels += [
            Signals(say(f"verify-plot-{name}"), unit, curves, limits, say("verify-line-band")),
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
        verdict=found.headline,
    )


PANELS = {Role.FORCE: ("force", "N"), Role.ACCELERATION: ("acceleration-measured", "m/s^2")}
"""Text and unit of a signal that is no position."""
