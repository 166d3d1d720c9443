"""What traces say as one HTML page: the verdict first, measured over predicted, what differs."""

from __future__ import annotations

from collections.abc import Sequence

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
    Paragraph,
    Section,
    Table,
    Tone,
    document,
)
from mtcommission.sheet.html import set_html
from mtcommission.verify.beside import Beside
from mtcommission.verify.checks import Verdict
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.motions import Recorded
from mtcommission.verify.new_limits import NewLimits
from mtcommission.verify.refine import Parameter, Refined
from mtcommission.verify.trace import Array, Role
from mtcommission.verify.verify import Verification
from mtcommission.verify.wording import (
    HEADS,
    check_row,
    limit_rows,
    parameter_row,
    say_check,
    say_feedforward,
    say_test,
    say_verdict,
)

MOST_POINTS = 1500
"""Of a curve."""

MOST_PLOTS = 6
"""Moves that are drawn."""


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
    record = found.record
    axis = record.machine
    words = Catalogue(language, rotary=axis.motion == "rotary", follows=axis.follows)
    say = words.text
    warnings = tuple(words.say(warning) for warning in found.warnings)
    sections = [
        Section(
            key="verdict",
            heading=say("verify-part-verdict"),
            blocks=(
                _headline(found, words),
                *([Bullets(items=warnings, tone=Tone.WARNING)] if warnings else []),
                _checks(found, words),
            ),
        ),
        Section(key="overlay", heading=say("verify-part-overlay"), blocks=_plots(found, words)),
        *_differences(found, refined, fed, limits, words),
        Section(
            key="sources", heading=say("verify-part-sources"), blocks=(_sources(found, words),)
        ),
    ]
    page = document(
        words,
        script_note="identify-script-note",
        title=say("verify-title"),
        machine=record.machine.name,
        axis=f"{say('axis')} {record.machine.axis}",
        identity=say("identity", name=record.profile.name, hash=record.profile.sha256[:12]),
        created=created,
        disclaimer=say("verify-disclaimer"),
        sections=tuple(sections),
    )
    return set_html(page, decimal_mark=words.format.decimal_mark)


def _headline(found: Verification, words: Catalogue) -> Headline:
    shown = [
        check
        for check in found.checks
        if check.key in ("settling time", "residual deviation", "peak deviation", "max force")
    ][:4]
    return Headline(
        is_met=found.verdict is Verdict.HOLDS,
        verdict=words.say(found.headline),
        detail=words.text("verify-detail", moves=len(found.recorded), obeyed=_obeyed(found)),
        values=tuple(
            BigValue(
                label=say_check(check, words),
                value=words.format.quantity(check.measured, check.unit),
                aside=say_verdict(check.verdict, words),
            )
            for check in shown
        ),
    )


def _obeyed(found: Verification) -> str:
    return {True: "yes", False: "no", None: "unknown"}[found.obeyed]


def _checks(found: Verification, words: Catalogue) -> Table:
    widths = (1.4, 1.5, 0.9, 1.2, 2.2)
    rows = tuple(check_row(check, words) for check in found.checks)
    failed = [k for k, check in enumerate(found.checks) if check.verdict is Verdict.FAILS]
    return Table(
        caption=words.text("verify-caption-checks"),
        columns=tuple(
            Column(head=words.text(f"verify-head-{head}"), width=width)
            for head, width in zip(HEADS, widths, strict=True)
        ),
        rows=rows,
        strong_rows=tuple(failed),
    )


def _differences(
    found: Verification,
    refined: Refined,
    fed: FeedForward | None,
    limits: NewLimits | None,
    words: Catalogue,
) -> list[Section]:
    """What is different from the record: parameters, and the limits that follow."""
    say = words.text
    blocks: list[Block] = []
    if refined.parameters:
        blocks.append(_parameters("parameter", refined.parameters, words))
    notes = [say_test(refined, words)]
    if found.unexplained is not None:
        notes.insert(0, say("verify-unexplained", share=found.unexplained))
    blocks += [Paragraph(text=note, tone=Tone.NOTE) for note in notes if note]
    if fed is not None:
        blocks.append(_parameters("feedforward", fed.values, words))
        blocks.append(Paragraph(text=say_feedforward(fed, words), tone=Tone.NOTE))
    if limits is not None:
        if limits.failure:
            blocks.append(Paragraph(text=words.say(limits.failure), tone=Tone.WARNING))
        blocks.append(
            Table(
                caption=say("verify-caption-limits"),
                columns=(
                    Column(head="", width=1.4),
                    Column(head=say("verify-head-old"), is_number=True),
                    Column(head=say("verify-head-new"), is_number=True),
                ),
                rows=tuple(limit_rows(limits, words)),
            )
        )
    if not blocks:
        return []
    return [
        Section(key="differences", heading=say("verify-part-differences"), blocks=tuple(blocks))
    ]


