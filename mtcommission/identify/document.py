"""What was identified -> a profile: a new, commented one, or one that exists with new modes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log
from types import MappingProxyType
from typing import Any

import tomlkit
from tomlkit.items import AoT, Table

from mtcommission.identify.identified import Identified, IdentifiedMode
from mtcommission.identify.matching import FARTHEST
from mtcommission.identify.statement import statement
from mtcommission.machine.identified import Estimate
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.plant.modal import MOST_MODES
from mtcommission.record.identified import IdentifiedPart
from mtcommission.units.axis_units import LINEAR, ROTARY, AxisUnits
from mtcommission.version import __version__

COLUMN = 34
"""Where comments begin, if the line leaves room."""
PRINTER = (
    ("drive", "max_acceleration", "10 m/s^2"),
    ("moves", "distance", "20 mm"),
    ("moves", "max_velocity", "200 mm/s"),
    ("requirements", "tcp_deviation", "20 um"),
)
"""What a printer's resonance test does not tell, as assumed: the test itself drives the motor at
60 mm/s^2 per Hz up to 135 Hz (klippy/extras/resonance_tester.py at 84104bbb), 8 m/s^2, older ones
at 75 up to 133 Hz, 10 m/s^2; a short infill line; a ringing that can hardly be seen."""
MOST_LETTERS = 70
"""Of the name of a state."""
TO_ASK = (
    "drive.max_force",
    "drive.force_lag",
    "moves[1].distance",
    "moves[1].max_velocity",
    "requirements.tcp_deviation",
)
"""What no response tells, and no profile can do without."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Writing:
    """How a profile is written."""

    date: str  # ISO 8601, day
    file: str  # Name of the profile, for hints
    # Peak at the tool by peak at the motor, as the user says; None where nobody knows.
    tool_ratio: float | None
    words: Catalogue  # Language of the comments
    part: IdentifiedPart  # What was measured, as the sheet prints it
    evidence: str = ""  # Name of the file with its points, as seen from the profile; "" for none
    axis: str = "X"  # Letter


@dataclass(frozen=True, slots=True)
class _Row:
    """One key of a profile: value as TOML has it, comment, whether it is an assumption."""

    key: str
    value: str | float
    comment: str
    is_assumed: bool = False


def write_profile(found: Identified, how: Writing) -> str:
    """Return a new profile: what is known with its intervals, the rest as open questions."""
    words, unit = how.words, _units(found)
    modes = [_mode_rows(mode, found, how) for mode in _kept(found)]
    assumed = [
        f"plant.modes[{number}].{row.key}"
        for number, rows in enumerate(modes, start=1)
        for row in rows
        if row.is_assumed
    ]
    printer = _printer_rows(words) if how.part.proposals else {}
    assumed += [
        f"{'moves[1]' if table == 'moves' else table}.{row.key}"
        for table, rows in printer.items()
        for row in rows
    ]
    lines = [f"# {line}" for line in _heading(found, how)]
    lines += ["", "schema = 1", "", "[machine]"]
    lines += [
        _line(_Row("name", words.text("identify-document-name"), "")),
        _line(_Row("axis", how.axis, "")),
        _line(_Row("source", _source(found, how), "")),
    ]
    if found.rotary:
        lines.append(_line(_Row("motion", "rotary", "")))
    if assumed:
        lines.append(f"assumed = {tomlkit.item(assumed).as_string()}")
    lines += ["", "[plant]", 'kind = "modal"']
    mass = _mass_row(found, unit)
    if mass:
        lines.append(_line(mass))
    for rows in modes:
        lines += ["", "[[plant.modes]]", *map(_line, rows)]
    if found.is_base_excited:
        held = _Row("kind", "position_source", words.text("identify-document-held"))
        lines += ["", "[drive]", _line(held), *map(_line, printer.get("drive", ()))]
    if printer:
        lines += ["", "[[moves]]", *map(_line, printer["moves"])]
    stated_rows = [*printer.get("requirements", ()), *_spread_rows(found, how)]
    lines += ["", "[requirements]", *map(_line, stated_rows)]
    if printer:
        lines += ["", "[control]", _line(_Row("kind", "klipper", ""))]
    stated = tomlkit.document()
    if states := _state_tables(found):
        lines += ["", f"# {words.text('identify-document-states')}"]
        stated["machine_states"] = states
        lines += [tomlkit.dumps(stated).rstrip()]
        del stated["machine_states"]
    stated["identified"] = statement(how.part, evidence=how.evidence)
    lines += ["", f"# {words.text('identify-document-measured')}"]
    lines += tomlkit.dumps(stated).rstrip().splitlines()
    asked = [] if printer else _to_ask(found)
    if asked:
        lines += ["", f"# {words.text('identify-document-open', file=how.file)}"]
        lines += [f"#   {key}" for key in asked]
    return "\n".join(lines) + "\n"


