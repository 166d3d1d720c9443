"""The interactive page: what can be moved, from where to where, in which units.

It computes nothing: engine.js runs the loop, what_if.js shows what comes of it.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from math import pi
from pathlib import Path
from types import MappingProxyType
from typing import Any

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.quantities import motion_unit
from mtcommission.controls.kind import FIR, MOVING_AVERAGE
from mtcommission.machine.checks import say_filter
from mtcommission.machine.moves import size_unit
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.loop import KnownLimitsEntry, WhatIfPart
from mtcommission.record.machine import MachineEntry, Profile
from mtcommission.record.shape import to_plain
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.sheet.html import set_html
from mtcommission.sheet.tables import document_of, say_requirement, show, words_for

FOLDER = Path(__file__).parent

SMALLEST_SHARE = 50.0
"""Of the largest acceleration, at which its slider begins."""

LONGEST_RAMP = 500.0
"""Position cycles of the longest jerk time that the slider of the jerk reaches."""

LARGEST_ERROR = 0.2
"""Of the frequencies, either way [-]."""

OTHER_PAYLOAD = 0.5
"""Of the moving mass, where the profile states less."""

NARROWEST, WIDEST, DEEPEST = 0.02, 1.0, 40.0
"""Width of a notch [-] and its depth [dB]."""

WORDS = (
    "acceleration", "all-corners", "all-met", "damping", "deviation", "field-size",
    "frequencies", "in-unit", "jerk-time", "landscape-none", "landscape-range",
    "landscape-running", "magnitude", "met", "missed-check", "move", "moving-average",
    "frequency", "no-setpoint-filter", "no-notch", "nominal", "not-met", "not-settled",
    "out-of-range", "phase", "ramp", "residual", "saturated", "sizes-met",
    "sizes-missed", "taken", "time", "tried-machine", "unlimited", "unstable", "worst-so-far",
)  # fmt: skip
"""That the script says, with the places that it fills in."""

PLACES = (
    "all", "count", "factor", "high", "least", "limit", "low", "missed", "most", "name", "number",
    "place", "size", "unit", "value",
)  # fmt: skip

ROWS: Mapping[str, str] = MappingProxyType({
    "acceleration": "acceleration", "jerk": "jerk", "jerk-time": "jerk-time",
    "filter": "setpoint-filter", "duration": "what-if-duration", "settling": "settling-time",
    "residual": "residual", "peak": "peak-deviation", "force": "max-force", "verdict": "verdict",
})  # fmt: skip
MARGINS: Mapping[str, str] = MappingProxyType(
    {"gain": "gain-margin", "phase": "phase-margin", "peak": "sensitivity-peak"}
)
"""What the tables of the page show, and what it is called."""

Pair = tuple[str, str]
"""Key in the script, and what is said."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """What can be moved, by a slider and an entry beside it [SI]."""

    key: str
    label: str
    unit: str
    size: float  # one unit in SI
    low: float  # ends of the slider
    high: float
    least: float  # what may be entered
    most: float
    value: float  # to begin with
    log: bool  # whether the slider moves by factors


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """What says the template's texts, what can be moved, and what the script computes with."""

    say: Callable[[str], str]
    moves: tuple[str, ...]
    columns: tuple[str, ...]
    margin_columns: tuple[str, ...]
    filters: tuple[Pair, ...]
    rows: tuple[Pair, ...]
    margin_rows: tuple[Pair, ...]
    fields: tuple[Field, ...]
    follows: bool  # whether the motor follows its setpoint, so that there is no loop to show
    data: Mapping[str, Any]  # for the script, as JSON
    template: Path = FOLDER / "what_if.html"
    scripts: tuple[Path, ...] = (FOLDER / "engine.js", FOLDER / "what_if.js")


