"""What was identified as one HTML page: measured beside fitted, modes, and what is in doubt."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.check import Checked
from mtcommission.identify.fit.estimate import Estimate
from mtcommission.identify.fit.fitted import Fitted, FittedResponse
from mtcommission.identify.fit.peaks import FittedSpectrum
from mtcommission.identify.identified import Identified, IdentifiedMode, Seen
from mtcommission.identify.measurement import Input, Output, Sensor
from mtcommission.messages.catalogue import Catalogue
from mtcommission.sheet.html import set_html
from mtcommission.sheet.model import (
    BigValue,
    Block,
    Bullets,
    Column,
    Document,
    Headline,
    Preformatted,
    Section,
    Table,
    Tone,
)
from mtcommission.sheet.plot_model import Border, Line, LinePlot, Panel
from mtcommission.units.axis_units import LINEAR, ROTARY

Array = NDArray[np.float64]

CURVE_POINTS = 1200
"""Of a fitted curve; and the measured lines that are drawn at most."""


def print_identified(
    found: Identified,
    *,
    checks: Sequence[Checked],
    profile: str,
    created: str,
    language: str,
) -> str:
    """Return the page, which works offline.

    Parameters
    ----------
    found
        The axis.
    checks
        The model against the records.
    profile
        Text that was written.
    created
        When it was made (ISO 8601).
    language
        Code, e.g. "en".
    """
    words = Catalogue(language, rotary=found.rotary)
    say = words.text
    sections = [
        Section(
            key="result",
            heading=say("identify-part-result"),
            blocks=(_headline(found, words), _result(found, words)),
        ),
        Section(key="modes", heading=say("identify-part-modes"), blocks=_modes(found, words)),
        Section(key="fits", heading=say("identify-part-fits"), blocks=_plots(found, words)),
    ]
    if found.warnings:
        told = tuple(words.say(message) for message in found.warnings)
        sections.append(
            Section(
                key="doubts",
                heading=say("identify-part-doubts"),
                blocks=(Bullets(items=told, tone=Tone.WARNING),),
            )
        )
    if checks:
        sections.append(
            Section(
                key="check", heading=say("identify-part-check"), blocks=(_checks(checks, words),)
            )
        )
    sections += [
        Section(key="files", heading=say("identify-part-sources"), blocks=(_files(found, words),)),
        Section(
            key="profile",
            heading=say("identify-part-profile"),
            blocks=(Preformatted(caption=say("identify-part-profile"), text=profile),),
        ),
    ]
    document = Document(
        language=language,
        title=say("identify-title"),
        machine=say("identify-document-name"),
        axis=created[:10],
        identity=", ".join(state.name for state in found.states),
        created=created,
        disclaimer=say("identify-page-note"),
        contents_heading=say("contents"),
        skip_link=say("skip"),
        script_note=say("identify-script-note"),
        page_word=say("page"),
        sections=tuple(sections),
    )
    return set_html(document, decimal_mark=words.format.decimal_mark)


def plus_minus(one: Estimate | None, unit: str, words: Catalogue) -> str:
    """Return a value with two standard errors, in its unit."""
    if one is None:
        return words.text("identify-not-known")
    scale = words.format.scale(abs(one.value), unit)
    value, error = one.value / scale.size, 2.0 * one.sigma / scale.size
    digits = 3 if error == 0.0 or value == 0.0 else int(np.ceil(np.log10(abs(value / error)))) + 2
    shown = words.format.number(value, digits=int(np.clip(digits, 2, 6)))
    reach = words.format.number(error, digits=2)
    return words.format.with_unit(f"{shown} ± {reach}", scale.unit)


def _headline(found: Identified, words: Catalogue) -> Headline:
    count = len(found.modes)
    files = {one.source.file for one in found.measurements}
    return Headline(
        is_met=bool(count),
        verdict=words.text("identify-verdict", modes=count)
        if count
        else words.text("identify-verdict-none"),
        detail=words.text("identify-detail", states=len(found.states), files=len(files)),
        values=tuple(
            BigValue(
                label=mode.name,
                value=words.format.quantity(mode.frequency_hz.value, "Hz"),
                aside=f"ζ = {words.format.number(mode.damping_ratio.value, digits=3)}",
            )
            for mode in found.modes[:4]
        ),
    )


def _result(found: Identified, words: Catalogue) -> Table:
    say, form = words.text, words.format
    unit = ROTARY if found.rotary else LINEAR
    rows = [
        (
            say("identify-mass"),
            plus_minus(found.moving_mass, unit.mass.si, words),
            say("identify-mass-meaning"),
        ),
        (
            say("identify-delay"),
            plus_minus(found.delay, "s", words),
            say("identify-delay-meaning"),
        ),
    ]
    rows += [
        (
            say("identify-band"),
            say("identify-band-from-to", low=fit.band_hz[0], high=fit.band_hz[1]),
            say("identify-band-meaning"),
        )
        for fit in found.fits
    ]
    rows += [
        (
            say("identify-misfit"),
            form.number(fit.misfit, digits=3),
            say("identify-misfit-meaning"),
        )
        for fit in found.fits
    ]
    because = found.spread.because
    rows += [
        (
            say("identify-spread-frequency"),
            f"± {form.percent(found.spread.frequency)}",
            words.say(because[0]),
        ),
        (
            say("identify-spread-damping"),
            f"± {form.percent(found.spread.damping)}",
            words.say(because[1]),
        ),
    ]
    return Table(
        caption=say("identify-caption-result"),
        columns=(
            Column(head="", width=1.2),
            Column(head=say("identify-head-value"), is_number=True),
            Column(head=say("identify-head-why"), width=2.4),
        ),
        rows=tuple(rows),
    )


def mode_columns(words: Catalogue) -> tuple[str, ...]:
    """Return the heads of a table of modes."""
    return tuple(
        words.text(kind)
        for kind in (
            "identify-head-mode",
            "identify-head-frequency",
            "identify-head-damping",
            "identify-head-encoder",
            "identify-head-tool",
        )
    )


def mode_row(
    name: str, mode: IdentifiedMode | Seen, words: Catalogue, *, base_excited: bool
) -> tuple[str, ...]:
    """Return a row of such a table."""
    gain = "" if base_excited else (ROTARY if words.rotary else LINEAR).gain.si
    return (
        name,
        plus_minus(mode.frequency_hz, "Hz", words),
        plus_minus(mode.damping_ratio, "", words),
        plus_minus(mode.measured_gain, gain, words),
        plus_minus(mode.tcp_gain, gain, words),
    )


def _modes(found: Identified, words: Catalogue) -> tuple[Block, ...]:
    heads = mode_columns(words)
    is_base = found.is_base_excited
    blocks: list[Block] = [
        Table(
            caption=words.text("identify-caption-modes"),
            columns=tuple(Column(head=head, is_number=i > 0) for i, head in enumerate(heads)),
            rows=tuple(
                mode_row(mode.name, mode, words, base_excited=is_base) for mode in found.modes
            ),
        )
    ]
    if len(found.states) > 1:
        blocks.append(
            Table(
                caption=words.text("identify-caption-states"),
                columns=(
                    Column(head=words.text("identify-head-state"), width=1.5),
                    *(Column(head=head, is_number=i > 0) for i, head in enumerate(heads)),
                ),
                rows=tuple(
                    (state.name, *mode_row(mode.name, state.modes[k], words, base_excited=is_base))
                    for mode in found.modes
                    for state, k in zip(found.states, mode.seen, strict=True)
                    if k is not None
                ),
            )
        )
    return tuple(blocks)


def _plots(found: Identified, words: Catalogue) -> tuple[Block, ...]:
    blocks: list[Block] = []
    for state in found.states:
        if isinstance(state.result, Fitted):
            for one in state.result.responses:
                key = f"fit-{len(blocks) + 1}"
                blocks.append(_response_plot(key, one, state.result.misfit, words))
        elif isinstance(state.result, FittedSpectrum):
            blocks.append(_spectrum_plot(f"fit-{len(blocks) + 1}", state.result, words))
    return tuple(blocks)


def _response_plot(key: str, one: FittedResponse, misfit: float, words: Catalogue) -> LinePlot:
    say, lines = words.text, one.lines
    f = lines.frequency_hz
    every = slice(None, None, 1 + f.size // CURVE_POINTS)
    curve = np.geomspace(f[0], f[-1], CURVE_POINTS)
    # Phases beside each other where noise would let them jump by a turn.
    fitted = np.unwrap(np.angle(one.model(curve)))
    fitted -= 2 * pi * np.round(float(np.median(fitted)) / (2 * pi))
    at = np.interp(f, curve, fitted)
    measured = at + np.angle(lines.values * np.exp(-1j * at))
    size = np.abs(lines.values)
    error = 2.0 * np.sqrt(2.0) * lines.error
    low = np.maximum(size - error, 0.2 * size)
    name = one.response.source.name

    def line(label: str, x: Array, y: Array, style: int) -> Line:
        return Line(label=say(label), x=x, y=y, style=style)

    panels = [
        Panel(
            y_label=say("identify-plot-magnitude", unit=_unit_of(one)),
            lines=(
                line("identify-line-measured", f[every], np.log10(size)[every], 0),
                line("identify-line-fitted", curve, np.log10(np.abs(one.model(curve))), 4),
                line("identify-line-error", f[every], np.log10(size + error)[every], 2),
                line("identify-line-error", f[every], np.log10(low)[every], 2),
            ),
        ),
        Panel(
            y_label=say("identify-plot-phase"),
            lines=(
                line("identify-line-measured", f[every], np.degrees(measured)[every], 0),
                line("identify-line-fitted", curve, np.degrees(fitted), 4),
            ),
        ),
    ]
    if one.response.coherence is not None:
        coherence = np.interp(f[every], one.response.frequency_hz, one.response.coherence)
        panels.append(
            Panel(
                y_label=say("identify-plot-coherence"),
                lines=(line("identify-line-measured", f[every], coherence, 0),),
            )
        )
    missed = np.abs(one.model(f) - lines.values) / (np.sqrt(2.0) * lines.error)
    panels.append(
        Panel(
            y_label=say("identify-plot-misfit"),
            lines=(line("identify-line-measured", f[every], missed[every], 0),),
            borders=(Border(label="2", y=2.0),),
        )
    )
    return LinePlot(
        key=key,
        caption=say("identify-plot-caption", file=name),
        alt=say("identify-plot-alt", file=name, misfit=misfit),
        x_label=say("identify-plot-frequency"),
        x_is_log=True,
        link="fits",
        panels=tuple(panels),
    )


def _unit_of(one: FittedResponse) -> str:
    length, force = ("rad", "N m") if one.response.rotary else ("m", "N")
    rate = {Output.POSITION: "", Output.VELOCITY: "/s", Output.ACCELERATION: "/s²"}
    if one.response.input is Input.ACCELERATION:
        return f"{length}{rate[one.response.output]} / ({length}/s²)"
    return f"{length}{rate[one.response.output]} / ({force})"


def _spectrum_plot(key: str, one: FittedSpectrum, words: Catalogue) -> LinePlot:
    say, spectrum = words.text, one.spectrum
    f = spectrum.frequency_hz[one.is_used]
    density = spectrum.density[one.is_used]
    floor = 1e-6 * float(density.max())
    name = spectrum.source.name
    return LinePlot(
        key=key,
        caption=say("identify-spectrum-caption", file=name),
        alt=say("identify-spectrum-alt", file=name),
        x_label=say("identify-plot-frequency"),
        x_is_log=True,
        link="fits",
        panels=(
            Panel(
                y_label=say("identify-plot-density"),
                lines=tuple(
                    Line(label=say(label), x=f, y=np.log10(np.maximum(y, floor)), style=style)
                    for label, y, style in (
                        ("identify-line-measured", density, 0),
                        ("identify-line-fitted", one.density, 4),
                    )
                ),
            ),
        ),
    )


def _checks(checks: Sequence[Checked], words: Catalogue) -> Table:
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
                words.text("terminal-yes" if one.is_held_back else "terminal-no"),
            )
            for one in checks
        ),
    )


def _files(found: Identified, words: Catalogue) -> Table:
    sensor = {
        Sensor.ENCODER: words.text("identify-sensor-encoder"),
        Sensor.TCP: words.text("identify-sensor-tcp"),
    }
    heads = ("identify-head-file", "identify-head-sensor", "identify-head-format")
    return Table(
        caption=words.text("identify-caption-files"),
        columns=(
            *(Column(head=words.text(head), width=1.5) for head in heads),
            Column(head=words.text("identify-head-hash"), width=2.0),
        ),
        rows=tuple(
            (
                one.source.name,
                sensor[one.sensor],
                words.say(one.source.format),
                one.source.sha256,
            )
            for one in found.measurements
        ),
    )
