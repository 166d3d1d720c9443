"""What was measured: blocks that the sheet and the page of ``identify`` share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from operator import itemgetter
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import motion_unit
from mtcommission.machine.checks import say_filter
from mtcommission.machine.identified import Estimate, MeasuredMode, ToolSensor
from mtcommission.record.identified import (
    IdentifiedPart,
    MeasuredResponseEntry,
)
from mtcommission.record.machine import ModeEntry
from mtcommission.sheet.document import (
    Block,
    Bullets,
    LinePlot,
    Paragraph,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.plots import MAIN, SETPOINT, THIRD, Array, Curve, Signals, line_plot
from mtcommission.sheet.tables import (
    ACCELERATION,
    FREQUENCY,
    RESIDUAL,
    SETTLING,
    Quantity,
    show,
    table,
)

if TYPE_CHECKING:
    from mtcommission.record.record import Record

INFORMATION = (
    *("identify-by-", "identify-hold", "identify-band-given", "identify-loudest-axis"),
    *("identify-klipper-choice", "identify-core-xy", "identify-axis-of-file"),
    *("identify-response-taken", "identify-last-response-taken"),
)
"""How the kinds of messages begin that warn of nothing."""

SHOWN_DIGITS = 16
"""Of a hash; the profile's text has it whole."""

CHANGED = 1e-3
"""Relative difference beyond which the profile no longer says what was measured."""


def plus_minus(one: Estimate | None, unit: str, words: Catalogue) -> str:
    """Return a value with two standard errors; ``unit`` as on a linear axis."""
    if one is None:
        return words.text("identify-not-known")
    scale = words.format.scale(abs(one.value), motion_unit(unit, rotary=words.rotary))
    value, error = one.value / scale.size, 2.0 * one.sigma / scale.size
    if not np.isfinite(error):  # nothing determines it
        return words.format.with_unit(f"{words.format.number(value)} ± ∞", scale.unit)
    digits = 3 if error == 0.0 or value == 0.0 else int(np.ceil(np.log10(abs(value / error)))) + 2
    shown = words.format.number(value, digits=int(np.clip(digits, 2, 6)))
    reach = words.format.number(error, digits=2)
    return words.format.with_unit(f"{shown} ± {reach}", scale.unit)


def facts(part: IdentifiedPart, words: Catalogue) -> tuple[tuple[str, str, str], ...]:
    """Return what was found over all modes: name, value, and where it comes from."""
    say, because = words.text, part.spread.because
    rows: list[tuple[str, str, str]] = []

    def row(key: str, value: str, why: str = "") -> None:
        rows.append((say(f"identify-{key}"), value, why or say(f"identify-{key}-meaning")))

    if not part.base_excited:  # a held motor shows neither
        row("mass", plus_minus(part.moving_mass, "kg", words))
        row("delay", plus_minus(part.delay, "s", words))
    if part.lag:
        row("lag", plus_minus(part.lag, "s", words))
    if part.band_hz:
        low, high = part.band_hz
        is_given = any(one.kind == "identify-band-given" for one in part.warnings)
        asked = say("identify-band-asked") if is_given else ""
        row("band", say("identify-band-from-to", low=low, high=high), asked)
    if part.misfit is not None:
        row("misfit", words.format.number(part.misfit, digits=3))
    spreads = {"frequency": part.spread.frequency, "damping": part.spread.damping}
    for place, (kind, spread) in enumerate(spreads.items()):
        why = words.say(because[place]) if because else say("identified-by-profile")
        row(f"spread-{kind}", f"± {show(spread, words, '%')}", why)
    return tuple(rows)