def _to_ask(found: Identified) -> list[str]:
    if found.is_base_excited:
        return ["drive.max_acceleration", *TO_ASK[2:]]
    unknown = [] if found.moving_mass else ["plant.moving_mass", "plant.modes[1].tcp_gain"]
    return [*unknown, *TO_ASK]


def _printer_rows(words: Catalogue) -> dict[str, list[_Row]]:
    """What a printer's resonance test leaves open, by table; each an assumption."""
    tables: dict[str, list[_Row]] = {}
    for table, key, value in PRINTER:
        note = words.text(f"identify-document-printer-{key.replace('_', '-')}")
        tables.setdefault(table, []).append(_Row(key, value, note, is_assumed=True))
    return tables


def kind_replaced(text: str) -> list[Message]:
    """Return that measured modes take the place of another kind of plant, if they do."""
    kind = tomlkit.parse(text).get("plant", {}).get("kind", "modal")
    return [] if kind == "modal" else [Message("identify-kind-replaced", kind=str(kind))]


def merge_profile(text: str, found: Identified, how: Writing) -> str:
    """Return a profile with measured modes, mass and spreads; all other lines stay.

    A mode that is near a measured one keeps its name, and its share at the tool where none was
    measured; one outside the measured band stays, one within it that does not show goes.
    """
    document = tomlkit.parse(text)
    if document.get("drive", {}).get("kind") != "position_source" and found.is_base_excited:
        # Shares of a held motor's modes are none of those with the motor free.
        found = replace(found, modes=tuple(replace(one, tcp_gain=None) for one in found.modes))
    plant = document.get("plant")
    if not isinstance(plant, Table) or plant.get("kind") != "modal":
        plant = tomlkit.table()
        plant["kind"] = "modal"
        document["plant"] = plant
    if mass := _mass_row(found, _units(found)):
        _set(plant, mass)
    names: dict[str, str] = {}
    assumed = _merge_modes(plant, found, how, names)
    document["identified"] = statement(how.part, evidence=how.evidence, names=names)
    if states := _state_tables(found, names):
        document["machine_states"] = states
    requirements = document.setdefault("requirements", tomlkit.table())
    for row in _spread_rows(found, how):
        # Who stated a wider one knows more states of the machine than were measured.
        if _share(requirements.get(row.key, 0.0)) < _share(row.value):
            _set(requirements, row)
    machine = document.setdefault("machine", tomlkit.table())
    measured = ("plant.moving_mass", "plant.modes", "requirements.frequency_spread")
    kept = [key for key in machine.get("assumed", []) if not str(key).startswith(measured)]
    if [*kept, *assumed]:
        machine["assumed"] = [*kept, *assumed]
    elif "assumed" in machine:
        del machine["assumed"]
    head = tomlkit.document()
    for line in _heading(found, how):
        head.add(tomlkit.comment(line))
    return tomlkit.dumps(head) + tomlkit.dumps(document)


def _share(value: object) -> float:
    """A share as profiles state it, a number or per cent [-]."""
    text = str(value).strip()
    return float(text.removesuffix("%")) / 100.0 if text.endswith("%") else float(text)


