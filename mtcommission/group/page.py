"""The interactive page of a group: what can be moved, and what it is called.

It computes nothing: group.js does, from what the record holds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from math import pi
from pathlib import Path
from typing import Any

from mtcommission.group.record import GroupRecord
from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.shape import to_plain
from mtcommission.sheet.what_if import Field

FOLDER = Path(__file__).parent

SLOWEST, LARGEST = 0.1 / 60.0, 0.5
"""Feed [m/s] and radius [m] at an end of their sliders."""

WORDS = ("keeps", "misses", "too-fast", "beyond", "unslowed", "slowed", "division", "band")
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


def contour_panel(record: GroupRecord, words: Catalogue) -> GroupPanel:
    """Return the interactive part of the page: feed, radius and corner by sliders."""
    fields, names = _fields(record, words), record.plane
    left_out = set() if record.drawn.axes[0].reversals else {"peak-1"}
    left_out |= set() if record.drawn.axes[1].reversals else {"peak-2"}
    shown = {"peak-1": names[0], "peak-2": names[1]}
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
            "model": to_plain(record.drawn)
            | {
                "filter": to_plain(record.filter),
                "arc": record.corner_rule.value if record.drawn.arc_acceleration else 0.0,
                "tolerance": record.tolerance,
                "path": to_plain(record.path),
                "feed": record.feed,
                "names": names,
            },
            "words": said | {"out_of_range": out},
            "fields": [asdict(field) for field in fields],
        },
    )


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
