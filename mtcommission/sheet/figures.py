"""Plots of the document as SVG for print, with legends and axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.quantities import tick_text
from mtcommission.sheet.canvas import (
    GRID,
    INK,
    SIZE,
    Axis,
    Canvas,
    corner_points,
    place_labels,
    shorten,
    span,
    text_width,
)
from mtcommission.sheet.document import HeatMap, Line, LinePlot, Panel, Plot, PointPlot

Array = NDArray[np.float64]

WIDTH, LEFT, RIGHT = 493.2, 46.0, 8.0
"""Width of a plot on the A4 page (174 mm, so that letters keep their size), and the room beside its
axes [pt]."""

PANEL, TITLE, SQUARE, SCATTER, FOOT = 50.0, 13.0, 128.0, 200.0, 26.0
"""Heights of a panel, its title, a map, named points and the x labels [pt]."""

ROW, SAMPLE, SPACE = 11.0, 24.0, 14.0
"""Of a legend: height of a row, length of a line, space behind an entry [pt]."""

SCALE_ROOM = 66.0
"""Room for the grey scale to the right of a map [pt]."""

ALONG = 12
"""Steps along a plot, at most."""

LIGHTEST, DARKEST, SHADES = 0.04, 0.94, 48
"""Share of black at the least and the largest value of a map, and steps of its scale."""

LIMIT = ("#000000", (2.0, 2.0), 0.7)
LINES: tuple[tuple[str, tuple[float, ...], float], ...] = (
    ("#7f7f7f", (1.4, 1.4), 1.4),
    ("#c44e00", (5.0, 1.5), 1.0),
    ("#00795c", (4.0, 1.2, 1.0, 1.2), 1.0),
    ("#7a3e9d", (7.0, 1.2, 1.0, 1.2, 1.0, 1.2), 1.0),
    ("#0b4f9e", (), 1.2),
)
"""Colour, dashes and width of a limit, and of a curve by its style; dashes tell the lines apart in
a black-and-white print."""

STAR = corner_points(5, 6.5, inner=0.4)
SYMBOLS: tuple[tuple[str, Array], ...] = (
    ("#0b4f9e", STAR),
    ("#00795c", np.array([[-2.6, -2.6], [2.6, -2.6], [2.6, 2.6], [-2.6, 2.6]])),
    ("#c44e00", corner_points(8, 2.8)),
)
"""Colour and shape by style of a mark."""

CHOSEN = "#d00000"


@dataclass(frozen=True, slots=True)
class Entry:
    """An entry of a legend: a curve of this style, the chosen point, or (neither) a limit."""

    label: str
    line: int = -1
    is_chosen: bool = False

    @property
    def sample(self) -> float:
        """Width of what stands before the words [pt]."""
        return SAMPLE / 2 if self.is_chosen else SAMPLE

    @property
    def width(self) -> float:
        """Width with the words and the space behind them [pt]."""
        return self.sample + 4.0 + text_width(self.label) + SPACE


def draw_svg(plot: Plot, *, decimal_mark: str = ".", panel_height: float = PANEL) -> str:
    """Return a plot as SVG; the same plot always gives the same text."""
    if isinstance(plot, LinePlot):
        return _line_plot(plot, decimal_mark, panel_height)
    if isinstance(plot, PointPlot):
        return _point_plot(plot, decimal_mark)
    return _heat_map(plot, decimal_mark)


def _line_plot(plot: LinePlot, decimal_mark: str, panel_height: float) -> str:
    lines = [line for panel in plot.panels for line in panel.lines]
    rows = legend_rows([Entry(*one) for one in {line.label: line.style for line in lines}.items()])
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


def _point_plot(plot: PointPlot, decimal_mark: str) -> str:
    bottom = TITLE + SCATTER
    canvas = Canvas(WIDTH, bottom + FOOT)
    canvas.text(LEFT, TITLE - 4.0, plot.y_label)
    _draw_legend(canvas, [[Entry(plot.border.label)]])
    places = np.array([[mark.x, mark.y] for mark in plot.marks])
    x, y = point_axes(plot, (LEFT, TITLE, WIDTH - RIGHT, bottom))
    _draw_grid(canvas, x, y, decimal_mark)
    _draw_limit(canvas, x, y, plot.border.y)
    canvas.box((x.begin, y.end, x.end, y.begin))
    points = np.column_stack([x.at(places[:, 0]), y.at(places[:, 1])])
    _name_points(canvas, [mark.label for mark in plot.marks], points, x, y)
    for mark, point in zip(plot.marks, points, strict=True):
        color, shape = SYMBOLS[mark.style]
        canvas.area(shape + point, color=color)
    _label_x(canvas, x, bottom, plot.x_label, decimal_mark)
    return canvas.finish()


def point_axes(plot: PointPlot, box: tuple[float, float, float, float]) -> tuple[Axis, Axis]:
    """Return the logarithmic axes on which all points and the band are seen."""
    left, top, right, bottom = box
    x, y = (np.array([getattr(mark, name) for mark in plot.marks]) for name in "xy")
    (x_low, x_high) = span([x], is_log=True)
    (y_low, y_high) = span([y, np.array([plot.border.y])], is_log=True)
    return (
        Axis(low=x_low, high=x_high, begin=left, end=right, is_log=True),
        Axis(low=y_low, high=y_high, begin=bottom, end=top, is_log=True),
    )


def _name_points(canvas: Canvas, names: list[str], points: Array, x: Axis, y: Axis) -> None:
    """Write its name beside every point, joined to it where it stands off."""
    corner, names = np.array([x.begin, y.end]), [shorten(name) for name in names]
    sizes = np.array([[text_width(name), SIZE] for name in names])
    centres = corner + place_labels(
        points - corner, sizes, width=x.end - x.begin, height=y.begin - y.end, gap=5.0
    )
    low, high = centres - sizes / 2, centres + sizes / 2
    for point, end in zip(points, np.clip(points, low, high), strict=True):
        if np.hypot(*(end - point)) > 1.5 * SIZE:
            canvas.line(np.vstack([point, end]), color="#888888", width=0.4)
    for name, least, most, centre in zip(names, low, high, centres, strict=True):
        canvas.box((least[0], least[1], most[0], most[1]), color="white", edge="none")
        canvas.text(centre[0], centre[1] + 0.36 * SIZE, name, anchor="middle")


def _heat_map(plot: HeatMap, decimal_mark: str) -> str:
    entries = [Entry(item.label, item.style) for item in plot.contours]
    rows = legend_rows([*entries, Entry(plot.chosen.label, is_chosen=True)])
    top = len(rows) * ROW + TITLE
    bottom = top + SQUARE
    canvas = Canvas(WIDTH, bottom + FOOT)
    _draw_legend(canvas, rows)
    columns, lines = edges(plot.x), edges(plot.y)
    x = Axis(low=columns[0], high=columns[-1], begin=LEFT, end=WIDTH - SCALE_ROOM)
    y = Axis(low=lines[0], high=lines[-1], begin=bottom, end=top)
    box = (x.begin, y.end, x.end, y.begin)
    canvas.text(LEFT, top - 4.0, plot.y_label)
    canvas.text(WIDTH - RIGHT, top - 4.0, plot.value_label, anchor="end")
    canvas.hatch(box)
    known = plot.values[np.isfinite(plot.values)]
    if known.size:
        low, high = float(known.min()), max(float(known.max()), 1.001 * float(known.min()))
        across, down = x.at(columns), y.at(lines)
        for row, column in np.argwhere(np.isfinite(plot.values)):
            share = np.log(plot.values[row, column] / low) / np.log(high / low)
            cell = (across[column], down[row + 1], across[column + 1], down[row])
            canvas.box(cell, color=_grey(share), edge=_grey(share))
        _draw_scale(canvas, low, high, y, decimal_mark)
    canvas.clip(box)
    for contour in plot.contours:
        color, dashes, width = LINES[contour.style]
        for path in contour.paths:
            points = np.column_stack([x.at(path[:, 0]), y.at(path[:, 1])])
            # A white edge, so that the line is seen on every shade.
            canvas.line(points, color="white", width=width + 1.6)
            canvas.line(points, color=color, dashes=dashes, width=width)
    star = np.array([float(x.at(plot.chosen.x)), float(y.at(plot.chosen.y))])
    canvas.area(STAR + star, color=CHOSEN, edge=INK)
    canvas.unclip()
    canvas.box(box)
    _label_ticks(canvas, x, y, decimal_mark)
    _label_x(canvas, x, bottom, plot.x_label, decimal_mark)
    return canvas.finish()


def _grey(share: float) -> str:
    level = round(255 * (1.0 - LIGHTEST - (DARKEST - LIGHTEST) * share))
    return f"#{level:02x}{level:02x}{level:02x}"


def edges(values: Array) -> Array:
    """Return the edges of the cells about some values, shape (n + 1,)."""
    if values.size == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = (values[:-1] + values[1:]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def _draw_scale(canvas: Canvas, low: float, high: float, y: Axis, decimal_mark: str) -> None:
    left, height = WIDTH - SCALE_ROOM + 12.0, y.begin - y.end
    for k in range(SHADES):
        ends = (y.begin - height * (k + 1) / SHADES, y.begin - height * k / SHADES)
        shade = _grey((k + 0.5) / SHADES)
        canvas.box((left, ends[0], left + 11.0, ends[1]), color=shade, edge=shade)
    canvas.box((left, y.end, left + 11.0, y.begin))
    for share in np.linspace(0.0, 1.0, 6):
        words = tick_text(float(f"{low * (high / low) ** share:.3g}"), decimal_mark)
        # The uppermost number keeps away from the title above it.
        place = max(y.begin - share * height + 0.36 * SIZE, y.end + 0.9 * SIZE)
        canvas.text(left + 15.0, place, words)


def _draw_grid(canvas: Canvas, x: Axis, y: Axis, decimal_mark: str) -> None:
    for tick in x.ticks(most=ALONG):
        place = float(x.at(tick))
        canvas.line(np.array([[place, y.begin], [place, y.end]]), color=GRID, width=0.4)
    for tick in y.ticks():
        place = float(y.at(tick))
        canvas.line(np.array([[x.begin, place], [x.end, place]]), color=GRID, width=0.4)
    _label_ticks(canvas, x, y, decimal_mark)


def _label_ticks(canvas: Canvas, x: Axis, y: Axis, decimal_mark: str) -> None:
    for tick in y.ticks():
        words = tick_text(tick, decimal_mark)
        canvas.text(x.begin - 3.0, float(y.at(tick)) + 0.36 * SIZE, words, anchor="end")


def _label_x(canvas: Canvas, x: Axis, bottom: float, label: str, decimal_mark: str) -> None:
    for tick in x.ticks(most=ALONG):
        canvas.text(float(x.at(tick)), bottom + 9.0, tick_text(tick, decimal_mark), anchor="middle")
    canvas.text((x.begin + x.end) / 2, bottom + 20.0, label, anchor="middle")


def _draw_limit(canvas: Canvas, x: Axis, y: Axis, value: float) -> None:
    color, dashes, width = LIMIT
    ends = np.array([[x.begin, float(y.at(value))], [x.end, float(y.at(value))]])
    canvas.line(ends, color=color, dashes=dashes, width=width)


def legend_rows(entries: list[Entry]) -> list[list[Entry]]:
    """Return the rows of a legend, each with as many entries as fit."""
    room = WIDTH - LEFT - RIGHT + SPACE
    rows: list[list[Entry]] = []
    for entry in entries:
        if not rows or sum(one.width for one in rows[-1]) + entry.width > room:
            rows.append([])
        rows[-1].append(entry)
    return rows


def _draw_legend(canvas: Canvas, rows: list[list[Entry]]) -> None:
    """Draw the rows of a legend at the top of a plot, flush right."""
    for k, row in enumerate(rows):
        left = WIDTH - RIGHT - sum(entry.width for entry in row) + SPACE
        base = (k + 1) * ROW - 3.0
        for entry in row:
            middle, right = base - 0.36 * SIZE, left + entry.sample
            if entry.is_chosen:
                canvas.area(STAR + np.array([(left + right) / 2, middle]), color=CHOSEN, edge=INK)
            else:
                color, dashes, width = LIMIT if entry.line < 0 else LINES[entry.line]
                sample = np.array([[left, middle], [right, middle]])
                canvas.line(sample, color=color, dashes=dashes, width=width)
            canvas.text(right + 4.0, base, entry.label)
            left += entry.width