def _merge_modes(
    plant: Any, found: Identified, how: Writing, names_of: dict[str, str]
) -> list[str]:
    """Put the measured modes among those of a profile; return the keys that are assumptions."""
    old = plant.get("modes")
    tables = list(old) if isinstance(old, AoT) else []
    free = [table for table in tables if _frequency(table) is not None]
    merged: list[Any] = []
    assumed: list[str] = []
    names = {str(table.get("name")) for table in tables}
    for mode in _kept(found):
        near = min(free, key=lambda table: _distance(table, mode), default=None)
        if near is not None and _distance(near, mode) < FARTHEST:
            free.remove(near)
            table = near
        else:
            table = tomlkit.table()
        for row in _mode_rows(mode, found, how, names=names, before=table):
            _set(table, row)
            if row.is_assumed:
                assumed.append(f"plant.modes[{len(merged) + 1}].{row.key}")
        names_of[mode.name] = str(table["name"])
        merged.append(table)
    low, high = _band(found)
    merged += [table for table in free if not low <= (_frequency(table) or 0.0) <= high]
    modes = tomlkit.aot()
    for table in merged[:MOST_MODES]:
        modes.append(table)
    plant["modes"] = modes
    return assumed


def _band(found: Identified) -> tuple[float, float]:
    bands = [fit.band_hz for fit in found.fits]
    return min((b[0] for b in bands), default=0.0), max((b[1] for b in bands), default=0.0)


def _frequency(table: Any) -> float | None:
    """Of a mode in a profile [Hz]; None where it cannot be read."""
    value = table.get("frequency")
    try:
        return float(str(value).split()[0])
    except (ValueError, IndexError):
        return None


def _distance(table: Any, mode: IdentifiedMode) -> float:
    frequency = _frequency(table)
    return abs(log(frequency / mode.frequency_hz.value)) if frequency else FARTHEST


def _set(table: Any, row: _Row) -> None:
    item = tomlkit.item(row.value)
    if row.comment:
        item.comment(row.comment)
    table[row.key] = item


def _kept(found: Identified) -> tuple[IdentifiedMode, ...]:
    """As many modes as a profile holds, those with the largest gains by frequency."""

    def size(mode: IdentifiedMode) -> float:
        gains = [gain.value for gain in (mode.measured_gain, mode.tcp_gain) if gain]
        return max(map(abs, gains), default=0.0) / mode.frequency_hz.value**2

    largest = sorted(found.modes, key=size, reverse=True)[:MOST_MODES]
    return tuple(mode for mode in found.modes if mode in largest)


def _mode_rows(
    mode: IdentifiedMode,
    found: Identified,
    how: Writing,
    *,
    names: Sequence[str] | set[str] = (),
    before: Any = None,
) -> list[_Row]:
    old: Any = before if before is not None else {}
    gain = _units(found).gain.si
    name = str(old.get("name") or mode.name)
    if not old:
        while name in names:
            name += "_measured"
    rows = [
        *([] if old.get("name") else [_Row("name", name, "")]),
        _Row(
            "frequency", f"{mode.frequency_hz.value:.6g} Hz", _plus_minus(mode.frequency_hz, "Hz")
        ),
        _Row(
            "damping_ratio",
            float(f"{mode.damping_ratio.value:.4g}"),
            _plus_minus(mode.damping_ratio, ""),
        ),
    ]
    if tool := _tool_row(mode, found, how, has_old="tcp_gain" in old):
        rows.append(tool)
    if mode.measured_gain is not None and found.moving_mass is not None:
        value = f"{mode.measured_gain.value:.5g} {gain}"
        rows.append(_Row("measured_gain", value, _plus_minus(mode.measured_gain, gain)))
    return rows


def _tool_row(
    mode: IdentifiedMode, found: Identified, how: Writing, *, has_old: bool
) -> _Row | None:
    """tcp_gain: measured, by the user's word, as before, or the worst case; None: to be asked."""
    gain, words = _units(found).gain.si, how.words
    if found.is_base_excited:
        # A single one is the whole tool on its spring: 1, which profiles take unless told.
        if mode.tcp_gain is None or len(found.modes) == 1:
            return None
        share = float(f"{mode.tcp_gain.value:.4g}")
        return _Row("tcp_gain", share, _plus_minus(mode.tcp_gain, ""))
    if found.moving_mass is None:
        return None
    if mode.tcp_gain is not None:
        value = f"{mode.tcp_gain.value:.5g} {gain}"
        return _Row("tcp_gain", value, _plus_minus(mode.tcp_gain, gain))
    own = mode.measured_gain.value if mode.measured_gain else 0.0
    if how.tool_ratio is not None and own:
        note = words.text("identify-document-tool-ratio", ratio=how.tool_ratio)
        return _Row("tcp_gain", f"{how.tool_ratio * own:.5g} {gain}", note, is_assumed=True)
    if has_old:
        return None
    worst = max(abs(own), 1.0 / found.moving_mass.value)
    value = f"{-worst if own >= 0.0 else worst:.5g} {gain}"
    return _Row("tcp_gain", value, words.text("identify-document-tool-worst"), is_assumed=True)