def what_if(part: WhatIfPart, words: Catalogue, *, profile: str) -> Panel:
    """Return the interactive part of a page: other limits, moves and machines can be tried.

    ``profile``: name of the profile's file, for the command line.
    """
    filters, has_jerk = _filters(part, words), part.jerk != "none"
    names = {"today": words.text("today"), "recommended": words.text("recommended")}
    units = _units(part, words)
    known = [_known(item, filters) for item in part.limits]
    today = "yes" if any(item.name == "today" for item in part.limits) else "no"
    return Panel(
        say=partial(words.own, "what-if", today=today),
        moves=tuple(
            f"{words.text('move', number=number)}: {show(size_of(move), words, size_unit(move))}"
            for number, move in enumerate(part.moves, start=1)
        ),
        columns=tuple(names[item.name] for item in part.limits),
        margin_columns=tuple(
            words.text(f"what-if-margins-{key}") for key in ("now", "tried", "worst", "worst-tried")
        ),
        filters=tuple((key, item["name"]) for key, item in filters.items()),
        rows=tuple(
            (key, words.text(name))
            for key, name in ROWS.items()
            if has_jerk or key not in ("jerk", "jerk-time")
        ),
        margin_rows=tuple((key, words.text(name)) for key, name in MARGINS.items()),
        fields=_fields(part, words, units),
        follows=part.loop.follows,
        data={
            "model": to_plain(part),
            "words": {
                # With its places left open.
                key.replace("-", "_"): words.own("what-if", key, **{k: f"{{{k}}}" for k in PLACES})
                for key in WORDS
            },
            "fields": [asdict(item) for item in _fields(part, words, units)],
            "units": units,
            "checks": {
                item.name: say_requirement(item.name, words) for item in part.requirements.checks
            },
            "filters": {key: item["entry"] for key, item in filters.items()},
            "known": known,
            "profile": shlex.quote(profile),
            "has_jerk": has_jerk,
        },
    )


def _filters(part: WhatIfPart, words: Catalogue) -> dict[str, Any]:
    """The filters to choose among: none, an average of any length, and those that are known."""
    found: dict[str, Any] = {"none": {"name": words.text("no-setpoint-filter"), "entry": None}}
    if part.averages:
        name = words.text("moving-average")
        found[MOVING_AVERAGE] = {"name": name, "entry": {"kind": MOVING_AVERAGE, "time": 0.0}}
    for item in part.limits:
        given = item.setpoint_filter
        key = _filter_key(given)
        if given is not None and key not in found:
            entry = {
                **to_plain(given),
                "name": say_filter(given, words),
                "typed": _typed(given) if given.kind != FIR else None,
            }
            found[key] = {"name": entry["name"], "entry": entry}
    return found


def _filter_key(item: SetpointFilter | None) -> str:
    if item is None:
        return "none"
    return item.kind if item.kind == MOVING_AVERAGE else _typed(item)


def _typed(item: SetpointFilter) -> str:
    """A filter as ``simulate --filter`` takes it."""
    if item.frequency_hz:
        return f"{item.kind}:{item.frequency_hz:.6g}Hz:{item.damping_ratio:.4g}"
    times = [f"{time:.6g}s" for time in (item.time, item.second_time) if time]
    return ":".join([item.kind, *times])


def _known(item: KnownLimitsEntry, filters: dict[str, Any]) -> dict[str, Any]:
    key = _filter_key(item.setpoint_filter)
    return {
        "limits": {"acceleration": item.acceleration, "jerk": item.jerk},
        "filter": key if key in filters else "none",
        "time": item.setpoint_filter.time if item.setpoint_filter else 0.0,
        "loop": to_plain(item.loop) | {"in_states": to_plain(item.states)} if item.loop else None,
    }


def _units(part: WhatIfPart, words: Catalogue) -> dict[str, dict[str, Any]]:
    f, best = words.format, part.limits[-1]
    band, force = part.requirements.tcp_deviation, part.requirements.motion_force
    sizes = {"m": 0.0, "m/s": 0.0}
    for move in part.moves:
        sizes[size_unit(move)] = max(sizes[size_unit(move)], size_of(move))
    scales = {
        "acceleration": f.scale(best.acceleration, _axis("m/s^2", words)),
        "jerk": f.scale(best.jerk, _axis("m/s^3", words)),
        "time": f.scale(1e-2, "s"),
        "deviation": f.scale(band, _axis("m", words)),
        "force": f.scale(force, part.plant.signals[0].unit),
        "distance": f.scale(sizes["m"], _axis("m", words)),
        "velocity": f.scale(sizes["m/s"], _axis("m/s", words)),
        "payload": f.scale(1.0, "kg m^2" if words.rotary else "kg"),
    }
    known = {
        _axis("m", words): scales["deviation"],
        "s": scales["time"],
        part.plant.signals[0].unit: scales["force"],
    }
    for item in part.requirements.checks:
        scales[item.name] = known.get(item.unit) or f.scale(item.limit, item.unit)
    return {key: {"size": scale.size, "unit": scale.unit} for key, scale in scales.items()}


