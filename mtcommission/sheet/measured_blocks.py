"""What was measured, as blocks that the sheet and the page of ``identify`` share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.record.schema.identified import (
    IdentifiedPart,
    MeasuredResponseEntry,
)
from mtcommission.record.schema.machine import ModeEntry
from mtcommission.sheet.model import (
    Bullets,
    Column,
    Table,
    Tone,
    name_and_numbers,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.units.axis_units import LINEAR, ROTARY, AxisUnits

Array = NDArray[np.float64]

INFORMATION = (
    *("identify-by-", "identify-hold", "identify-band-given", "identify-loudest-axis"),
    *("identify-klipper-choice", "identify-core-xy", "identify-axis-of-file"),
    *("identify-response-taken", "identify-last-response-taken"),
)
"""How the kinds of messages begin that warn of nothing."""
SHOWN_DIGITS = 16
"""Of a hash; the profile's text has it whole."""


def plus_minus(one: Estimate | None, unit: str, words: Catalogue) -> str:
    """Return a value with two standard errors, in its unit."""
    if one is None:
        return words.text("identify-not-known")
    scale = words.format.scale(abs(one.value), unit)
    value, error = one.value / scale.size, 2.0 * one.sigma / scale.size
    if not np.isfinite(error):  # nothing determines it
        return words.format.with_unit(f"{words.format.number(value)} ± ∞", scale.unit)
    digits = 3 if error == 0.0 or value == 0.0 else int(np.ceil(np.log10(abs(value / error)))) + 2
    shown = words.format.number(value, digits=int(np.clip(digits, 2, 6)))
    reach = words.format.number(error, digits=2)
    return words.format.with_unit(f"{shown} ± {reach}", scale.unit)


def facts(part: IdentifiedPart, words: Catalogue) -> tuple[tuple[str, str, str], ...]:
    """Return what was found over all modes: name, value, and where it comes from."""
    say, unit, because = words.text, axis_of(words), part.spread.because
    rows: list[tuple[str, str, str]] = []
    if not part.base_excited:  # a held motor shows neither
        mass = plus_minus(part.moving_mass, unit.mass.si, words)
        delay = plus_minus(part.delay, "s", words)
        rows = [
            (say("identify-mass"), mass, say("identify-mass-meaning")),
            (say("identify-delay"), delay, say("identify-delay-meaning")),
        ]
    if part.lag:
        value = plus_minus(part.lag, "s", words)
        rows.append((say("identify-lag"), value, say("identify-lag-meaning")))
    if part.band_hz:
        low, high = part.band_hz
        value = say("identify-band-from-to", low=low, high=high)
        is_given = any(one.kind == "identify-band-given" for one in part.warnings)
        why = say("identify-band-asked" if is_given else "identify-band-meaning")
        rows.append((say("identify-band"), value, why))
    if part.misfit is not None:
        value = words.format.number(part.misfit, digits=3)
        rows.append((say("identify-misfit"), value, say("identify-misfit-meaning")))
    for place, (kind, spread) in enumerate(
        (("frequency", part.spread.frequency), ("damping", part.spread.damping))
    ):
        why = words.say(because[place]) if because else say("identified-by-profile")
        rows.append((say(f"identify-spread-{kind}"), f"± {words.format.percent(spread)}", why))
    return tuple(rows)


def result_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return mass, delay, band, misfit and spreads."""
    return Table(
        caption=words.text("identify-caption-result"),
        columns=(
            Column(head="", width=1.2),
            Column(head=words.text("identify-head-value"), is_number=True),
            Column(head=words.text("identify-head-why"), width=2.4),
        ),
        rows=facts(part, words),
    )


def mode_heads(words: Catalogue) -> tuple[str, ...]:
    """Return the heads of a table of modes."""
    kinds = ("mode", "frequency", "damping", "encoder", "tool")
    return tuple(words.text(f"identify-head-{kind}") for kind in kinds)


def mode_row(
    mode: MeasuredMode, part: IdentifiedPart, words: Catalogue, *, stated: ModeEntry | None = None
) -> tuple[str, ...]:
    """Return a row of such a table; ``stated`` is the mode in the profile."""
    gain = "" if part.base_excited else axis_of(words).gain.si
    tool = plus_minus(mode.tcp_gain, gain, words)
    if mode.tcp_gain is None and stated is not None:
        tool = words.text("identified-assumed", value=words.format.quantity(stated.tcp_gain, gain))
    return (
        mode.name,
        plus_minus(mode.frequency_hz, "Hz", words),
        plus_minus(mode.damping_ratio, "", words),
        plus_minus(mode.measured_gain, gain, words),
        tool,
    )


def mode_tables(
    part: IdentifiedPart, words: Catalogue, *, inside: Mapping[str, ModeEntry]
) -> tuple[Table, ...]:
    """Return the modes over all states and, where there are several, in each.

    Parameters
    ----------
    part
        What was measured.
    words
        Language.
    inside
        Modes of the profile, by name.
    """
    first, *others = mode_heads(words)
    tables = [
        Table(
            caption=words.text("identify-caption-modes"),
            columns=name_and_numbers(first, others, width=1.0),
            rows=tuple(
                mode_row(mode, part, words, stated=inside.get(mode.name)) for mode in part.modes
            ),
        )
    ]
    if len(part.states) > 1:
        head = words.text("identify-head-state")
        rows = [
            (state.name, *mode_row(mode, part, words))
            for name in [mode.name for mode in part.modes]
            for state in part.states
            for mode in state.modes
            if mode.name == name
        ]
        columns = name_and_numbers(first, others, width=1.0)
        tables.append(
            Table(
                caption=words.text("identify-caption-states"),
                columns=(Column(head=head, width=1.5), *columns),
                rows=tuple(rows),
            )
        )
    return tuple(tables)


def remarks(part: IdentifiedPart, words: Catalogue) -> tuple[Bullets, ...]:
    """Return what to mind and what to measure better, then how it was done."""
    doubts, notes = doubts_and_notes(part)
    return tuple(
        Bullets(items=tuple(words.say(one) for one in some), tone=tone)
        for some, tone in ((doubts, Tone.WARNING), (notes, Tone.NOTE))
        if some
    )


def doubts_and_notes(part: IdentifiedPart) -> tuple[tuple[Message, ...], tuple[Message, ...]]:
    """Return what to mind and what to measure better; and how something was done."""
    notes = tuple(one for one in part.warnings if one.kind.startswith(INFORMATION))
    return tuple(one for one in part.warnings if one not in notes), notes


def check_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return how well the model explains the records it came from, and one held back."""
    return Table(
        caption=words.text("identify-caption-check"),
        columns=(
            Column(head=words.text("identify-head-file"), width=2.0),
            Column(head=words.text("identify-head-explained"), is_number=True),
            Column(head=words.text("identify-head-held-back")),
        ),
        rows=tuple(
            (
                one.record,
                words.format.percent(one.explained),
                words.text("terminal-yes" if one.held_back else "terminal-no"),
            )
            for one in part.checks
        ),
    )


