"""Circles as a circle test draws them: the deviation magnified about the nominal circle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, log10, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.group.drawn import Trace
from mtcommission.messages.catalogue import Catalogue
from mtcommission.sheet.document import Diagram
from mtcommission.sheet.figures import GRID, INK, LIMIT, LINES, ROW, SAMPLE, SIZE, WIDTH, Canvas
from mtcommission.sheet.tables import show

Array = NDArray[np.float64]

HALF, NOMINAL, BAND = 112.0, 66.0, 34.0
"""Half of the square, radius of the nominal circle, and room on either side of it [pt]."""

DIVISIONS = 3
"""On either side of the nominal circle, about."""

STYLES = (1, 2, 4, 3)
"""Of the curves, slowest feed first."""

BESIDE = 2.0 * HALF + 26.0
"""Where the words beside the circle begin [pt]."""

TURN = np.linspace(0.0, 2.0 * pi, 181)


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """How much a deviation is magnified."""

    division: float  # [m]
    most: float  # deviation that still fits [m]
    radius: float  # of the nominal circle [m]

    @property
    def magnification(self) -> float:
        """Of deviations, beside the circle itself [-]."""
        return BAND / self.most * self.radius / NOMINAL

    def at(self, angle: Array, deviation: Array | float) -> Array:
        """Return the places of deviations, (n, 2) [pt]."""
        r = np.maximum(NOMINAL + BAND / self.most * np.asarray(deviation), 0.0)
        return np.column_stack([HALF + r * np.cos(angle), HALF - r * np.sin(angle)])


def find_scale(radius: float, tolerance: float, traces: Sequence[Trace]) -> Scale:
    """Return a scale of round divisions on which the tolerance and all of the traces are seen."""
    seen = max(tolerance, *(float(np.abs(trace.deviation).max()) for trace in traces))
    size = 10.0 ** floor(log10(seen / DIVISIONS))
    division = next(
        part * size for part in (1, 2, 5, 10) if part * size >= 0.999 * seen / DIVISIONS
    )
    return Scale(division=division, most=division * ceil(1.05 * seen / division), radius=radius)


def draw_ballbar(
    words: Catalogue,
    *,
    names: Sequence[str],
    radius: float,
    tolerance: float,
    traces: dict[str, Trace],
) -> Diagram:
    """Return circles of one radius by what each is called, slowest feed first."""
    canvas, scale = Canvas(WIDTH, 2.0 * HALF), find_scale(radius, tolerance, list(traces.values()))
    _draw_grid(canvas, scale, names)
    canvas.line(scale.at(TURN, 0.0), width=0.8)
    for side in (tolerance, -tolerance):
        _draw(canvas, scale.at(TURN, side), LIMIT)
    for style, trace in zip(STYLES, traces.values(), strict=False):
        order = np.argsort(trace.angle)
        closed = np.append(order, order[0])
        _draw(canvas, scale.at(trace.angle[closed], trace.deviation[closed]), LINES[style])
    _write(canvas, words, scale, tolerance, traces)
    shown = {"radius": radius, "tolerance": tolerance, "division": scale.division}
    alt = words.text("group-circle-alt", feeds=", ".join(traces), **shown)
    return Diagram(
        key="ballbar",
        caption=words.text("group-circle-caption", radius=radius),
        alt=alt,
        svg=canvas.finish(alt=alt),
    )


def _draw(canvas: Canvas, points: Array, look: tuple[str, tuple[float, ...], float]) -> None:
    color, dashes, width = look
    canvas.line(points, color=color, dashes=dashes, width=width)


def _draw_grid(canvas: Canvas, scale: Scale, names: Sequence[str]) -> None:
    """The cross of the axes and a circle at each division."""
    end = NOMINAL + BAND
    for angle in (0.0, 0.5 * pi):
        cross = np.array([[np.cos(angle), -np.sin(angle)]]) * np.array([[-end], [end]]) + HALF
        canvas.line(cross, color=GRID, width=0.6)
    for k in range(-floor(scale.most / scale.division), floor(scale.most / scale.division) + 1):
        canvas.line(scale.at(TURN, k * scale.division), color=GRID, width=0.4)
    first, second = names
    drop = 0.36 * SIZE
    canvas.text(HALF + end + 2.0, HALF + drop, f"+{first}")
    canvas.text(HALF - end - 2.0, HALF + drop, f"−{first}", anchor="end")
    canvas.text(HALF, HALF - end - 3.0, f"+{second}", anchor="middle")
    canvas.text(HALF, HALF + end + SIZE + 1.0, f"−{second}", anchor="middle")


def _write(
    canvas: Canvas, words: Catalogue, scale: Scale, tolerance: float, traces: dict[str, Trace]
) -> None:
    """What stands beside the circle: scale, and each curve with its figures."""
    top = HALF - 4.5 * ROW
    samples = [
        (LINES[style], _figures(words, name, trace))
        for style, (name, trace) in zip(STYLES, traces.items(), strict=False)
    ]
    samples.append((LIMIT, words.text("group-circle-band", tolerance=tolerance)))
    samples.append(((INK, (), 0.8), words.text("group-circle-nominal")))
    for k, (look, name) in enumerate(samples):
        base = top + 1.3 * ROW * k
        ends = np.array([[BESIDE, base - 0.36 * SIZE], [BESIDE + SAMPLE, base - 0.36 * SIZE]])
        _draw(canvas, ends, look)
        canvas.text(BESIDE + SAMPLE + 5.0, base, name)
    said = (
        words.text("group-circle-division", division=show(scale.division, words, "m")),
        words.text(
            "group-circle-magnified", factor=words.format.number(scale.magnification, digits=2)
        ),
        words.text("group-circle-turn"),
    )
    for k, line in enumerate(said):
        canvas.text(BESIDE, top + 1.3 * ROW * (len(samples) + 0.6 + k), line)


def _figures(words: Catalogue, feed: str, trace: Trace) -> str:
    figures = {"largest": trace.largest, "least": trace.least, "circular": trace.circular}
    return words.text("group-circle-figures", feed=feed, **figures)