def _parameters(kind: str, values: Sequence[Parameter], words: Catalogue) -> Table:
    say = words.text
    return Table(
        caption=say(f"verify-caption-{kind}s"),
        columns=(
            Column(head=say(f"verify-head-{kind}"), width=1.6),
            Column(head=say("verify-head-old"), is_number=True),
            Column(head=say("verify-head-new"), is_number=True, width=1.6),
            Column(head=say("verify-head-note"), width=1.6),
        ),
        rows=tuple(parameter_row(one, words) for one in values),
        strong_rows=tuple(place for place, one in enumerate(values) if one.has_changed),
    )


def _sources(found: Verification, words: Catalogue) -> Table:
    return Table(
        caption=words.text("verify-caption-sources"),
        columns=(
            Column(head=words.text("identify-head-file")),
            Column(head=words.text("verify-head-columns"), width=2.0),
            Column(head=words.text("identify-head-hash"), width=2.0),
        ),
        rows=tuple(
            (
                trace.file,
                ", ".join(f"{one.name} = {one.role.value}" for one in trace.channels),
                trace.sha256,
            )
            for trace in found.traces
        ),
    )


def _plots(found: Verification, words: Catalogue) -> tuple[Block, ...]:
    return tuple(
        _plot(f"move-{place}", one, found, words)
        for place, one in enumerate(found.recorded[:MOST_PLOTS], start=1)
        if one.beside
    )


def _plot(key: str, one: Recorded, found: Verification, words: Catalogue) -> LinePlot:
    """Setpoint's acceleration, then each signal over its predicted band and their difference."""
    say, form, motion = words.text, words.format, one.motion
    rotary = words.rotary
    t = np.linspace(motion.begin, motion.until, MOST_POINTS)
    x = 1e3 * (t - motion.begin)
    panels = [
        _panel(
            words, "verify-plot-acceleration", "rad/s^2" if rotary else "m/s^2",
            [("setpoint", x, motion.sample(t)[:, 2], 1)],
        )
    ]  # fmt: skip
    band = found.rebuilt.machine.requirements.tcp_deviation
    for signal in one.beside:
        length = "rad" if rotary else "m"
        unit = {
            Role.FORCE: "N m" if rotary else "N",
            Role.ACCELERATION: f"{length}/s^2",
        }.get(signal.role, length)
        measured, low, high = _thinned(signal)
        own = 1e3 * (_points(signal) - motion.begin)
        is_acceleration = signal.role is Role.ACCELERATION
        kind = f"verify-plot-{signal.role.value}{'-measured' if is_acceleration else ''}"
        panels.append(
            _panel(
                words, kind, unit,
                [
                    ("verify-line-measured", own, measured, 4),
                    ("verify-line-low", own, low, 2),
                    ("verify-line-high", own, high, 2),
                ],
                borders=(band,) if signal.is_position else (),
            )
        )  # fmt: skip
        nominal = _pick(signal, signal.predicted_deviation[0])
        panels.append(
            _panel(
                words, "verify-plot-difference", unit,
                [("verify-line-difference", own, measured - nominal, 3)],
            )
        )  # fmt: skip
    return LinePlot(
        key=key,
        caption=say("verify-plot-caption", file=one.trace.file, begin=motion.begin),
        alt=say("verify-plot-alt", verdict=words.say(found.headline)),
        x_label=say("verify-plot-time", unit=form.with_unit("", "ms").strip()),
        x_is_log=False,
        link="moves",
        panels=tuple(panels),
    )


def _panel(
    words: Catalogue,
    kind: str,
    unit: str,
    rows: list[tuple[str, Array, Array, int]],
    *,
    borders: tuple[float, ...] = (),
) -> Panel:
    scale = words.format.scale_for([y for _, _, y, _ in rows], unit)
    return Panel(
        y_label=words.text(kind, unit=scale.unit),
        lines=tuple(
            Line(label=words.text(label), x=x, y=y / scale.size, style=style)
            for label, x, y, style in rows
        ),
        borders=tuple(
            Border(label=words.text("verify-line-band"), y=sign * value / scale.size)
            for value in borders
            for sign in (1.0, -1.0)
        ),
    )


def _stride(signal: Beside) -> int:
    return max(signal.t.size // MOST_POINTS, 1)


def _points(signal: Beside) -> Array:
    return signal.t[:: _stride(signal)]


def _pick(signal: Beside, values: Array) -> Array:
    return values[:: _stride(signal)]


def _thinned(signal: Beside) -> tuple[Array, Array, Array]:
    rows = signal.predicted_deviation
    return (
        _pick(signal, signal.deviation),
        _pick(signal, np.asarray(rows.min(axis=0))),
        _pick(signal, np.asarray(rows.max(axis=0))),
    )
