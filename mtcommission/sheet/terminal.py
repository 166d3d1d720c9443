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
from mtcommission.record.schema.limits import LimitsEntry, TodayEntry
from mtcommission.record.schema.record import Record
from mtcommission.sheet.basis_part import assumed_rows, basis_rows, holds_rows
from mtcommission.sheet.robustness_part import drawn_sentence
from mtcommission.sheet.values import residual, say_filter, say_requirement, settling
from mtcommission.sheet.verdict_part import (
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
    """What the terminal shows of a record; rich renders it.

    Parameters
    ----------
    record
        A whole commissioning.
    language
        Code, e.g. "en".
    """

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
    text, f, limits = words.text, words.format, record.limits.recommended
    today = record.limits.today
    has_filter = limits.setpoint_filter or (today and today.setpoint_filter)

    timed = () if record.loop.jerk == "none" else ("jerk-time",)

    def values(item: LimitsEntry | TodayEntry) -> tuple[str, ...]:
        j = None if record.loop.jerk == "none" else item.jerk
        return (
            f.axis(item.acceleration, "m/s^2"),
            f.axis(j, "m/s^3", missing=text("no-jerk-limit")),
            *([f.quantity(item.jerk_time, "s")] if timed else []),
            *([say_filter(item.setpoint_filter, words)] if has_filter else []),
            settling(item.settling_time, words),
            residual(item.residual_deviation, words),
        )

    filtered = ("setpoint-filter",) if has_filter else ()
    names = ("acceleration", "jerk", *timed, *filtered, "settling-time", "residual")
    columns = [[text(name) for name in names], values(limits)]
    if today:
        *typed, settled, left = values(today)
        found = ("–", "–") if today.failure else (settled, left)
        columns.append([text("now", value=value) for value in (*typed, *found)])
    return list(zip(*columns, strict=True))


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
    """Return a curve as rows of braille characters.

    Parameters
    ----------
    y
        Two values for each character, shape (2 columns,).

    Examples
    --------
    >>> draw_dots(np.array([0.0, 0.0, 1.0, 1.0]))[-1]
    '⣀⠀'
    """
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
    """Return a curve as one row of characters for each sign that it has.

    Parameters
    ----------
    y
        One value for each character, shape (columns,).

    Examples
    --------
    >>> draw_ascii(np.array([0.0, 0.5, 1.0, 0.0, -1.0]))
    ['+  =#  ', '-     #']
    """
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
