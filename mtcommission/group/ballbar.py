"""Circles as a circle test draws them: the deviation magnified about the nominal circle."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10, pi

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

DIVISIONS, SHOWN = 3, 3.3
"""On either side of the nominal circle at most, and what the room is for."""

STYLES = (1, 2, 4, 3)
"""Of the curves, slowest feed first."""

BESIDE = 2.0 * HALF + 26.0
"""Where the words beside the circle begin [pt]."""

TURN = np.linspace(0.0, 2.0 * pi, 181)


def find_division(tolerance: float, traces: Sequence[Trace]) -> float:
    """Return a round division of which few show the tolerance and all of the traces [m]."""
    seen = max(tolerance, *(float(np.abs(trace.deviation).max()) for trace in traces))
    size = 10.0 ** floor(log10(seen / DIVISIONS))
    return next(part * size for part in (1, 2, 5, 10) if part * size >= 0.999 * seen / DIVISIONS)


def _place(angle: Array, divisions: Array | float) -> Array:
    """Places of deviations in divisions, (n, 2) [pt]."""
    r = np.maximum(NOMINAL + BAND / SHOWN * np.asarray(divisions), 0.0)
    return np.column_stack([HALF + r * np.cos(angle), HALF - r * np.sin(angle)])


def draw_ballbar(
    words: Catalogue,
    *,
    names: Sequence[str],
    radius: float,
    tolerance: float,
    traces: dict[str, Trace],
) -> Diagram:
    """Return circles of one radius by what each is called, slowest feed first."""
    canvas, division = Canvas(WIDTH, 2.0 * HALF), find_division(tolerance, list(traces.values()))
    _draw_grid(canvas, names)
    canvas.line(_place(TURN, 0.0), width=0.8)
    for side in (tolerance, -tolerance):
        _draw(canvas, _place(TURN, side / division), LIMIT)
    for style, trace in zip(STYLES, traces.values(), strict=False):
        order = np.argsort(trace.angle)
        closed = np.append(order, order[0])
        _draw(canvas, _place(trace.angle[closed], trace.deviation[closed] / division), LINES[style])
    _write(canvas, words, division, tolerance, traces)
    shown = {"radius": radius, "tolerance": tolerance, "division": division}
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


def _draw_grid(canvas: Canvas, names: Sequence[str]) -> None:
    """The cross of the axes and a circle at each division."""
    end = NOMINAL + BAND
    for angle in (0.0, 0.5 * pi):
        cross = np.array([[np.cos(angle), -np.sin(angle)]]) * np.array([[-end], [end]]) + HALF
        canvas.line(cross, color=GRID, width=0.6)
    for k in range(-DIVISIONS, DIVISIONS + 1):
        canvas.line(_place(TURN, k), color=GRID, width=0.4)
    first, second = names
    drop = 0.36 * SIZE
    canvas.text(HALF + end + 2.0, HALF + drop, f"+{first}")
    canvas.text(HALF - end - 2.0, HALF + drop, f"−{first}", anchor="end")
    canvas.text(HALF, HALF - end - 3.0, f"+{second}", anchor="middle")
    canvas.text(HALF, HALF + end + SIZE + 1.0, f"−{second}", anchor="middle")


def _write(
    canvas: Canvas, words: Catalogue, division: float, tolerance: float, traces: dict[str, Trace]
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
        words.text("group-circle-division", division=show(division, words, "m")),
        words.text("group-circle-turn"),
    )
    for k, line in enumerate(said):
        canvas.text(BESIDE, top + 1.3 * ROW * (len(samples) + 0.6 + k), line)


def _figures(words: Catalogue, feed: str, trace: Trace) -> str:
    figures = {"largest": trace.largest, "least": trace.least, "circular": trace.circular}
    return words.text("group-circle-figures", feed=feed, **figures)