def file_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return what was read."""
    heads = ("identify-head-file", "identify-head-sensor", "identify-head-format")
    return Table(
        caption=words.text("identify-caption-files"),
        columns=(
            *(Column(head=words.text(head), width=1.5) for head in heads),
            Column(head=words.text("identify-head-hash"), width=1.5),
        ),
        rows=tuple(
            (
                short_name(one.name),
                words.text(f"identify-sensor-{one.sensor}"),
                words.say(part.formats[one.name]) if one.name in part.formats else "–",
                one.sha256[:SHOWN_DIGITS],
            )
            for one in part.sources
        ),
    )


def plots(part: IdentifiedPart, words: Catalogue) -> tuple[LinePlot, ...]:
    """Return measured points over fitted curves."""
    return tuple(
        _plot(f"fit-{number}", one, words) for number, one in enumerate(part.responses, start=1)
    )


def _plot(key: str, one: MeasuredResponseEntry, words: Catalogue) -> LinePlot:
    say, f, curve = words.text, np.array(one.frequency_hz), np.array(one.curve_hz)
    size = np.array(one.magnitude)

    def panel(kind: str, *lines: Line, unit: str = "", borders: tuple[Border, ...] = ()) -> Panel:
        label = say(f"identify-plot-{kind}", unit=unit) if unit else say(f"identify-plot-{kind}")
        return Panel(y_label=label, lines=lines, borders=borders)

    def measured(y: Array) -> Line:
        return Line(label=say("identify-line-measured"), x=f, y=y, style=0)

    def fitted(y: Array) -> Line:
        return Line(label=say("identify-line-fitted"), x=curve, y=y, style=4)

    def reach(y: Array) -> Line:
        return Line(label=say("identify-line-error"), x=f, y=y, style=2)

    lines = []
    if one.error is not None:
        error = 2.0 * np.sqrt(2.0) * np.array(one.error)
        lines += [reach(np.log10(y)) for y in (size + error, np.maximum(size - error, 0.2 * size))]
    lines += [fitted(np.log10(one.curve_magnitude)), measured(np.log10(size))]
    kind = "magnitude" if one.unit else "density"
    panels = [panel(kind, *lines, unit=one.unit)]
    if one.phase_deg is not None and one.curve_phase_deg is not None:
        both = fitted(np.array(one.curve_phase_deg)), measured(np.array(one.phase_deg))
        panels.append(panel("phase", *both))
    if one.coherence is not None:
        panels.append(panel("coherence", measured(np.array(one.coherence))))
    if one.missed is not None:
        limit = (Border(label="2", y=2.0),)
        panels.append(panel("misfit", measured(np.array(one.missed)), borders=limit))
    about = {} if one.misfit is None else {"misfit": one.misfit}
    what = "plot" if about else "spectrum"
    return LinePlot(
        key=key,
        caption=say(f"identify-{what}-caption", file=short_name(one.name)),
        alt=say(f"identify-{what}-alt", file=short_name(one.name), **about),
        x_label=say("identify-plot-frequency"),
        x_is_log=True,
        link="fits",
        panels=tuple(panels),
    )


def short_name(name: str) -> str:
    """Return a file without its folder."""
    return name.rpartition("/")[2].rpartition("\\")[2]


def axis_of(words: Catalogue) -> AxisUnits:
    """Return what masses, forces and lengths are on the axis."""
    return ROTARY if words.rotary else LINEAR