def _axis(unit: str, words: Catalogue) -> str:
    return motion_unit(unit, rotary=words.rotary)


def _fields(
    part: WhatIfPart, words: Catalogue, units: dict[str, dict[str, Any]]
) -> tuple[Field, ...]:
    best, needs, plant = part.limits[-1], part.requirements, part.plant
    cycle = part.loop.cycles * part.loop.velocity_cycle
    mass = plant.moving_mass + min(corner.payload for corner in part.corners)
    fastest = max(
        1.1 * needs.motion_force / mass, *(1.1 * item.acceleration for item in part.limits)
    )
    payload = max(OTHER_PAYLOAD * plant.moving_mass, *(c.payload for c in part.corners))
    slowest = fastest / SMALLEST_SHARE
    jerks = [best.jerk, slowest / (LONGEST_RAMP * cycle) * SMALLEST_SHARE, fastest / cycle]

    def field(
        key: str,
        unit: str,
        low: float,
        high: float,
        value: float,
        *,
        log: bool = False,
        name: str = "",
    ) -> Field:
        scale = units[unit]
        return Field(
            key=key,
            label=words.own("what-if-field", name or key.replace("_", "-")),
            unit=scale["unit"],
            size=scale["size"],
            low=low,
            high=high,
            least=low / 100.0 if log else low,
            most=high * 10.0 if log else high,
            value=value,
            log=log,
        )

    found = [field("acceleration", "acceleration", slowest, fastest, best.acceleration, log=True)]
    if part.jerk != "none":
        found.append(field("jerk", "jerk", min(jerks), max(jerks), best.jerk, log=True))
    if part.averages:
        given = best.setpoint_filter
        longest = max(part.averages[1], 10.0 * cycle)
        time = given.time if given and given.kind == MOVING_AVERAGE else 0.25 * longest
        shortest = max(part.averages[0], 0.5 * cycle)
        found.append(field("time", "time", shortest, longest, time, name="filter-of-length"))
    # Ends and unit of the size follow the move that is chosen.
    found.append(field("size", "distance", 1e-3, 1.0, 1.0, log=True))
    if not part.loop.follows:
        found.append(field("payload", "payload", 0.0, payload, 0.0))
    percent = {"size": 0.01, "unit": "%"}
    units = {**units, "percent": percent, "Hz": {"size": 1.0, "unit": "Hz"}}
    units |= {"dB": {"size": 1.0, "unit": "dB"}, "number": {"size": 1.0, "unit": ""}}
    found.append(field("error", "percent", -LARGEST_ERROR, LARGEST_ERROR, 0.0))
    if part.loop.follows:
        return tuple(found)
    lowest = min((-plant.A[m.rate][m.deflection]) ** 0.5 for m in plant.modes) / (2.0 * pi)
    highest = 0.4 / part.loop.velocity_cycle
    found += [
        field("notch_frequency", "Hz", 0.2 * lowest, highest, lowest, log=True),
        field("notch_width", "number", NARROWEST, WIDEST, 0.5, log=True),
        field("notch_depth", "dB", 0.0, DEEPEST, 0.0),
    ]
    return tuple(found)


def print_answers(
    part: WhatIfPart, machine: MachineEntry, profile: Profile, *, created: str, language: str = "en"
) -> str:
    """Return the interactive page alone: other limits, moves and machines can be tried."""
    words = words_for(machine, language)
    page = document_of(
        words,
        machine,
        profile,
        title=words.text("what-if-heading"),
        created=created,
        sections=(),
    )
    return set_html(page, panel=what_if(part, words, profile=profile.name))
