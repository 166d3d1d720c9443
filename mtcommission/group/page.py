"""The interactive page of a group: what can be moved, what it is called, and what it is drawn from.

Circles and corners are computed by group.js; this gives it how both axes answer, in the nominal
machine and the corners that are ever worst.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.control import Corner
from mtcommission.controls.kinds import CONTROLS
from mtcommission.group.ballbar import SINCE, reverses
from mtcommission.group.contours import Pair, find_entries, turnings, worst_circle
from mtcommission.group.follow import Follower
from mtcommission.group.record import GroupRecord
from mtcommission.record.moves import rounded
from mtcommission.record.shape import finite_or_none, to_plain
from mtcommission.sheet.what_if import Field

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

PLACES = ("value", "limit", "name", "size")

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
    places = {place: f"{{{place}}}" for place in PLACES}
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
                "reverses": reverses(axis),
                "real": answers.real.tolist(),
                "imaginary": answers.imag.tolist(),
                "turned": np.round(turning.tool, DECIMALS).tolist(),
                "lag": turning.lag.tolist(),
                "reversals": _reversals(record, axis),
            }
        )
    return {
        "omega": pair[0].omega.tolist(),
        "entry": rounded(find_entries(pair), DIGITS).tolist(),
        "step": turned[0].step,
        "starts": turned[0].starts.tolist(),
        "since": SINCE.tolist(),
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
    circles = ((one.radius, one.feed) for one in record.circle)
    every = []
    for a, off in axis.reversals(circles, record.limits.on_circles[0]).items():
        t = axis.poles.velocity_cycle * np.arange(off.size)
        thrown = rounded(np.interp(SINCE, t, off), DIGITS).tolist()
        every.append({"acceleration": a, "outwards": thrown})
    return every


def _fields(record: GroupRecord, words: Catalogue) -> tuple[Field, ...]:
    fastest = max(record.feed, *(one.feed for one in record.feed_over_radius))
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
