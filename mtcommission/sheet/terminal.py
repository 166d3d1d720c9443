"""The summary of a run in 80 columns; plain text when it is piped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console, ConsoleOptions, RenderResult
from rich.table import Table
from rich.text import Text

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import THIN_SPACE
from mtcommission.record.schema.record import Record
from mtcommission.sheet.basis import assumed_rows, basis_rows, holds_rows
from mtcommission.sheet.robustness import drawn_sentence
from mtcommission.sheet.tables import (
    ACCELERATION,
    DASH,
    JERK_TIME,
    RESIDUAL,
    SETTLING,
    Quantity,
    say_filter,
    say_requirement,
)
from mtcommission.sheet.verdict import (
    assumed_and_binding,
    attainable_sentences,
    move_title,
    reference_sentence,
    share_used,
    slowest_move,
)

Array = NDArray[np.float64]

ROWS, COLUMNS = 4, 72
"""Characters of the small plot."""

BRAILLE = 0x2800
DOTS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bits of a braille character, four dots high and two wide (Unicode 15, block U+2800)."""

ASCII_STEPS = " .:-=+*#"
SUBSTITUTES = {
    THIN_SPACE: " ",
    "²": "^2",
    "³": "^3",
    "µ": "u",
    "·": " ",
    "°": " deg",
    "″": " arcsec",
    "−": "-",
    "–": "-",
    "±": "+/-",
    "≤": "<=",
    "…": "...",
    "τ": "tau",
    "φ": "phi",
    "ä": "ae",
    "ö": "oe",
    "ü": "ue",
    "Ä": "Ae",
    "Ö": "Oe",
    "Ü": "Ue",
    "ß": "ss",
}
"""What a console gets instead of signs that it does not know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """What the terminal shows of a record; rich renders it."""

    record: Record
    language: str

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield title, verdict, values and the small plot."""
        record = self.record
        axis = record.machine
        words = Catalogue(self.language, rotary=axis.motion == "rotary", follows=axis.follows)
        text = words.text

        def plain(line: str, style: str = "") -> Text:
            # A Text is never read as markup, whatever the machine is called.
            return Text(_speak(line, options.encoding), style=style)

        is_met = record.assessment.met
        machine = record.machine
        yield plain(f"{machine.name}, {text('axis')} {machine.axis}", "bold")
        verdict = text("verdict-met") if is_met else text("verdict-not-met")
        yield plain(verdict, "bold green" if is_met else "bold red")
        for warning in record.warnings:
            yield plain(text("warning", warning=words.say(warning)), "yellow")
        if record.assessment.obstacle:
            obstacle = say_requirement(record.assessment.obstacle, words)
            yield plain(text("obstacle", obstacle=obstacle))
        table = Table.grid(padding=(0, 2))
        for name, value, *before in summary_rows(record, words):
            table.add_row(plain(name), plain(value, "bold"), *map(plain, before))
        yield table
        yield plain(text("values-bound-by", bound=words.say(record.limits.recommended.bound_by)))
        for sentence in assumed_and_binding(record, words):
            yield plain(sentence)
        yield plain(text("used", shares=_shares(record, words)))
        told = (*basis_rows(record, words), *holds_rows(record, words))
        for name, value in (*told, *assumed_rows(record, words)):
            yield plain(f"{name}: {value}.")
        for sentence in further_sentences(record, words):
            yield plain(sentence)
        yield from (plain(line) for line in _small_plot(record, words, is_ascii=options.ascii_only))
        yield plain(text("disclaimer"), "dim")


def summary_rows(record: Record, words: Catalogue) -> list[tuple[str, ...]]:
    """Return the values of the summary as the sheet prints them, with today's behind them."""
    limits, today, has_jerk = (
        record.limits.recommended,
        record.limits.today,
        record.loop.jerk != "none",
    )
    jerk = Quantity("jerk", lambda it: it.jerk if has_jerk else None, "m/s^3", "no-jerk-limit")
    quantities = [ACCELERATION, jerk, *([JERK_TIME] if has_jerk else [])]
    if limits.setpoint_filter or (today and today.setpoint_filter):
        shown = Quantity("setpoint-filter", lambda it: say_filter(it.setpoint_filter, words))
        quantities.append(shown)
    found = (SETTLING, RESIDUAL)

    def now(quantity: Quantity) -> str:
        is_known = today and not (today.failure and quantity in found)
        value = quantity.show(today, words) if is_known else DASH
        return words.text("now", value=value)

    return [
        (one.head(words), one.show(limits, words), *([now(one)] if today else []))
        for one in (*quantities, *found)
    ]


def _shares(record: Record, words: Catalogue) -> str:
    """Return what is used of each requirement."""
    return ", ".join(
        f"{say_requirement(check.name, words)} {share_used(check, words)}"
        for check in record.assessment.checks
    )


def further_sentences(record: Record, words: Catalogue) -> list[str]:
    """Return what could be met instead, the reference, and the robustness, as on the sheet."""
    drawn = record.robustness.monte_carlo
    today = record.limits.today
    return [
        *([words.say(today.basis)] if today else []),
        *attainable_sentences(record, words),
        reference_sentence(record, slowest_move(record), words),
        *([] if drawn is None else [drawn_sentence(drawn, words)]),
    ]


def draw_dots(y: Array) -> list[str]:
    """Return a curve, two values for each character, as rows of braille characters."""
    low, high = min(0.0, float(y.min())), max(0.0, float(y.max()))
    height = 4 * ROWS - 1
    level = np.rint((y - low) / ((high - low) or 1.0) * height).astype(int)
    cells = np.zeros((ROWS, y.size // 2), dtype=int)
    for k, dot in enumerate(level[: 2 * cells.shape[1]]):
        from_top = height - dot
        cells[from_top // 4, k // 2] |= DOTS[from_top % 4, k % 2]
    return ["".join(chr(BRAILLE + int(cell)) for cell in row) for row in cells]


def _small_plot(record: Record, words: Catalogue, *, is_ascii: bool) -> list[str]:
    """Return the acceleration setpoint of the slowest move over time, with its caption."""
    f = words.format
    number = slowest_move(record)
    move = record.moves[number - 1]
    t, y = np.array(move.series.t), np.array(move.series.signals["a_ref"])
    title = move_title(move.move, number, words)
    end = f.quantity(move.setpoint.duration, "s")
    caption = words.text("sparkline", move=title, duration=end)
    shown = t <= 1.02 * move.setpoint.duration
    grid = np.linspace(0.0, float(t[shown][-1]), 2 * COLUMNS)
    values = np.interp(grid, t, y)
    if not is_ascii:
        return [caption, *draw_dots(values)]
    return [caption, *draw_ascii(values[::2])]


def draw_ascii(y: Array) -> list[str]:
    """Return a curve, a value for each character, as one row for each sign that it has."""
    largest = float(np.max(np.abs(y))) or 1.0
    rows = []
    for sign, part in (("+", np.maximum(y, 0.0)), ("-", np.maximum(-y, 0.0))):
        if np.any(part > 0.0):
            steps = np.rint(part / largest * (len(ASCII_STEPS) - 1)).astype(int)
            rows.append(f"{sign} " + "".join(ASCII_STEPS[step] for step in steps))
    return rows


def _speak(words: str, encoding: str) -> str:
    """Return words in what the console can show."""
    for sign, other in SUBSTITUTES.items():
        try:
            sign.encode(encoding)
        except UnicodeEncodeError:
            words = words.replace(sign, other)
    return words.encode(encoding, "replace").decode(encoding)