def _state_tables(found: Identified, names: Mapping[str, str] = MappingProxyType({})) -> AoT | None:
    """[[machine_states]]: what each state has of its own; None where one description does."""
    if not found.spread.apart:
        return None
    tables, unit, taken = tomlkit.aot(), _units(found), set[str]()
    for place, state in enumerate(found.states):
        without_folders = re.sub(r"[^,\s]*/", "", state.name)
        name = "".join(letter for letter in without_folders if letter.isprintable())[-MOST_LETTERS:]
        name = f"{name} ({place + 1})" if name in taken else name
        taken.add(name)
        table = tomlkit.table()
        table["name"] = name
        if found.moving_mass and state.moving_mass:
            table["moving_mass"] = f"{state.moving_mass.value:.6g} {unit.mass.si}"
        modes = tomlkit.aot()
        for mode in _kept(found):
            own = mode.seen[place]
            if own is None:
                continue
            seen = state.modes[own]
            inner = tomlkit.table()
            inner["name"] = names.get(mode.name, mode.name)
            inner["frequency"] = f"{seen.frequency_hz.value:.6g} Hz"
            inner["damping_ratio"] = float(f"{seen.damping_ratio.value:.4g}")
            if found.is_base_excited:
                if seen.tcp_gain is not None and len(found.modes) > 1:
                    inner["tcp_gain"] = float(f"{seen.tcp_gain.value:.4g}")
            elif found.moving_mass:
                for key, gain in (
                    ("tcp_gain", seen.tcp_gain),
                    ("measured_gain", seen.measured_gain),
                ):
                    if gain is not None:
                        inner[key] = f"{gain.value:.5g} {unit.gain.si}"
            modes.append(inner)
        table["modes"] = modes
        tables.append(table)
    return tables


def _mass_row(found: Identified, unit: AxisUnits) -> _Row | None:
    mass = found.moving_mass
    if mass is None:
        return None
    return _Row("moving_mass", f"{mass.value:.6g} {unit.mass.si}", _plus_minus(mass, unit.mass.si))


def _spread_rows(found: Identified, how: Writing) -> list[_Row]:
    spread, say = found.spread, how.words.say
    return [
        _Row("frequency_spread", f"{100 * spread.frequency:.4g} %", say(spread.because[0])),
        _Row("damping_spread", f"{100 * spread.damping:.4g} %", say(spread.because[1])),
    ]


def _heading(found: Identified, how: Writing) -> list[str]:
    words = how.words
    lines = []
    if found.doubt:
        forced = words.text("identify-forced", **found.doubt.values)
        lines.append(f"{forced} {words.say(found.doubt)}")
    lines.append(words.text("identify-document-head", version=__version__, date=how.date))
    for source in {one.source.file: one.source for one in found.measurements}.values():
        dated = {"date": source.measured_on} if source.measured_on else {}
        kind = "identify-document-file-dated" if dated else "identify-document-file"
        lines.append("  " + words.text(kind, file=source.file, hash=source.sha256, **dated))
    lines.append(words.text("identify-document-sigma"))
    if len(found.modes) > MOST_MODES:
        left = len(found.modes) - MOST_MODES
        lines.append(words.text("identify-document-too-many", most=MOST_MODES, left=left))
    return [" ".join(line.split("\n")) for line in lines]


def _source(found: Identified, how: Writing) -> str:
    files = ", ".join(
        dict.fromkeys(one.source.file.rpartition("/")[2] for one in found.measurements)
    )
    shown = files if len(files) <= 300 else f"{files[:297]}..."
    return how.words.text("identify-document-source", files=shown, date=how.date)


def _units(found: Identified) -> AxisUnits:
    return ROTARY if found.rotary else LINEAR


def _plus_minus(one: Estimate, unit: str) -> str:
    return f"± {2.0 * one.sigma:.2g} {unit}".rstrip()


def _line(row: _Row) -> str:
    line = f"{row.key} = {tomlkit.item(row.value).as_string()}"
    return f"{line:<{COLUMN - 1}} # {row.comment}" if row.comment else line
