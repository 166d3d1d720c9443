"""What the plots and diagrams of a sheet consist of, before any printer draws them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Line:
    """A curve.

    Parameters
    ----------
    label
        For the legend.
    x, y
        In the units of the axes, shape (n,).
    style
        Which line style and colour, counted from 0; the same curve has the same style in
        every panel.
    is_stepped
        Whether the value holds until the next sample.
    """

    label: str
    x: Array
    y: Array
    style: int
    is_stepped: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Border:
    """A horizontal line at a limit.

    Parameters
    ----------
    label, y
        What it is, and where, in the unit of the axis.
    """

    label: str
    y: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panel:
    """Curves over one pair of axes.

    Parameters
    ----------
    y_label
        With the unit.
    lines
        Curves.
    borders
        Limits.
    """

    y_label: str
    lines: tuple[Line, ...]
    borders: tuple[Border, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinePlot:
    """Panels below each other with one common x axis.

    Parameters
    ----------
    key
        Identifier, unique in the document.
    caption, alt
        What it shows; the same in words for those who cannot see it.
    x_label
        With the unit.
    x_is_log
        Whether the x axis is logarithmic.
    link
        Plots with the same link zoom together in the page.
    panels
        From top to bottom.
    """

    key: str
    caption: str
    alt: str
    x_label: str
    x_is_log: bool
    link: str
    panels: tuple[Panel, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A point of a point plot.

    Parameters
    ----------
    label, x, y
        Its name and place, in the units of the axes.
    style
        Which symbol, counted from 0.
    """

    label: str
    x: float
    y: float
    style: int


@dataclass(frozen=True, slots=True, kw_only=True)
class PointPlot:
    """Named points over two logarithmic axes.

    Parameters
    ----------
    key, caption, alt
        As in ``LinePlot``.
    x_label, y_label
        With units.
    marks
        The points.
    border
        The band.
    """

    key: str
    caption: str
    alt: str
    x_label: str
    y_label: str
    marks: tuple[Mark, ...]
    border: Border


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contour:
    """Where a requirement or limit is just kept, as curves in a map.

    Parameters
    ----------
    label
        What is just kept.
    style
        Which line style and colour, as in ``Line``.
    paths
        Each of shape (n, 2): x and y in the units of the axes; empty if it is nowhere reached.
    """

    label: str
    style: int
    paths: tuple[Array, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeatMap:
    """A value over two axes.

    Parameters
    ----------
    key, caption, alt
        As in ``LinePlot``.
    x_label, y_label, value_label
        With units.
    x, y
        Shapes (n_x,) and (n_y,).
    values
        Shape (n_y, n_x); nan where there is no value.
    chosen
        The chosen point.
    contours
        Borders of what is allowed.
    """

    key: str
    caption: str
    alt: str
    x_label: str
    y_label: str
    value_label: str
    x: Array
    y: Array
    values: Array
    chosen: Mark
    contours: tuple[Contour, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """A block of a diagram.

    Parameters
    ----------
    x, y, width, height
        Left, top and size in drawing units.
    lines
        What stands in it.
    """

    x: float
    y: float
    width: float
    height: float
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wire:
    """A signal path of a diagram.

    Parameters
    ----------
    points
        Corners, from the source to the sink, where the arrow stands.
    """

    points: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Word:
    """A word in a diagram.

    Parameters
    ----------
    x, y, text
        Its left end on the base line, and the word.
    """

    x: float
    y: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Diagram:
    """A block diagram.

    Parameters
    ----------
    key, caption, alt
        As in ``LinePlot``.
    width, height
        Of the drawing.
    boxes, wires, words
        What it consists of.
    sums
        Centres of the summing points.
    """

    key: str
    caption: str
    alt: str
    width: float
    height: float
    boxes: tuple[Box, ...]
    sums: tuple[tuple[float, float], ...]
    wires: tuple[Wire, ...]
    words: tuple[Word, ...]


Plot = LinePlot | PointPlot | HeatMap
