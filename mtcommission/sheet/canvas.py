"""A drawing for print as SVG: lines, texts, symbols and grey pictures, in points."""

from __future__ import annotations

import struct
import zlib
from base64 import b64encode
from html import escape

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIZE = 8.0
"""Font size [pt]; no smaller in print."""

CHARACTER = 0.6
"""Mean width of a character of DejaVu Sans in the names of curves, relative to the font size."""

INK, GRID = "#000000", "#cccccc"


class Canvas:
    """A growing drawing; what is drawn later lies on top.

    Parameters
    ----------
    width, height
        Of the drawing [pt].
    """

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

    def area(self, points: Array, *, color: str, edge: str = "none", width: float = 0.6) -> None:
        """Fill the polygon through points, shape (n, 2)."""
        self._parts.append(
            f'<path d="{_path(points)}Z" fill="{color}" stroke="{edge}" stroke-width="{width:g}"/>'
        )

    def frame(self, left: float, top: float, right: float, bottom: float) -> None:
        """Draw the edge of a pair of axes."""
        self._parts.append(
            f'<rect {_box(left, top, right, bottom)} fill="none" stroke="{INK}"'
            ' stroke-width="0.6"/>'
        )

    def text(
        self, x: float, y: float, words: str, *, anchor: str = "start", turned: bool = False
    ) -> None:
        """Write words on a base line; anchor is start, middle or end; turned reads upwards."""
        turn = f' transform="rotate(-90 {x:.2f} {y:.2f})"' if turned else ""
        self._parts.append(
            f'<text x="{x:.2f}" y="{y:.2f}" text-anchor="{anchor}"{turn}>{escape(words)}</text>'
        )

    def picture(self, left: float, top: float, right: float, bottom: float, grey: Array) -> None:
        """Show a grey picture, shape (rows, columns): 0 is white, 1 black, nan is not there."""
        data = b64encode(write_png(grey)).decode()
        self._parts.append(
            f'<image {_box(left, top, right, bottom)} preserveAspectRatio="none" '
            f'image-rendering="optimizeSpeed" href="data:image/png;base64,{data}"/>'
        )

    def hatch(self, left: float, top: float, right: float, bottom: float) -> None:
        """Fill a box with slanted lines."""
        self._parts.append(
            '<pattern id="hatch" width="4" height="4" patternUnits="userSpaceOnUse">'
            '<path d="M0 4L4 0" stroke="#888888" stroke-width="0.5"/></pattern>'
            f'<rect {_box(left, top, right, bottom)} fill="url(#hatch)"/>'
        )

    def clip(self, left: float, top: float, right: float, bottom: float) -> None:
        """Cut off what is drawn from here on outside a box, until ``unclip``."""
        self._clips += 1
        self._parts.append(
            f'<clipPath id="c{self._clips}"><rect {_box(left, top, right, bottom)}/></clipPath>'
            f'<g clip-path="url(#c{self._clips})">'
        )

    def unclip(self) -> None:
        """End what ``clip`` began."""
        self._parts.append("</g>")

    def finish(self) -> bytes:
        """Return the drawing; the same calls always give the same bytes."""
        head = (
            '<svg xmlns="http://www.w3.org/2000/svg" '
            f'width="{self.width:g}pt" height="{self.height:g}pt" '
            f'viewBox="0 0 {self.width:g} {self.height:g}" '
            f'font-family="DejaVu Sans" font-size="{SIZE:g}">'
        )
        return (head + "".join(self._parts) + "</svg>").encode()


def text_width(words: str) -> float:
    """Return about how wide words are [pt]; short ones may be a few per cent wider."""
    return CHARACTER * SIZE * len(words)


def write_png(grey: Array) -> bytes:
    r"""Return a grey picture as PNG.

    Parameters
    ----------
    grey
        Shape (rows, columns), 0 white to 1 black; nan is transparent.

    Source: Portable Network Graphics Specification (ISO/IEC 15948), colour type 4.

    Examples
    --------
    >>> write_png(np.zeros((2, 3)))[:8]
    b'\x89PNG\r\n\x1a\n'
    """
    rows, columns = grey.shape
    known = np.isfinite(grey)
    light = np.rint(255.0 * (1.0 - np.clip(np.where(known, grey, 0.0), 0.0, 1.0)))
    pixels = np.stack([light, np.where(known, 255.0, 0.0)], axis=2).astype(np.uint8)
    lines = np.hstack([np.zeros((rows, 1), np.uint8), pixels.reshape(rows, 2 * columns)])
    head = struct.pack(">IIBBBBB", columns, rows, 8, 4, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(lines.tobytes(), 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, data) for name, data in chunks)


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _path(points: Array) -> str:
    places = (f"{x:.2f} {y:.2f}" for x, y in np.asarray(points).tolist())
    return "M" + "L".join(places)


def _box(left: float, top: float, right: float, bottom: float) -> str:
    return f'x="{left:.2f}" y="{top:.2f}" width="{right - left:.2f}" height="{bottom - top:.2f}"'


def corner_points(sides: int, radius: float, *, inner: float = 1.0) -> Array:
    """Return the corners of a regular polygon about 0, or of a star.

    Parameters
    ----------
    sides
        Corners, or points of the star.
    radius
        Of the corners [pt].
    inner
        Radius of the notches between the points of a star, relative; 1: a polygon.

    Returns
    -------
    ndarray
        Shape (2 sides, 2), first corner on top.
    """
    angle = np.arange(2 * sides) * np.pi / sides
    far = np.where(np.arange(2 * sides) % 2 == 0, radius, radius * inner)
    return np.column_stack([far * np.sin(angle), -far * np.cos(angle)])
