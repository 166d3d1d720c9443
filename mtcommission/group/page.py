"""Circles as a circle test sees them, the deviation magnified: printed, and by sliders.

The page's circles and corners are computed by group.js; this gives it what can be moved, what it is
called, and how both axes answer, in the nominal machine and the corners that are ever worst.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from math import floor, log10, pi
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.control import Corner
from mtcommission.controls.kinds import CONTROLS
from mtcommission.group.contours import (
    SINCE,
    Pair,
    Trace,
    find_entries,
    turnings,
    worst_circle,
)
from mtcommission.group.follow import Follower
from mtcommission.group.record import GroupRecord
from mtcommission.record.moves import rounded
from mtcommission.record.shape import finite_or_none, to_plain
from mtcommission.sheet.document import Diagram
from mtcommission.sheet.figures import GRID, INK, LIMIT, LINES, ROW, SAMPLE, SIZE, WIDTH, Canvas
from mtcommission.sheet.tables import show
from mtcommission.sheet.what_if import Field

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


def micrometres(value: Any, words: Catalogue) -> str:
    """Return a deviation [m] to a nanometre, always in µm: a column of several has one unit."""
    shown = 1e6 * value
    shown = shown if abs(shown) >= 1.0 else round(shown, 3)
    return words.format.with_unit(words.format.number(shown), "µm")


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
    said = {key: micrometres(value, words) for key, value in figures.items()}
    return words.text("group-circle-figures", feed=feed, **said)


FOLDER = Path(__file__).parent

SLOWEST, LARGEST = 0.1 / 60.0, 0.5
"""Feed [m/s] and radius [m] at an end of their sliders."""

DECIMALS, DIGITS = 9, 5
"""Of what is near 1, and of lengths: 1 nm on the largest circle."""

WORDS = (
    "keeps",
    "misses",
    "throws",
    "too-fast",
    "beyond",
    "unslowed",
    "slowed",
    "division",
    "band",
)
"""That the script says, with the places that it fills in."""

FILLED_IN = ("value", "limit", "name", "size")

ROWS = (
    "acceleration", "largest", "radius", "form", "entry", "most", "least", "circular", "peak-1",
    "peak-2", "corner", "speed",
)  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupPanel:
    """What says the template's texts, what can be moved, and what the script computes with."""

    say: Callable[[str], str]
    slider: str
    fields: tuple[Field, ...]
    rows: tuple[tuple[str, str], ...]
    data: Mapping[str, Any]
    template: Path = FOLDER / "group.html"
    scripts: tuple[Path, ...] = (FOLDER / "group.js",)


def contour_panel(record: GroupRecord, pair: Pair, words: Catalogue) -> GroupPanel:
    """Return the interactive part of the page: feed, radius and corner by sliders."""
    fields = _fields(record, words)
    shown = {f"peak-{k}": axis.machine.axis for k, axis in enumerate(pair, start=1)}
    left_out = {
        f"peak-{k}" for k, axis in enumerate(pair, start=1) if not axis.machine.drive.has_friction
    }
    places = {place: f"{{{place}}}" for place in FILLED_IN}
    said = {key.replace("-", "_"): words.text(f"group-page-{key}", **places) for key in WORDS}
    out = words.text(
        "what-if-out-of-range", name="{name}", low="{low}", high="{high}", value="{value}"
    )
    return GroupPanel(
        say=partial(words.own, "group-page"),
        slider=words.text("what-if-slider"),
        fields=fields,
        rows=tuple(
            (key, words.text(f"group-page-row-{key.partition('-')[0]}", name=shown.get(key, "")))
            for key in ROWS
            if key not in left_out
        ),
        data={
            "model": draw_model(record, pair),
            "words": said | {"out_of_range": out},
            "fields": [asdict(field) for field in fields],
        },
    )


def draw_model(record: GroupRecord, pair: Pair) -> dict[str, Any]:
    """Return what circles and corners are drawn from; SI."""
    turned, (a, _), rule = turnings(pair), record.limits.on_circles, record.corner_rule
    _, worst = worst_circle(pair, pair[0].omega)
    places = np.divmod(worst, len(pair[1].on_circles))
    is_arc = rule.kind == Corner.ARC.value
    share = CONTROLS[record.axes[0].loop.kind].corner.share
    axes = []
    for axis, own, turning in zip(pair, places, turned, strict=True):
        answers = np.round(axis.on_circles[sorted({0, *own.tolist()})], DECIMALS)
        axes.append(
            {
                "delay": axis.delay,
                "reverses": axis.reverses,
                "real": answers.real.tolist(),
                "imaginary": answers.imag.tolist(),
                "turned": np.round(turning.tool, DECIMALS).tolist(),
                "lag": turning.lag.tolist(),
                "since": (axis.fades * SINCE).tolist(),
                "reversals": _reversals(record, axis),
            }
        )
    return {
        "omega": pair[0].omega.tolist(),
        "entry": rounded(find_entries(pair), DIGITS).tolist(),
        "step": turned[0].step,
        "starts": turned[0].starts.tolist(),
        "allowed": record.allowed,
        "largest_step": finite_or_none(min(one.largest_step for one in turned)),
        "arc_acceleration": share * a,
        "axes": axes,
        "filter": to_plain(record.filter),
        "arc": rule.value if is_arc else 0.0,
        "tolerance": record.tolerance,
        "acceleration": a,
        "names": record.plane,
    }


def _reversals(record: GroupRecord, axis: Follower) -> list[dict[str, Any]]:
    """How friction throws the tool off behind a reversal, by acceleration."""
    every = []
    for a, off in axis.thrown(record.circles, record.limits.on_circles[0]).items():
        t = axis.poles.velocity_cycle * np.arange(off.size)
        thrown = rounded(np.interp(axis.fades * SINCE, t, off), DIGITS).tolist()
        every.append({"acceleration": a, "outwards": thrown})
    return every


def _fields(record: GroupRecord, words: Catalogue) -> tuple[Field, ...]:
    fastest = max(
        record.feed, *((one.without_peaks or one).feed for one in record.feed_over_radius)
    )
    radii = [one.radius for one in record.feed_over_radius]
    return tuple(
        Field(
            key=key,
            label=words.text(f"group-page-field-{key}"),
            unit=unit,
            size=size,
            low=low,
            high=high,
            least=low,
            most=high,
            value=value,
            log=log,
        )
        for key, unit, size, low, high, value, log in (
            ("feed", "m/min", 1.0 / 60.0, SLOWEST, fastest, record.feed, True),
            ("radius", "mm", 1e-3, min(radii), LARGEST, record.circle[0].radius, True),
            ("angle", "°", pi / 180.0, 5.0 * pi / 180.0, 0.9 * pi, 0.5 * pi, False),
        )
    )
