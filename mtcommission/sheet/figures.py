"""Plots of the document as SVG for print, drawn by matplotlib."""

from __future__ import annotations

import re
from io import BytesIO
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter, NullLocator

from mtcommission.sheet.plot_model import Contour, HeatMap, Line, LinePlot, Plot, PointPlot

WIDTH = 6.7
"""Width of a plot on the A4 page [inch]."""

LEFT, RIGHT, TOP, EDGE, BOTTOM, GAP = 0.55, 0.1, 0.35, 0.08, 0.4, 0.2
"""Room around and between axes [inch]; fixed, since an automatic layout takes half of the time."""

LONG_NAME = 60
"""Characters of a name that takes a line of the legend to itself."""

PANEL, SQUARE = 0.8, 1.9
"""Heights of a panel and of a single pair of axes [inch]."""

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 7.0,
    # A machine may be called "$x$".
    "text.parse_math": False,
    "svg.fonttype": "none",
    "svg.hashsalt": "mtcommission",
    "axes.grid": True,
    "axes.linewidth": 0.6,
    "axes.unicode_minus": True,
    "grid.linewidth": 0.4,
    "grid.color": "#cccccc",
    "legend.frameon": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
}
"""Text stays text: the PDF embeds the same font once for page and plots."""

BORDER: dict[str, Any] = {"color": "black", "linewidth": 0.7, "linestyle": (0, (2, 2))}
"""How a limit is drawn."""

LINES: tuple[tuple[str, Any, float], ...] = (
    ("#7f7f7f", (0, (1.0, 1.0)), 1.4),
    ("#c44e00", (0, (5.0, 1.5)), 1.0),
    ("#00795c", (0, (4.0, 1.2, 1.0, 1.2)), 1.0),
    ("#7a3e9d", (0, (7.0, 1.2, 1.0, 1.2, 1.0, 1.2)), 1.0),
    ("#0b4f9e", "solid", 1.2),
)
"""Colour, dashes and width by style; dashes tell the lines apart in a black-and-white print."""

TICK = re.compile(rb"(>[^<>]?\d+)\.(\d+)(?=</text>)")
"""A number that stands alone, as those at the axes do."""

SYMBOLS: tuple[tuple[str, str, float], ...] = (
    ("*", "#0b4f9e", 110.0),
    ("s", "#00795c", 24.0),
    ("o", "#c44e00", 24.0),
)
"""Symbol, colour and size by style of a mark."""


def draw_svg(plot: Plot, *, decimal_mark: str = ".") -> bytes:
    """Return a plot as SVG; the same plot always gives the same bytes.

    Parameters
    ----------
    plot
        Any plot of the document.
    decimal_mark
        For the numbers at the axes.

    Returns
    -------
    bytes

    Examples
    --------
    >>> from mtcommission.sheet.plot_model import Panel
    >>> panel = Panel(y_label="a in m/s²", lines=())
    >>> plot = LinePlot(key="k", caption="c", alt="a", x_label="t in ms", x_is_log=False,
    ...     link="k", panels=(panel,))
    >>> draw_svg(plot) == draw_svg(plot)
    True
    """
    with mpl.rc_context(STYLE):
        if isinstance(plot, LinePlot):
            figure = _line_plot(plot)
        elif isinstance(plot, PointPlot):
            figure = _point_plot(plot)
        else:
            figure = _heat_map(plot)
        stream = BytesIO()
        # No date and no producer: the PDF must be the same bytes tomorrow.
        figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    # Matplotlib takes the mark from the machine's locale; so the numbers are marked here.
    return TICK.sub(rf"\1{decimal_mark}\2".encode(), stream.getvalue())


def _line_plot(plot: LinePlot) -> Figure:
    count = len(plot.panels)
    height = TOP + count * (PANEL + GAP) - GAP + BOTTOM
    figure = Figure(figsize=(WIDTH, height))
    grid = figure.subplots(
        count,
        1,
        sharex=True,
        squeeze=False,
        gridspec_kw={
            "left": LEFT / WIDTH,
            "right": 1.0 - RIGHT / WIDTH,
            "top": 1.0 - TOP / height,
            "bottom": BOTTOM / height,
            "hspace": GAP / PANEL,
        },
    )[:, 0]
    named: dict[str, Any] = {}
    for axes, panel in zip(grid, plot.panels, strict=True):
        for line in panel.lines:
            named.setdefault(line.label, _draw_line(axes, line))
        for border in panel.borders:
            axes.axhline(border.y, **BORDER)
        axes.set_title(panel.y_label, loc="left", fontsize=7.0, pad=3.0)
        if plot.x_is_log:
            axes.set_xscale("log")
            axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
        axes.margins(x=0.01)
    grid[-1].set_xlabel(plot.x_label)
    figure.legend(
        named.values(), named.keys(), loc="upper right", ncols=len(named) or 1, borderaxespad=0.1
    )
    return figure


