"""Appendix: machine data, robustness, certificates, and versions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.record.machine import Datum, datum, datum_name
from mtcommission.record.optima import OptimumEntry
from mtcommission.record.record import Record
from mtcommission.record.shape import Words
from mtcommission.sheet.document import (
    Block,
    Bullets,
    Paragraph,
    Preformatted,
    Subheading,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.plots import Curve, Signals, line_plot
from mtcommission.sheet.responses import named_optima
from mtcommission.sheet.tables import (
    DAMPING,
    FREQUENCY,
    MAX_FORCE,
    PEAK,
    RESIDUAL,
    RMS_FORCE,
    SETTLING,
    Quantity,
    pairs,
    place_columns,
    show,
    table,
)
from mtcommission.sheet.verdict import find_band, kept_sentence, move_title

REQUIRED = ("requirements.", "moves")
"""Beginnings of the keys that say what is required, not what the machine is."""

PROVED = ("t_f_lower_bound", "relative_gap", "switching_law_holds", "law_residual")
"""What a certificate says on the sheet; the record has adjoint, slopes and rank besides."""

LONGEST_SOURCE = 28
"""Letters of a source that fits into its column; a longer one stands once, with a number."""


def machine_data(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the machine's data with their sources, and its modes."""
    # Below a motor that follows, q hangs back: the plant has -q for its F.
    sign = -1.0 if words.follows else 1.0
    modes = (
        Quantity("mode", "name", width=1.4),
        FREQUENCY,
        DAMPING,
        Quantity("name-tcp-gain", lambda mode: sign * mode.tcp_gain, "1/kg"),
        Quantity("name-measured-gain", "measured_gain", "1/kg"),
    )
    yield _data(record, words, is_required=False)
    yield from (note(f"{number} {source}") for source, number in _numbers(record).items())
    yield table(words, "modes-caption", modes, record.plant.modes)


def requirements(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield the moves and what is required of them."""
    yield _data(record, words, is_required=True)


def _numbers(record: Record) -> dict[str, str]:
    """The sources too long to be repeated in each row, and their numbers."""
    named = dict.fromkeys(item.source for item in record.data)
    longer = (one for one in named if isinstance(one, str) and len(one) > LONGEST_SOURCE)
    return {source: f"[{number}]" for number, source in enumerate(longer, start=1)}


def _data(record: Record, words: Catalogue, *, is_required: bool) -> Table:
    numbers, units = _numbers(record), record.plant.units

    def cited(item: Datum) -> Words:
        named = isinstance(item.source, str)
        return numbers.get(str(item.source), item.source) if named else item.source

    columns = (
        Quantity("quantity", lambda item: datum_name(item, words), width=1.3),
        Quantity("value", lambda item: datum(item, units, words), "", width=0.8),
        Quantity("key", "key", width=1.5),
        Quantity("source", cited, width=1.1),
    )
    data = (item for item in record.data if item.key.startswith(REQUIRED) is is_required)
    return table(words, "", columns, data)


def robustness(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield corners and frequency error; where the motor follows they stand on page 3."""
    if not record.machine.follows:
        yield from held_range(record, words)


def held_range(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield what comes about in every corner, and over the error of all frequencies."""
    for number, move in enumerate(record.moves, start=1):
        yield table(
            words,
            "corners-caption",
            (
                *place_columns(move.corners),
                *(SETTLING, RESIDUAL, PEAK, MAX_FORCE, RMS_FORCE),
                Quantity("saturated", "saturated"),
            ),
            move.corners,
            strong=lambda corner: corner.settling_time is None,
            move=move_title(move.move, number, words),
        )
    yield Paragraph(text=kept_sentence(record, words))
    yield from _frequency_error(record, words)


def _frequency_error(record: Record, words: Catalogue) -> Iterator[Block]:
    """The curves over the frequency error; none where no error keeps anything."""
    text, error, permitted = words.text, record.robustness.frequency_error, find_band(record)
    x = 100.0 * (np.array(error.factor) - 1.0)
    residual, settling = (
        Curve(text("recommended"), x, values)
        for values in (error.residual_deviation, error.settling_time)
    )
    panels = (
        Signals(text("residual"), "m", [residual], () if permitted is None else (permitted,)),
        Signals(text("settling-time"), "s", [settling]),
    )
    if residual.y.size:
        yield line_plot(
            words,
            "frequency-error",
            [panel for panel in panels if panel.curves[0].y.size],
            x=(text("frequency-error"), ""),
        )


def certificates(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield certificates, assumptions and warnings."""
    text = words.text
    yield Subheading(text=text("assumptions"))
    yield _sentences(record.assumptions, Tone.PLAIN, words)
    yield Subheading(text=text("warnings"))
    yield _sentences(record.warnings, Tone.WARNING, words)
    for number, optima in enumerate(record.optima, start=1):
        move = move_title(optima.move, number, words)
        for name, _, optimum in named_optima(optima, words):
            rows = _certificate(optimum, words)
            yield pairs(words, "certificate-caption", rows, move=move, what=name)


def _sentences(items: Sequence[Words], tone: Tone, words: Catalogue) -> Block:
    if not items:
        return Paragraph(text=words.text("none"))
    return Bullets(items=tuple(map(words.say, items)), tone=tone)


def _certificate(optimum: OptimumEntry, words: Catalogue) -> list[tuple[str, str]]:
    text, f, peaks = words.text, words.format, optimum.peaks
    # Arcs within the force bound run into another without a switch.
    switches = [a.t_end for a, b in pairwise(optimum.arcs) if a.control != b.control]
    errors = (abs(e) / peaks[name] for name, e in optimum.terminal_error.items() if peaks.get(name))
    rows = [
        (text("final-time"), f.quantity(optimum.t_f, "s")),
        (text("method"), words.known(f"method-{optimum.method}", optimum.method)),
        (text("switches"), ", ".join(f.quantity(t, "s") for t in switches)),
        (text("largest-error"), f.number(max(errors, default=0.0), digits=2)),
    ]
    proof = ((key, getattr(optimum.certificate, key)) for key in PROVED)
    units = {"t_f_lower_bound": "s"}
    rows += [
        (words.name(key), show(value, words, units.get(key, "")))
        for key, value in proof
        if value is not None
    ]
    return [row for row in rows if row[1]]


def versions(record: Record, words: Catalogue) -> Iterator[Block]:
    """Yield program, libraries, hash and text of the profile."""
    text, tool, profile = words.text, record.tool, record.profile
    rows = [(tool.name, tool.version), *tool.libraries.items(), (text("created"), record.created)]
    yield pairs(words, "", rows, first="program")
    yield Paragraph(text=f"{text('hash-row')}:")
    yield Paragraph(text=profile.sha256, tone=Tone.CODE)
    yield Preformatted(caption=text("profile-caption", name=profile.name), text=profile.text)
