"""What traces say as one HTML page: the verdict first, measured over predicted, what differs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import TypeVar

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.record.machine import Profile
from mtcommission.sheet.document import (
    BigValue,
    Block,
    Bullets,
    Headline,
    LinePlot,
    Table,
    Tone,
)
from mtcommission.sheet.html import set_parts
from mtcommission.sheet.plots import FOURTH, MAIN, OTHER, THIRD, Curve, Signals, line_plot
from mtcommission.sheet.tables import Quantity, table, words_for
from mtcommission.verify.beside import Recorded
from mtcommission.verify.checks import Check, Verdict
from mtcommission.verify.report import (
    Report,
    check_row,
    known_first,
    list_differences,
    say_check,
    say_detail,
    say_reasons,
    say_verdict,
)
from mtcommission.verify.trace import Role, Trace
from mtcommission.verify.verify import Verification

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
            aside=say_verdict(check.verdict, words),
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
    widths = {"what": 1.6, "predicted": 1.8, "allowed": 0.9, "measured": 1.4, "verdict": 0.9}
    columns = (
        Quantity(f"verify-head-{head}", itemgetter(k), width=width)
        for k, (head, width) in enumerate(widths.items())
        if head != "allowed" or any(one.limit is not None for one in checks)
    )
    failed = tuple(k for k, one in enumerate(checks) if one.fails)
    rows = [check_row(one, words) for one in checks]
    return replace(table(words, "verify-caption-checks", columns, rows), strong_rows=failed)


def source_table(traces: Sequence[T], roles: Callable[[T], str], words: Catalogue) -> Table:
    """Return file, columns and hash of each trace."""
    columns = (
        Quantity("identify-head-file", "file"),
        Quantity("verify-head-columns", roles, width=2.0),
        Quantity("identify-head-hash", "sha256", width=2.0),
    )
    return table(words, "verify-caption-sources", columns, traces)


def _roles(trace: Trace) -> str:
    return ", ".join(f"{one.name} = {role.value}" for role, one in trace.channels.items())


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
