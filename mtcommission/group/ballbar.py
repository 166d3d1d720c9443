"""Circles as a circle test sees them, the deviation magnified about the nominal circle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10, pi

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.group.contours import Pair
from mtcommission.group.follow import AFTER, Follower, filter_lag
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

SINCE = AFTER * (np.arange(121) / 120) ** 1.5
"""When after a reversal the tool is looked at, close together where it moves most [s]."""

PLACES = 720
"""Of a circle that are drawn, beside those after each reversal."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """A circle as a ballbar sees it: radius less the nominal one over the angle."""

    angle: Array  # [rad]
    deviation: Array  # outwards positive [m]

    @property
    def largest(self) -> float:
        """Radial deviation F_max of ISO 230-4 [m]."""
        return float(self.deviation.max())

    @property
    def least(self) -> float:
        """Radial deviation F_min of ISO 230-4 [m]."""
        return float(self.deviation.min())

    @property
    def circular(self) -> float:
        """Circular deviation G of ISO 230-4 about the centre: largest less smallest radius [m]."""
        return self.largest - self.least


def trace_circle(pair: Pair, *, radius: float, feed: float) -> Trace:
    """Return how the nominal machine draws a circle, counterclockwise, its reversals included."""
    omega, quarters = feed / radius, (0.0, 0.5 * pi)
    late = [quarter + omega * reverses(axis) for axis, quarter in zip(pair, quarters, strict=True)]
    every = [np.arange(PLACES) * 2.0 * pi / PLACES]
    every += [half + after + omega * SINCE for after in late for half in (0.0, pi)]
    phase = np.unique(np.concatenate(every) % (2.0 * pi))
    path = []
    for axis, quarter, after in zip(pair, quarters, late, strict=True):
        answer = axis.response(np.array([omega]))[0, 0]
        position = radius * (answer * np.exp(1j * (phase - quarter))).real
        off = axis.reversal(0, radius=radius, feed=feed)
        if off.size:
            # From one reversal to the next; friction throws the tool to the side it comes from.
            halves, since = np.divmod(phase - after, pi)
            t = axis.poles.velocity_cycle * np.arange(off.size)
            thrown = np.interp(since / omega, t, off, right=0.0)
            position = position + np.where(halves % 2 == 0, thrown, -thrown)
        path.append(position)
    return Trace(angle=np.arctan2(path[1], path[0]), deviation=np.hypot(*path) - radius)


def reverses(axis: Follower) -> float:
    """Return by how much an axis reverses later than it is told, by wait and filter [s]."""
    return axis.wait + filter_lag(axis.setpoint_filter)


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