def _draw_line(axes: Axes, line: Line) -> Any:
    color, dashes, width = LINES[line.style]
    drawstyle = "steps-post" if line.is_stepped else "default"
    (artist,) = axes.plot(
        line.x, line.y, color=color, linestyle=dashes, linewidth=width, drawstyle=drawstyle
    )
    return artist


def _point_plot(plot: PointPlot) -> Figure:
    # The legend names every point below the axes.
    columns = 2 if max(len(mark.label) for mark in plot.marks) < LONG_NAME else 1
    legend = 0.16 * -(-(len(plot.marks) + 1) // columns) + 0.1
    height = EDGE + SQUARE + BOTTOM + legend
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.add_axes(_frame(height, bottom=BOTTOM + legend, right=RIGHT))
    axes.set_xscale("log")
    axes.set_yscale("log")
    for number, mark in enumerate(plot.marks):
        symbol, color, size = SYMBOLS[mark.style]
        name = f"{number} {mark.label}" if number else mark.label
        axes.scatter([mark.x], [mark.y], marker=symbol, color=color, s=size, label=name)
        if number:
            place = (mark.x, mark.y)
            # Up and down in turn, so that neighbours keep their numbers apart.
            beside = (4, 3) if number % 2 else (4, -9)
            axes.annotate(str(number), place, xytext=beside, textcoords="offset points")
    axes.axhline(plot.border.y, label=plot.border.label, **BORDER)
    axes.set_xlabel(plot.x_label)
    axes.set_ylabel(plot.y_label)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        subdivisions = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0) if high < 30.0 * low else (1.0,)
        axis.set_major_locator(LogLocator(subs=subdivisions))
        axis.set_major_formatter(FormatStrFormatter("%.6g"))
        axis.set_minor_formatter(NullFormatter())
    figure.legend(loc="lower left", ncols=columns, fontsize=6.5, borderaxespad=0.2)
    return figure


def _heat_map(plot: HeatMap) -> Figure:
    height = (TOP if plot.contours else EDGE) + SQUARE + BOTTOM
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.add_axes(_frame(height, bottom=BOTTOM, right=1.0))
    # White is the best value of the map, so what did not settle is hatched.
    axes.patch.set(hatch="////", edgecolor="#888888", linewidth=0.0)
    values = np.ma.masked_invalid(plot.values)
    if not values.count():
        axes.set_xlim(plot.x.min(), plot.x.max())
        axes.set_ylim(plot.y.min(), plot.y.max())
    else:
        low, high = float(values.min()), float(values.max())
        mesh = axes.pcolormesh(
            plot.x,
            plot.y,
            values,
            cmap="Greys",
            norm=LogNorm(vmin=low, vmax=max(high, 1.001 * low)),
            shading="nearest",
            rasterized=True,
        )
        scale = figure.add_axes((1.0 - 0.9 / WIDTH, BOTTOM / height, 0.15 / WIDTH, SQUARE / height))
        ticks = np.geomspace(low, max(high, 1.001 * low), 6)
        bar = figure.colorbar(mesh, cax=scale, label=plot.value_label, ticks=ticks, format="%.3g")
        bar.ax.yaxis.set_minor_locator(NullLocator())
    x_range, y_range = axes.get_xlim(), axes.get_ylim()
    named = {contour.label: _draw_contour(axes, contour) for contour in plot.contours}
    axes.set(xlim=x_range, ylim=y_range)
    mark = plot.chosen
    axes.scatter(
        [mark.x], [mark.y], marker="*", color="#d00000", edgecolor="black", s=150, zorder=3
    )
    if named:
        figure.legend(
            named.values(), named.keys(), loc="upper right", ncols=len(named), borderaxespad=0.1
        )
    axes.set_xlabel(plot.x_label)
    axes.set_ylabel(plot.y_label)
    axes.grid(False)
    return figure


def _draw_contour(axes: Axes, contour: Contour) -> Any:
    """Draw a border on a white edge, so that it is seen on every shade."""
    color, dashes, width = LINES[contour.style]
    for path in contour.paths:
        axes.plot(path[:, 0], path[:, 1], color="white", linewidth=width + 1.6)
        (artist,) = axes.plot(
            path[:, 0], path[:, 1], color=color, linestyle=dashes, linewidth=width
        )
    return artist


def _frame(height: float, *, bottom: float, right: float) -> tuple[float, float, float, float]:
    """Return a frame of the usual size, as shares of the figure."""
    return (LEFT / WIDTH, bottom / height, 1.0 - (LEFT + right) / WIDTH, SQUARE / height)
