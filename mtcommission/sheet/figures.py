"""Plots of the document as SVG for print."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.messages.quantities import tick_text
from mtcommission.sheet.axes import Axis, span
from mtcommission.sheet.canvas import GRID, INK, SIZE, Canvas, text_width
from mtcommission.sheet.legend import (
    BORDER_DASHES,
    CHOSEN,
    CURSOR,
    LEFT,
    LINES,
    RIGHT,
    ROW,
    STAR,
    WIDTH,
    Entry,
    draw_legend,
    draw_mark,
    legend_rows,
)
from mtcommission.sheet.placement import place_labels, shorten
from mtcommission.sheet.plot_model import HeatMap, Line, LinePlot, Panel, Plot, PointPlot

Array = NDArray[np.float64]

PANEL, TITLE, SQUARE, SCATTER, FOOT = 50.0, 13.0, 128.0, 200.0, 26.0
"""Heights of a panel, its title, a map, named points and the x labels [pt]."""

SCALE_ROOM = 66.0
"""Room for the grey scale to the right of a map [pt]."""

ALONG = 12
"""Steps along a plot, at most."""

LIGHTEST, DARKEST = 0.04, 0.94
"""Share of black at the least and the largest value of a map."""

PIXELS = (480, 240)
"""Columns and rows of a map; its cells need not be equally wide."""


def draw_svg(plot: Plot, *, decimal_mark: str = ".", panel_height: float = PANEL) -> bytes:
    """Return a plot as SVG; the same plot always gives the same bytes.

    Parameters
    ----------
    plot
        Any plot of the document.
    decimal_mark
        For the numbers at the axes.
    panel_height
        Of each panel of a line plot [pt].

    Examples
    --------
    >>> panel = Panel(y_label="a in m/s²", lines=())
    >>> plot = LinePlot(key="k", caption="c", alt="a", x_label="t in ms", x_is_log=False,
    ...     link="k", panels=(panel,))
    >>> draw_svg(plot) == draw_svg(plot)
    True
    """
    if isinstance(plot, LinePlot):
        return _line_plot(plot, decimal_mark, panel_height)
    if isinstance(plot, PointPlot):
        return _point_plot(plot, decimal_mark)
    return _heat_map(plot, decimal_mark)


def _line_plot(plot: LinePlot, decimal_mark: str, panel_height: float) -> bytes:
    named = {line.label: line.style for panel in plot.panels for line in panel.lines}
    rows = legend_rows([Entry(label=label, line=style) for label, style in named.items()])
    top = len(rows) * ROW
    height = top + len(plot.panels) * (TITLE + panel_height) + FOOT
    canvas = Canvas(WIDTH, height)
    draw_legend(canvas, rows, right=WIDTH - RIGHT)
    everything = [line.x for panel in plot.panels for line in panel.lines]
    low, high = span(everything, is_log=plot.x_is_log, room=0.01)
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
    canvas.clip(*box)
    for border in panel.borders:
        _draw_border(canvas, x, y, border.y)
    for line in panel.lines:
        color, dashes, width = LINES[line.style]
        canvas.line(_course(line, x, y), color=color, dashes=dashes, width=width)
    canvas.unclip()
    canvas.frame(*box)


def _course(line: Line, x: Axis, y: Axis) -> Array:
    """Return the points of a curve on paper, shape (n, 2); those that change nothing left out."""
    px, py = x.at(line.x), y.at(line.y)
    if line.is_stepped:
        px, py = np.repeat(px, 2)[1:], np.repeat(py, 2)[:-1]
    return drop_straight(np.column_stack([px, py]))


def drop_straight(points: Array, *, tolerance: float = 0.02) -> Array:
    """Return a line without the points that lie on the straight between those that stay.

    Blocks of 2, 4, 8 ... steps become one straight where all their points are near enough to it,
    so that the error does not grow however many points a gentle bend has.

    Parameters
    ----------
    points
        Shape (n, 2) [pt].
    tolerance
        Distance of any point that is left out from the line that stays [pt]; far below what a
        printer resolves.

    Examples
    --------
    >>> drop_straight(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 0.0]]))
    array([[0., 0.],
           [2., 2.],
           [3., 0.]])
    """
    last, size = len(points) - 1, 1
    keep = np.ones(len(points), dtype=bool)
    while size < last:
        size *= 2
        starts = np.arange(0, last, size)
        places = np.minimum(starts[:, None] + np.arange(size + 1), last)
        blocks = points[places]
        offsets, chords = blocks - blocks[:, :1], blocks[:, -1:] - blocks[:, :1]
        squares = np.maximum(np.sum(chords**2, axis=2, keepdims=True), 1e-300)
        along = np.clip(np.sum(offsets * chords, axis=2, keepdims=True) / squares, 0.0, 1.0)
        gaps = np.linalg.norm(offsets - along * chords, axis=2)
        keep[places[np.all(gaps <= tolerance, axis=1), 1:-1]] = False
        keep[last] = True
    return np.asarray(points[keep])


def _point_plot(plot: PointPlot, decimal_mark: str) -> bytes:
    bottom = TITLE + SCATTER
    canvas = Canvas(WIDTH, bottom + FOOT)
    canvas.text(LEFT, TITLE - 4.0, plot.y_label)
    draw_legend(canvas, [[Entry(label=plot.border.label)]], right=WIDTH - RIGHT)
    places = np.array([[mark.x, mark.y] for mark in plot.marks])
    x_low, x_high = span([places[:, 0]], is_log=True)
    y_low, y_high = span([places[:, 1], np.array([plot.border.y])], is_log=True)
    x = Axis(low=x_low, high=x_high, begin=LEFT, end=WIDTH - RIGHT, is_log=True)
    y = Axis(low=y_low, high=y_high, begin=bottom, end=TITLE, is_log=True)
    _draw_grid(canvas, x, y, decimal_mark)
    _draw_border(canvas, x, y, plot.border.y)
    canvas.frame(x.begin, y.end, x.end, y.begin)
    points = np.column_stack([x.at(places[:, 0]), y.at(places[:, 1])])
    _name_points(canvas, [mark.label for mark in plot.marks], points, x, y)
    for mark, point in zip(plot.marks, points, strict=True):
        draw_mark(canvas, mark.style, point)
    _label_x(canvas, x, bottom, plot.x_label, decimal_mark)
    return canvas.finish()


def _name_points(canvas: Canvas, names: list[str], points: Array, x: Axis, y: Axis) -> None:
    """Write its name beside every point, joined to it where it stands off."""
    corner = np.array([x.begin, y.end])
    names = [shorten(name) for name in names]
    sizes = np.array([[text_width(name), SIZE] for name in names])
    centres = corner + place_labels(
        points - corner, sizes, width=x.end - x.begin, height=y.begin - y.end, gap=5.0
    )
    low, high = centres - sizes / 2, centres + sizes / 2
    nearest = np.clip(points, low, high)
    for point, end in zip(points, nearest, strict=True):
        if np.hypot(*(end - point)) > 1.5 * SIZE:
            canvas.line(np.vstack([point, end]), color="#888888", width=0.4)
    for name, least, most, centre in zip(names, low, high, centres, strict=True):
        box = np.array([least, [most[0], least[1]], most, [least[0], most[1]]])
        canvas.area(box, color="white")
        canvas.text(centre[0], centre[1] + 0.36 * SIZE, name, anchor="middle")


def _heat_map(plot: HeatMap, decimal_mark: str) -> bytes:
    entries = [Entry(label=item.label, line=item.style) for item in plot.contours]
    entries.append(Entry(label=plot.chosen.label, mark=plot.chosen.style, color=CHOSEN))
    rows = legend_rows(entries)
    top = len(rows) * ROW + TITLE
    bottom = top + SQUARE
    canvas = Canvas(WIDTH, bottom + FOOT)
    draw_legend(canvas, rows, right=WIDTH - RIGHT)
    columns, lines = edges(plot.x), edges(plot.y)
    x = Axis(low=columns[0], high=columns[-1], begin=LEFT, end=WIDTH - SCALE_ROOM)
    y = Axis(low=lines[0], high=lines[-1], begin=bottom, end=top)
    box = (x.begin, y.end, x.end, y.begin)
    canvas.text(LEFT, top - 4.0, plot.y_label)
    canvas.text(WIDTH - RIGHT, top - 4.0, plot.value_label, anchor="end")
    canvas.hatch(*box)
    known = plot.values[np.isfinite(plot.values)]
    if known.size:
        low, high = float(known.min()), max(float(known.max()), 1.001 * float(known.min()))
        share = np.log(plot.values / low) / np.log(high / low)
        grey = LIGHTEST + (DARKEST - LIGHTEST) * share
        canvas.picture(
            *box, grey[np.ix_(_cells(lines, PIXELS[1])[::-1], _cells(columns, PIXELS[0]))]
        )
        _draw_scale(canvas, low, high, y, decimal_mark)
    canvas.clip(*box)
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
    canvas.frame(*box)
    _label_ticks(canvas, x, y, decimal_mark)
    _label_x(canvas, x, bottom, plot.x_label, decimal_mark)
    return canvas.finish()


def edges(values: Array) -> Array:
    """Return the edges of the cells about some values, shape (n + 1,).

    Examples
    --------
    >>> edges(np.array([1.0, 2.0, 4.0]))
    array([0.5, 1.5, 3. , 5. ])
    """
    if values.size == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = (values[:-1] + values[1:]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def _cells(borders: Array, count: int) -> NDArray[np.intp]:
    """Return which cell each of so many equal steps lies in."""
    centres = borders[0] + (borders[-1] - borders[0]) * (np.arange(count) + 0.5) / count
    return np.asarray(np.clip(np.searchsorted(borders, centres) - 1, 0, borders.size - 2))


def _draw_scale(canvas: Canvas, low: float, high: float, y: Axis, decimal_mark: str) -> None:
    left = WIDTH - SCALE_ROOM + 12.0
    steps = np.linspace(DARKEST, LIGHTEST, PIXELS[1])[:, None]
    canvas.picture(left, y.end, left + 11.0, y.begin, steps)
    canvas.frame(left, y.end, left + 11.0, y.begin)
    for share in np.linspace(0.0, 1.0, 6):
        value, place = low * (high / low) ** share, y.begin + share * (y.end - y.begin)
        words = tick_text(float(f"{value:.3g}"), decimal_mark)
        # The uppermost number keeps away from the title above it.
        canvas.text(left + 15.0, max(place + 0.36 * SIZE, y.end + 0.9 * SIZE), words)


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


def _draw_border(canvas: Canvas, x: Axis, y: Axis, value: float) -> None:
    place = float(y.at(value))
    canvas.line(np.array([[x.begin, place], [x.end, place]]), dashes=BORDER_DASHES, width=CURSOR)
