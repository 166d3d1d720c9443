"""Plots of the document as SVG for print: axes, legends and curves on a canvas."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.quantities import tick_text
from mtcommission.sheet.document import Line, LinePlot, Panel

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, top, right and bottom [pt]."""

SIZE = 8.0
"""Font size [pt]; no smaller in print."""

CHARACTER = 0.6
"""Mean width of a character of DejaVu Sans in the names of curves, relative to the font size."""

INK, GRID = "#000000", "#cccccc"

TICKS = 6
"""Steps on an axis, at most."""

DECADES = 30.0
"""Ratio of the ends of a logarithmic axis below which ticks stand inside the decades, too."""

INSIDE = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
"""Where they stand then, in each decade."""

FEWEST = 3
"""Ticks inside the decades that are too few to read a value by."""


class Canvas:
    """A growing drawing [pt]; what is drawn later lies on top."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self._parts: list[str] = []
        self._clips = 0

    def line(
        self,
        points: Array,
        *,
        color: str = INK,
        width: float = 0.6,
        dashes: tuple[float, ...] = (),
    ) -> None:
        """Draw a line through points, shape (n, 2)."""
        dash = f' stroke-dasharray="{" ".join(f"{part:g}" for part in dashes)}"' if dashes else ""
        self._parts.append(
            f'<path d="{_path(points)}" fill="none" stroke="{color}" stroke-width="{width:g}"'
            f' stroke-linejoin="round"{dash}/>'
        )

    def box(self, box: Box) -> None:
        """Draw the edge of a box."""
        self._parts.append(
            f'<rect {_rectangle(box)} fill="none" stroke="{INK}" stroke-width="0.6"/>'
        )

    def text(self, x: float, y: float, words: str, *, anchor: str = "start") -> None:
        """Write words on a base line; anchor is start, middle or end."""
        self._parts.append(
            f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}">{escape(words)}</text>'
        )

    def clip(self, box: Box) -> None:
        """Cut off what is drawn from here on outside a box, until ``unclip``."""
        self._clips += 1
        self._parts.append(
            f'<clipPath id="c{self._clips}"><rect {_rectangle(box)}/></clipPath>'
            f'<g clip-path="url(#c{self._clips})">'
        )

    def unclip(self) -> None:
        """End what ``clip`` began."""
        self._parts.append("</g>")

    def finish(self, *, alt: str = "") -> str:
        """Return the drawing; the same calls always give the same text.

        ``alt``: what it shows, where it stands in a page as it is.
        """
        named = f'role="img" aria-label="{escape(alt)}" ' if alt else ""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" {named}'
            f'width="{self.width:g}pt" height="{self.height:g}pt" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" '
            f'font-family="DejaVu Sans" font-size="{SIZE:g}">{"".join(self._parts)}</svg>'
        )


def _path(points: Array) -> str:
    return "M" + "L".join(f"{x:.2f} {y:.2f}" for x, y in np.asarray(points).tolist())


def _rectangle(box: Box) -> str:
    left, top, right, bottom = box
    return f'x="{left:.2f}" y="{top:.2f}" width="{right - left:.2f}" height="{bottom - top:.2f}"'


def text_width(words: str) -> float:
    """Return about how wide words are [pt]; short ones may be a few per cent wider."""
    return CHARACTER * SIZE * len(words)


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """An axis of a plot: values at its ends, and their places [pt]."""

    low: float
    high: float
    begin: float
    end: float
    is_log: bool = False

    def at(self, values: Array | float) -> Array:
        """Return the places of values [pt]."""
        low, high, x = self.low, self.high, np.asarray(values, dtype=np.float64)
        if self.is_log:
            low, high, x = np.log(low), np.log(high), np.log(x)
        return np.asarray(self.begin + (x - low) / (high - low) * (self.end - self.begin))

    def ticks(self, *, most: int = TICKS) -> list[float]:
        """Return values for the ticks, about ``most`` at most."""
        if self.is_log:
            is_short = self.high < DECADES * self.low
            powers = range(floor(log10(self.low)), ceil(log10(self.high)) + 1)
            parts = INSIDE if is_short else (1.0,)
            # Written with powers of ten, 0.1 may come out as 0.1000000001.
            found = [float(f"{part * 10.0**power:.3g}") for power in powers for part in parts]
            found = [value for value in found if self.low <= value <= self.high]
            # Within less than half a decade even steps are more, and rounder, than these.
            if len(found) > (FEWEST if is_short else 1):
                return found
        rough = (self.high - self.low) / most
        size = 10.0 ** floor(log10(rough))
        step = next(part * size for part in (1.0, 2.0, 5.0, 10.0) if part * size >= rough)
        first, last = ceil(self.low / step - 1e-9), floor(self.high / step + 1e-9)
        return [place * step for place in range(first, last + 1)]


def span(parts: Iterable[Array], *, is_log: bool, room: float = 0.06) -> tuple[float, float]:
    """Return the ends of an axis on which all values that are finite are seen.

    ``room`` is the space beyond them, as a share of what they span.
    """
    values = np.concatenate([np.zeros(0), *map(np.ravel, parts)])
    values = values[np.isfinite(values)]
    if not values.size:
        return (1.0, 10.0) if is_log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if is_log:
        factor = max((high / low) ** room, 1.05)
        return low / factor, high * factor
    margin = room * (high - low) or abs(high) or 1.0
    return low - margin, high + margin


WIDTH, LEFT, RIGHT = 493.2, 46.0, 8.0
"""Width of a plot on the A4 page (174 mm, so that letters keep their size), and the room beside its
axes [pt]."""

PANEL, TITLE, FOOT = 50.0, 13.0, 26.0
"""Heights of a panel, its title and the x labels [pt]."""

ROW, SAMPLE, SPACE = 11.0, 24.0, 14.0
"""Of a legend: height of a row, length of a line, space behind an entry [pt]."""

ALONG = 12
"""Steps along a plot, at most."""

LIMIT = ("#000000", (2.0, 2.0), 0.7)
LINES: tuple[tuple[str, tuple[float, ...], float], ...] = (
    ("#7f7f7f", (1.4, 1.4), 1.4),
    ("#c44e00", (5.0, 1.5), 1.0),
    ("#00795c", (4.0, 1.2, 1.0, 1.2), 1.0),
    ("#7a3e9d", (7.0, 1.2, 1.0, 1.2, 1.0, 1.2), 1.0),
    ("#0b4f9e", (), 1.2),
    ("#d00000", (), 2.2),
)
"""Colour, dashes and width of a limit, and of a curve by its style; dashes tell the lines apart in
a black-and-white print."""


def draw_svg(plot: LinePlot, *, decimal_mark: str = ".", panel_height: float = PANEL) -> str:
    """Return a plot as SVG; the same plot always gives the same text."""
    lines = [line for panel in plot.panels for line in panel.lines]
    rows = legend_rows(legend_of(plot))
    top = len(rows) * ROW
    canvas = Canvas(WIDTH, top + len(plot.panels) * (TITLE + panel_height) + FOOT)
    _draw_legend(canvas, rows)
    low, high = span([line.x for line in lines], is_log=plot.x_is_log, room=0.01)
    x = Axis(low=low, high=high, begin=LEFT, end=WIDTH - RIGHT, is_log=plot.x_is_log)
    for panel in plot.panels:
        canvas.text(LEFT, top + TITLE - 4.0, panel.y_label)
        top += TITLE
        _draw_panel(canvas, panel, x, top, top + panel_height, decimal_mark)
        top += panel_height
    _label_x(canvas, x, top, plot.x_label, decimal_mark)
    return canvas.finish()


def _draw_panel(
    canvas: Canvas, panel: Panel, x: Axis, top: float, bottom: float, decimal_mark: str
) -> None:
    values = [line.y for line in panel.lines] + [np.array([b.y]) for b in panel.borders]
    low, high = span(values, is_log=False)
    y = Axis(low=low, high=high, begin=bottom, end=top)
    _draw_grid(canvas, x, y, decimal_mark)
    box = (x.begin, y.end, x.end, y.begin)
    canvas.clip(box)
    for border in panel.borders:
        _draw_limit(canvas, x, y, border.y)
    for line in panel.lines:
        color, dashes, width = LINES[line.style]
        canvas.line(_course(line, x, y), color=color, dashes=dashes, width=width)
    canvas.unclip()
    canvas.box(box)


def _course(line: Line, x: Axis, y: Axis) -> Array:
    px, py = x.at(line.x), y.at(line.y)
    if line.is_stepped:
        px, py = np.repeat(px, 2)[1:], np.repeat(py, 2)[:-1]
    return np.column_stack([px, py])


def _draw_grid(canvas: Canvas, x: Axis, y: Axis, decimal_mark: str) -> None:
    for tick in x.ticks(most=ALONG):
        place = float(x.at(tick))
        canvas.line(np.array([[place, y.begin], [place, y.end]]), color=GRID, width=0.4)
    for tick in y.ticks():
        place = float(y.at(tick))
        canvas.line(np.array([[x.begin, place], [x.end, place]]), color=GRID, width=0.4)
        words = tick_text(tick, decimal_mark)
        canvas.text(x.begin - 3.0, place + 0.36 * SIZE, words, anchor="end")


def _label_x(canvas: Canvas, x: Axis, bottom: float, label: str, decimal_mark: str) -> None:
    for tick in x.ticks(most=ALONG):
        canvas.text(float(x.at(tick)), bottom + 9.0, tick_text(tick, decimal_mark), anchor="middle")
    canvas.text((x.begin + x.end) / 2, bottom + 20.0, label, anchor="middle")


def _draw_limit(canvas: Canvas, x: Axis, y: Axis, value: float) -> None:
    color, dashes, width = LIMIT
    ends = np.array([[x.begin, float(y.at(value))], [x.end, float(y.at(value))]])
    canvas.line(ends, color=color, dashes=dashes, width=width)


def legend_of(plot: LinePlot) -> list[Line]:
    """Return one curve of each name of a plot, in the order of its panels."""
    return list({line.label: line for panel in plot.panels for line in panel.lines}.values())


def entry_width(line: Line) -> float:
    """Return the width of a curve's entry in a legend, with the space behind it [pt]."""
    return SAMPLE + 4.0 + text_width(line.label) + SPACE


def legend_rows(entries: list[Line]) -> list[list[Line]]:
    """Return the rows of a legend, each with as many entries as fit."""
    room = WIDTH - LEFT - RIGHT + SPACE
    rows: list[list[Line]] = []
    for entry in entries:
        if not rows or sum(map(entry_width, rows[-1])) + entry_width(entry) > room:
            rows.append([])
        rows[-1].append(entry)
    return rows


def _draw_legend(canvas: Canvas, rows: list[list[Line]]) -> None:
    """Draw the rows of a legend, flush right."""
    for k, row in enumerate(rows):
        left = WIDTH - RIGHT - sum(map(entry_width, row)) + SPACE
        base = (k + 1) * ROW - 3.0
        for entry in row:
            color, dashes, width = LINES[entry.style]
            middle, right = base - 0.36 * SIZE, left + SAMPLE
            sample = np.array([[left, middle], [right, middle]])
            canvas.line(sample, color=color, dashes=dashes, width=width)
            canvas.text(right + 4.0, base, entry.label)
            left += entry_width(entry)
