"""Block diagrams as SVG, the same for page and paper."""

from __future__ import annotations

from html import escape

from mtcommission.sheet.plot_model import Box, Diagram, Wire

SIZE, LEADING, SUM_RADIUS, MARGIN = 9.5, 12.0, 7.0, 4.0
"""Font size, distance of lines, radius of a summing point and room beside text [drawing units]."""

CHARACTER = 0.64
"""Width of a character relative to the font size; DejaVu Sans is narrower for all but capitals."""


def draw_diagram(diagram: Diagram) -> str:
    """Return a diagram as SVG; colours stand in attributes, so a style sheet may replace them.

    Parameters
    ----------
    diagram
        What to draw.

    Examples
    --------
    >>> box = Box(x=1.0, y=1.0, width=50.0, height=20.0, lines=("a < b",))
    >>> diagram = Diagram(key="k", caption="c", alt="a", width=60.0, height=30.0, boxes=(box,),
    ...     sums=(), wires=(), words=())
    >>> "a &lt; b" in draw_diagram(diagram)
    True
    """
    parts = [_wire(wire) for wire in diagram.wires]
    parts += [
        f'<circle cx="{x:g}" cy="{y:g}" r="{SUM_RADIUS:g}" fill="white" stroke="black"/>'
        for x, y in diagram.sums
    ]
    parts += [_box(box) for box in diagram.boxes]
    parts += [_text(word.x, word.y, word.text, SIZE, "start") for word in diagram.words]
    alt = escape(diagram.alt)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {diagram.width:g} '
        f'{diagram.height:g}" role="img" aria-label="{alt}" font-family="DejaVu Sans, sans-serif">'
        f"{''.join(parts)}</svg>"
    )


def text_size(text: str, width: float) -> float:
    """Return the font size with which a line fits into a box, the usual one at most."""
    return min(SIZE, (width - 2 * MARGIN) / (CHARACTER * max(len(text), 1)))


def _box(box: Box) -> str:
    rect = (
        f'<rect x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" height="{box.height:g}" '
        'fill="white" stroke="black"/>'
    )
    first = box.y + box.height / 2 - LEADING * (len(box.lines) - 1) / 2 + SIZE / 3
    lines = [
        _text(
            box.x + box.width / 2, first + k * LEADING, line, text_size(line, box.width), "middle"
        )
        for k, line in enumerate(box.lines)
    ]
    return rect + "".join(lines)


def _text(x: float, y: float, text: str, size: float, anchor: str) -> str:
    return (
        f'<text x="{x:g}" y="{y:.1f}" font-size="{size:.2f}" text-anchor="{anchor}" '
        f'fill="black">{escape(text)}</text>'
    )


def _wire(wire: Wire) -> str:
    points = " ".join(f"{x:g},{y:g}" for x, y in wire.points)
    line = f'<polyline points="{points}" fill="none" stroke="black"/>'
    (x0, y0), (x1, y1) = wire.points[-2:]
    dx, dy = (x1 > x0) - (x1 < x0), (y1 > y0) - (y1 < y0)
    back = [(x1 - 6 * dx + 3 * s * dy, y1 - 6 * dy + 3 * s * dx) for s in (1, -1)]
    head = " ".join(f"{x:g},{y:g}" for x, y in [(x1, y1), *back])
    return f'{line}<polygon points="{head}" fill="black" stroke="none"/>'