def result_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return mass, delay, band, misfit and spreads."""
    columns = (
        Quantity("", lambda fact: fact[0], width=1.2),
        Quantity("value", lambda fact: fact[1], ""),
        Quantity("identify-head-why", lambda fact: fact[2], width=2.4),
    )
    return table(words, "identify-part-result", columns, facts(part, words))


def mode_columns(
    part: IdentifiedPart, words: Catalogue, stated: Mapping[str, ModeEntry] = MappingProxyType({})
) -> tuple[Quantity, ...]:
    """Return the columns of a table of modes; ``stated``: those of the profile, by name."""
    gain = "" if part.base_excited else "1/kg"

    def known(key: str, unit: str) -> Callable[[MeasuredMode], str]:
        return lambda mode: plus_minus(getattr(mode, key), unit, words)

    def at_tool(mode: MeasuredMode) -> str:
        if mode.tcp_gain is None and mode.name in stated:
            assumed = show(stated[mode.name].tcp_gain, words, gain)
            return words.text("identified-assumed", value=assumed)
        return plus_minus(mode.tcp_gain, gain, words)

    return (
        Quantity("mode", "name"),
        Quantity("name-frequency", known("frequency_hz", "Hz"), ""),
        Quantity("name-damping-ratio", known("damping_ratio", ""), ""),
        Quantity("name-measured-gain", known("measured_gain", gain), ""),
        Quantity("name-tcp-gain", at_tool, ""),
    )


def mode_tables(
    part: IdentifiedPart, words: Catalogue, *, inside: Mapping[str, ModeEntry]
) -> tuple[Table, ...]:
    """Return the modes over all states and, where there are several, in each.

    ``inside`` are the modes of the profile, by name.
    """
    columns = mode_columns(part, words, inside)
    found = table(words, "identify-caption-modes", columns, part.modes)
    if len(part.states) < 2:
        return (found,)
    each = [
        (state.name, mode)
        for name in [mode.name for mode in part.modes]
        for state in part.states
        for mode in state.modes
        if mode.name == name
    ]
    state = Quantity("machine-state", itemgetter(0), width=1.5)
    own = (one.within(itemgetter(1)) for one in mode_columns(part, words))
    return (found, table(words, "identify-caption-states", (state, *own), each))


def remarks(part: IdentifiedPart, words: Catalogue) -> tuple[Bullets, ...]:
    """Return what to mind and what to measure better, then how it was done."""
    tones = (Tone.WARNING, Tone.NOTE)
    return tuple(
        Bullets(items=tuple(map(words.say, some)), tone=tone)
        for some, tone in zip(doubts_and_notes(part), tones, strict=True)
        if some
    )


def doubts_and_notes(part: IdentifiedPart) -> tuple[tuple[Message, ...], tuple[Message, ...]]:
    """Return what to mind and what to measure better; and how something was done."""
    notes = tuple(one for one in part.warnings if one.kind.startswith(INFORMATION))
    return tuple(one for one in part.warnings if one not in notes), notes


def check_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return how well the model explains the records it came from, and one held back."""
    columns = (
        Quantity("identify-head-file", "record", width=2.0),
        Quantity("identify-head-explained", "explained", "%"),
        Quantity("identify-head-held-back", "held_back"),
    )
    return table(words, "identify-caption-check", columns, part.checks)


def file_table(part: IdentifiedPart, words: Catalogue) -> Table:
    """Return what was read."""
    columns = (
        Quantity("identify-head-file", lambda one: short_name(one.name)),
        Quantity("identify-head-sensor", lambda one: Message(f"sensor-{one.sensor}")),
        Quantity("SHA-256", lambda one: one.sha256[:SHOWN_DIGITS]),
    )
    return table(words, "identify-part-sources", columns, part.sources)


def plots(part: IdentifiedPart, words: Catalogue) -> tuple[LinePlot, ...]:
    """Return measured points over fitted curves."""
    return tuple(
        _plot(f"fit-{number}", one, words) for number, one in enumerate(part.responses, start=1)
    )


def _plot(key: str, one: MeasuredResponseEntry, words: Catalogue) -> LinePlot:
    say, size = words.text, np.array(one.magnitude)

    def measured(y: Array | list[float]) -> Curve:
        return Curve(say("line-measured"), one.frequency_hz, y, SETPOINT)

    def fitted(y: Array | list[float]) -> Curve:
        return Curve(say("identify-line-fitted"), one.curve_hz, y, MAIN)

    def panel(kind: str, *curves: Curve, limits: tuple[float, ...] = (), **unit: str) -> Signals:
        name = say(f"identify-plot-{kind}", **unit)
        return Signals(name=name, unit="", curves=curves, limits=limits)

    sizes = []
    if one.error is not None:
        error = 2.0 * np.sqrt(2.0) * np.array(one.error)
        sizes = [
            Curve(say("identify-line-error"), one.frequency_hz, np.log10(y), THIRD)
            for y in (size + error, np.maximum(size - error, 0.2 * size))
        ]
    sizes += [fitted(np.log10(one.curve_magnitude)), measured(np.log10(size))]
    panels = [panel("magnitude", *sizes, unit=one.unit) if one.unit else panel("density", *sizes)]
    if one.phase_deg is not None and one.curve_phase_deg is not None:
        panels.append(panel("phase", fitted(one.curve_phase_deg), measured(one.phase_deg)))
    if one.coherence is not None:
        panels.append(panel("coherence", measured(one.coherence)))
    if one.missed is not None:
        panels.append(panel("misfit", measured(one.missed), limits=(2.0,)))
    return line_plot(
        words,
        key,
        panels,
        x=(say("identify-plot-frequency"), ""),
        text="identify-plot",
        is_log=True,
        link="fits",
        file=short_name(one.name),
    )


