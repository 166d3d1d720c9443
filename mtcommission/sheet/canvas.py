"""A drawing for print as SVG, its axes from values to places, and where names of points stand."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from math import ceil, floor, log10, pi

import numpy as np
from numpy.typing import NDArray

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

DIRECTIONS = 16
RINGS = (1.0, 1.6, 2.4, 3.4, 4.6, 6.0, 8.0, 11.0)
"""Directions and distances tried for the name of a point, the nearest first."""

AIR = 0.5
"""Room kept free around a name."""

LONGEST = 36
"""Letters of a name that stands beside its point."""


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

    def area(self, points: Array, *, color: str, edge: str = "none") -> None:
        """Fill the polygon through points, shape (n, 2)."""
        self._parts.append(f'<path d="{_path(points)}Z" fill="{color}" stroke="{edge}"/>')

    def box(self, box: Box, *, color: str = "none", edge: str = INK) -> None:
        """Draw the edge of a box, or fill it."""
        self._parts.append(
            f'<rect {_rectangle(box)} fill="{color}" stroke="{edge}" stroke-width="0.6"/>'
        )

    def text(self, x: float, y: float, words: str, *, anchor: str = "start") -> None:
        """Write words on a base line; anchor is start, middle or end."""
        self._parts.append(
            f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}">{escape(words)}</text>'
        )

    def hatch(self, box: Box) -> None:
        """Fill a box with slanted lines."""
        self._parts.append(
            '<pattern id="hatch" width="4" height="4" patternUnits="userSpaceOnUse">'
            '<path d="M0 4L4 0" stroke="#888888" stroke-width="0.5"/></pattern>'
        )
        self.box(box, color="url(#hatch)", edge="none")

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

    def finish(self) -> str:
        """Return the drawing; the same calls always give the same text."""
        return (
            '<svg xmlns="http://www.w3.org/2000/svg" '
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


def corner_points(sides: int, radius: float, *, inner: float = 1.0) -> Array:
    """Return the corners of a star, shape (2 sides, 2), the first on top; inner 1: a polygon."""
    angle = np.arange(2 * sides) * pi / sides
    far = np.where(np.arange(2 * sides) % 2 == 0, radius, radius * inner)
    return np.column_stack([far * np.sin(angle), -far * np.cos(angle)])


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


def shorten(name: str) -> str:
    """Return a name as it stands beside its point; what is longer ends in an ellipsis."""
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"


def place_labels(points: Array, sizes: Array, *, width: float, height: float, gap: float) -> Array:
    """Return the centres of names beside their points, shape (n, 2), in a frame that begins at 0.

    Each takes the first place of ``RINGS`` by ``DIRECTIONS`` that covers neither a point, half as
    wide as ``gap``, nor a name before it; where there is none, the one that covers least.
    """
    # To the right first, then alternately up and down.
    turns = np.array([(k + 1) // 2 * (-1) ** k for k in range(DIRECTIONS)])
    angle = 2 * pi * turns / DIRECTIONS
    toward = np.column_stack([np.cos(angle), -np.sin(angle)])
    taken, centres = np.hstack([points - gap, points + gap]), np.zeros_like(points)
    for k, (point, size) in enumerate(zip(points, sizes, strict=True)):
        reach = np.array([gap * ring + 1.0 + size / 2 for ring in RINGS])
        tried = point + (reach[:, None, :] * toward).reshape(-1, 2)
        spots = np.hstack([tried - size / 2 - AIR, tried + size / 2 + AIR])
        over = np.maximum(spots[:, 2:] - (width, height), 0.0) + np.maximum(-spots[:, :2], 0.0)
        best = int(np.argmin(_covered(spots, taken) + 10.0 * over.sum(axis=1)))
        centres[k] = tried[best]
        taken = np.vstack([taken, spots[best]])
    return centres


def _covered(spots: Array, others: Array) -> Array:
    """The area of each spot that others cover, shape (n,)."""
    low = np.maximum(spots[:, None, :2], others[None, :, :2])
    high = np.minimum(spots[:, None, 2:], others[None, :, 2:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=2).sum(axis=1))
