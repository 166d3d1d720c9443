"""Plots of the document from curves in SI: units of the axes, and no more points than are seen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Value
from mtcommission.base.messages.quantities import motion_unit
from mtcommission.sheet.document import Border, Line, LinePlot, Panel

Array = NDArray[np.float64]

SETPOINT, OTHER, THIRD, FOURTH, MAIN, MARGIN = range(6)
"""Line styles; the main curve is solid, a margin short and thick."""

MOST_POINTS = 800
"""Points of a curve; more are not seen on paper and swell the page."""


class Curve:
    """A curve in SI, without the points whose value is not known (None or nan)."""

    def __init__(
        self,
        label: str,
        x: ArrayLike,
        y: Array | Sequence[float] | Sequence[float | None],
        style: int = MAIN,
        *,
        stepped: bool = False,
    ) -> None:
        self.label, self.style, self.is_stepped = label, style, stepped
        values = np.array(y, dtype=np.float64)
        known = np.isfinite(values)
        self.x, self.y = np.asarray(x, dtype=np.float64)[known], values[known]


@dataclass(frozen=True, slots=True)
class Signals:
    """One panel: what its axis shows, in which SI unit ("" or "dB": as it is), and its limits."""

    name: str
    unit: str
    curves: Sequence[Curve]
    limits: Sequence[float] = ()
    limit_label: str = ""  # "": the limit with its unit


def line_plot(
    words: Catalogue,
    key: str,
    panels: Iterable[Signals],
    *,
    x: tuple[str, str],
    text: str = "",
    is_log: bool = False,
    link: str = "",
    **values: Value,
) -> LinePlot:
    """Return panels over one axis, ``x`` its name and SI unit.

    The caption is the text ``<text>-caption`` with its values, called as the plot where nothing
    else is said; who cannot see it hears between which values each panel lies.
    """
    panels = tuple(panels)
    name, unit = x
    along = [curve.x for panel in panels for curve in panel.curves]
    scale = words.format.scale_for(along, motion_unit(unit, rotary=words.rotary))
    return LinePlot(
        key=key,
        caption=words.text(f"{text or key}-caption", **values),
        alt=words.text(
            "plot-alt", along=name, panels="; ".join(_range(words, panel) for panel in panels)
        ),
        x_label=label(words, name, scale.unit),
        x_is_log=is_log,
        link=link or key,
        panels=tuple(_panel(words, panel, scale.size) for panel in panels),
    )


def _range(words: Catalogue, shown: Signals) -> str:
    """The panel's name, its curves, and the least and the largest value of all."""
    unit = motion_unit(shown.unit, rotary=words.rotary)
    values = np.concatenate([curve.y for curve in shown.curves])
    ends = (values.min(), values.max()) if values.size else ()
    said = " … ".join(words.format.quantity(float(end), unit) for end in ends)
    return f"{shown.name} ({', '.join(dict.fromkeys(one.label for one in shown.curves))}): {said}"


def _panel(words: Catalogue, shown: Signals, x_size: float) -> Panel:
    f, unit = words.format, motion_unit(shown.unit, rotary=words.rotary)
    limits = np.array(shown.limits, dtype=np.float64)
    scale = f.scale_for([*(curve.y for curve in shown.curves), limits], unit)
    lines = []
    for curve in shown.curves:
        x, y = thin_out(curve.x / x_size, curve.y / scale.size)
        lines.append(
            Line(label=curve.label, x=x, y=y, style=curve.style, is_stepped=curve.is_stepped)
        )
    return Panel(
        y_label=label(words, shown.name, scale.unit),
        lines=tuple(lines),
        borders=tuple(
            Border(label=shown.limit_label or f.quantity(limit, unit), y=limit / scale.size)
            for limit in shown.limits
        ),
    )


def label(words: Catalogue, name: str, unit: str) -> str:
    """Return what stands at an axis."""
    return words.text("in-unit", name=name, unit=unit) if unit else name


def thin_out(x: Array, y: Array) -> tuple[Array, Array]:
    """Return a curve with at most ``MOST_POINTS`` points but with every peak kept.

    Of each bucket of neighbours stay the least and the largest.
    """
    if x.size <= MOST_POINTS:
        return x, y
    size = -(-x.size // (MOST_POINTS // 2 - 1))
    places = np.minimum(np.arange(0, x.size, size)[:, None] + np.arange(size), x.size - 1)
    values, rows = y[places], np.arange(len(places))
    least, largest = places[rows, values.argmin(axis=1)], places[rows, values.argmax(axis=1)]
    keep = np.unique(np.concatenate([[0, x.size - 1], least, largest]))
    return x[keep], y[keep]