def short_name(name: str) -> str:
    """Return a file without its folder."""
    return name.rpartition("/")[2].rpartition("\\")[2]


def identified(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield what was measured beside what the profile says now; nothing where nothing was."""
    part = record.identified
    if part is None:
        return
    yield note(words.text("identified-note", date=part.created[:10]))
    yield result_table(part, words)
    yield from mode_tables(part, words, inside={mode.name: mode for mode in record.plant.modes})
    if gone := changes(part, record, words):
        yield Bullets(items=gone, tone=Tone.WARNING)
    if part.tool_sensor:
        yield _tool_sensor(part.tool_sensor, words)
    yield from _beside_klipper(part, record, words)
    yield from plots(part, words)
    yield from remarks(part, words)
    if part.checks:
        yield check_table(part, words)
    yield file_table(part, words)


def changes(part: IdentifiedPart, record: Record, words: Catalogue) -> tuple[str, ...]:
    """Return what the profile no longer says as it was measured."""
    text, stated = words.text, {mode.name: mode for mode in record.plant.modes}
    found = []
    for mode in part.modes:
        now = stated.get(mode.name)
        if now is None:
            found.append(text("identified-not-in-profile", mode=mode.name))
            continue
        for kind, unit, measured, value in (
            ("name-frequency", "Hz", mode.frequency_hz, now.frequency_hz),
            ("name-damping-ratio", "", mode.damping_ratio, now.damping_ratio),
        ):
            if abs(value - measured.value) > CHANGED * abs(measured.value):
                what = text(kind)
                both = {"now": show(value, words, unit), "was": plus_minus(measured, unit, words)}
                found.append(text("identified-changed", mode=mode.name, what=what, **both))
    mass = record.plant.moving_mass
    if part.moving_mass and abs(mass - part.moving_mass.value) > CHANGED * mass:
        was = plus_minus(part.moving_mass, "kg", words)
        found.append(text("identified-mass-changed", now=show(mass, words, "kg"), was=was))
    data = {item.key: item.value for item in record.data}
    spreads = {"frequency": part.spread.frequency, "damping": part.spread.damping}
    for kind, spread in spreads.items():
        held = data.get(f"requirements.{kind}_spread")
        if isinstance(held, float) and held < (1.0 - CHANGED) * spread:
            what = text(f"identify-spread-{kind}")
            both = {"now": show(held, words, "%"), "was": show(spread, words, "%")}
            found.append(text("identified-spread-less", what=what, **both))
    return tuple(found)


def _beside_klipper(part: IdentifiedPart, record: Record, words: Catalogue) -> Iterator[Block]:
    """What calibrate_shaper would choose, by its own measures; then simulated, beside ours."""
    if not part.proposals:
        return
    # Slow to load: the terminal, which shares this module, does without.
    from mtcommission.sheet.limits import MEETS, is_of_calibration

    text, f, ours = words.text, words.format, record.limits.recommended

    def head(name: str) -> str:
        return f"identified-klipper-{name}"

    chosen = (
        Quantity(
            head("shaper"),
            lambda one: (
                text("identified-klipper-chosen", shaper=one.shaper.upper())
                if one.is_recommended
                else one.shaper.upper()
            ),
        ),
        FREQUENCY,
        Quantity(head("vibration"), "vibration", "%"),
        Quantity(head("smoothing"), "smoothing", "m"),
        Quantity(
            head("max-accel"),
            lambda one: f.with_unit(f.number(1e3 * one.max_acceleration), "mm/s²"),
            "",
        ),
    )
    own = text("identified-klipper-ours", filter=say_filter(ours.setpoint_filter, words))
    proposed = [one for one in record.limits.rules if is_of_calibration(one)]
    simulated = [(own, ours), *((words.say(one.name), one) for one in proposed)]
    columns = (
        Quantity("", lambda item: item[0], width=2.6),
        *(one.within(itemgetter(1)) for one in (ACCELERATION, SETTLING, RESIDUAL, MEETS)),
    )
    yield table(words, "identified-klipper-caption", chosen, part.proposals)
    yield table(words, "identified-klipper-simulated", columns, simulated)


def _tool_sensor(one: ToolSensor, words: Catalogue) -> Paragraph:
    named, now, least = {"modes": ", ".join(one.modes)}, one.settling_time, one.least
    if now is None or least is None:
        met = "no" if least is None else "yes"
        said = words.text("identified-tool-decides", **named, met=met)
    elif least >= now:
        said = words.text("identified-tool-frees-nothing", **named)
    else:
        freed = {"now": now, "least": least, "freed": now - least}
        said = words.text("identified-tool-frees", **named, **freed)
    return note(said)
