"""What was identified -> a profile: a new, commented one, or one that exists with new modes."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, log
from pathlib import Path, PurePath
from typing import Any

import tomlkit

from mtcommission.base import __version__
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import LINEAR, ROTARY, AxisUnits
from mtcommission.identify.identified import Identified
from mtcommission.identify.states import FARTHEST, is_assumed, states_differ
from mtcommission.machine.identified import (
    LONGEST_FILE,
    MOST_FILES,
    Estimate,
    MeasuredMode,
    ShaperProposal,
)
from mtcommission.machine.plant.modal import MOST_MODES
from mtcommission.machine.profile.read import find_key_lines
from mtcommission.machine.readers import show_key
from mtcommission.record.identified import IdentifiedPart, evidence_checksum
from mtcommission.record.shape import to_plain

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
LONGEST_TIME = 1.0
"""Standard error of a delay that nothing determines [s]."""
TO_ASK = (
    "drive.max_force",
    "drive.force_lag",
    "moves[1].distance",
    "moves[1].max_velocity",
    "requirements.tcp_deviation",
)
"""What no response tells, and no profile can do without."""
OF_EXAMPLE = (
    *("drive.", "control.", "requirements.frequency_spread", "requirements.damping_spread"),
)
"""How keys begin with which an example describes a machine; moves and tolerances are a wish."""
HEADING = re.compile(r"\A(?:#.*\n)??#.*\n(?:#   .*SHA-256 [0-9a-f]{64}\n)+#.*\n")
"""What ``_heading`` wrote above a profile, of an earlier measurement."""
Stated = dict[str, tuple[Estimate, str, int]]
"""Estimates of a mode by their keys in a profile, with their unit there and digits."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Writing:
    """How a profile is written."""

    file: str  # Name of the profile, for hints
    words: Callable[[bool], Catalogue]  # Language of the comments, by whether the axis turns
    # Peak at the tool by peak at the motor, as the user says; None where nobody knows.
    tool_ratio: float | None = None
    evidence: str = ""  # Name of the file with its points, as seen from the profile; "" for none
    axis: str = "X"  # Letter


def name_from(profile: str, evidence: str) -> str:
    """Return the name of a file as a profile states it; "" where one of them is no file."""
    if {profile, evidence} & {"", "-"}:
        return ""
    place, folder = Path(evidence).resolve(), Path(profile).resolve().parent
    return place.name if place.parent == folder else str(place)


def evidence_file(profile: str) -> str:
    """Return the name of the file with points and advice that belongs beside a profile."""
    return str(PurePath(profile).with_suffix(".identified.json"))


def write_profile(found: Identified, how: Writing) -> Identified:
    """Return what was found with a new profile: what is known, the rest as open questions."""
    part = found.part
    words = how.words(part.rotary)
    text = words.text
    document: Any = tomlkit.document()
    document["schema"] = 1
    machine = {
        "name": text("identify-document-name"),
        "axis": how.axis,
        "source": _source(found, how),
    }
    document["machine"] = machine | ({"motion": "rotary"} if part.rotary else {})
    document["plant"] = {"kind": "modal"}
    if part.base_excited:
        document["drive"] = tomlkit.table()
        _set(document["drive"], "kind", "position_source", text("identify-document-held"))
    assumed = []
    for table, key, value in PRINTER if part.proposals else ():
        many = table == "moves"
        if table not in document:
            document[table] = tomlkit.aot() if many else tomlkit.table()
            if many:
                document[table].append(tomlkit.table())
        own = f"identify-document-printer-{key.replace('_', '-')}"
        note = words.known(own, text("identify-document-printer"))
        _set(document[table][0] if many else document[table], key, value, note)
        assumed.append(f"{table}[1].{key}" if many else f"{table}.{key}")
    document.setdefault("requirements", tomlkit.table())
    if part.proposals:
        document["control"] = {"kind": "klipper"}
    _merge(document, found, how, assumed)
    # A blank line before each table, however tomlkit joins them.
    whole = re.sub(r"^(.+)\n(?=\[)", r"\1\n\n", tomlkit.dumps(document), flags=re.MULTILINE)
    for header, kind in (("[machine_states]", "states"), ("identified", "measured")):
        comment = f"# {text(f'identify-document-{kind}')}\n[{header}]\n"
        whole = whole.replace(f"\n[{header}]\n", f"\n{comment}", 1)
    asked = ["drive.max_acceleration", *TO_ASK[2:]]
    if not part.base_excited:
        unknown = [] if part.moving_mass else ["plant.moving_mass", "plant.modes[1].tcp_gain"]
        asked = [*unknown, *TO_ASK]
    if not part.proposals:
        question = text("identify-document-open", file=how.file)
        whole += "\n".join(["", f"# {question}", *(f"#   {key}" for key in asked), ""])
    return replace(found, profile=f"{_heading(found, how)}\n{whole}")


def _source(found: Identified, how: Writing) -> str:
    files = ", ".join(dict.fromkeys(name.rpartition("/")[2] for name in found.files))
    shown = files if len(files) <= 300 else f"{files[:297]}..."
    words, date = how.words(found.part.rotary), found.part.created[:10]
    return words.text("identify-document-source", files=shown, date=date)


def merge_profile(text: str, found: Identified, how: Writing) -> Identified:
    """Return what was found with its profile: one that exists, and in it what was measured.

    A mode that is near a measured one keeps its name; one outside the measured band stays, one
    within it that does not show goes. What is stated of a measured mode and no sensor showed stays
    as an assumption; what was one already is chosen anew. The numbers of an example are no
    knowledge of the machine: where its mass and modes were measured it is an example no more, its
    other modes and shares at the tool go, and what it says of drive and control is an assumption.
    """
    document: Any = tomlkit.parse(HEADING.sub("", text))
    machine = document.setdefault("machine", tomlkit.table())
    follows = document.get("drive", {}).get("kind") == "position_source"
    if found.part.base_excited and not follows:
        # Shares of a held motor's modes are none of those with the motor free.
        modes = [replace(one, tcp_gain=None) for one in found.part.modes]
        found = replace(found, part=replace(found.part, modes=modes))
    kind = document.get("plant", {}).get("kind", "modal")
    if kind != "modal":
        found = _warned(found, Message("identify-kind-replaced", kind=str(kind)))
    if "plant" not in document or kind != "modal":
        document["plant"] = tomlkit.table()
        document["plant"]["kind"] = "modal"
    gone = ("plant.",) if kind != "modal" else ()
    assumed = [key for key in map(str, machine.get("assumed", [])) if not key.startswith(gone)]
    before = document.get("identified", {}).get("files", [])
    if any(Path(str(one["name"])).name in str(machine.get("source")) for one in before):
        machine["source"] = _source(found, how)
    if machine.get("illustrative") and found.part.modes and (found.part.moving_mass or follows):
        del machine["illustrative"]
        machine["source"] = _source(found, how)
        low, high = found.part.band_hz or (0.0, inf)
        modes = document["plant"].get("modes", [])
        for place in reversed(range(len(modes))):
            modes[place].pop("tcp_gain", None)
            if not low <= _frequency(modes[place]) <= high:
                del modes[place]
        stated = map(show_key, find_key_lines(tomlkit.dumps(document)))
        examples = [key for key in stated if key.startswith(OF_EXAMPLE)]
        others = (key for key in assumed if not key.startswith(("plant.modes", *examples)))
        assumed = [*others, *examples]
    states = tuple(str(one["name"]) for one in document.get("machine_states", []))
    if states and not states_differ(found.part.states, found.part.modes):
        found = _warned(found, Message("identify-states-stay", states=states))
    found = _merge(document, found, how, assumed)
    if left_out := _drop_states(document):
        found = _warned(found, Message("identify-states-gone", keys=left_out))
    merged = how.words(found.part.rotary).text("identify-document-merged")
    return replace(found, profile=_heading(found, how, merged) + tomlkit.dumps(document))


def _drop_states(document: Any) -> tuple[str, ...]:
    """Take out weights and bounds of states that the plant has no more, and return which."""
    modes = [str(mode["name"]) for mode in document["plant"].get("modes", [])]
    known = {"x", "v", "F", "tcp", "encoder", "tcp_vibration"}
    known |= {f"{sign}_{name}" for sign in ("q", "v") for name in modes}
    gone: list[str] = []
    for table, key in (("damping_optimal", "weights"), ("requirements", "peaks")):
        own = document.get(table, {}).get(key)
        strange = [one for one in own if one not in known] if isinstance(own, Mapping) else []
        gone += [f"{table}.{key}.{name}" for name in strange]
        # Weights tell only together what is worth how much.
        if strange and (key == "weights" or len(strange) == len(own)):
            del document[table][key]
        else:
            for name in strange:
                del own[name]
    return tuple(gone)


def _warned(found: Identified, warning: Message) -> Identified:
    part = found.part
    return replace(found, part=replace(part, warnings=[*part.warnings, warning]))


def _merge(document: Any, found: Identified, how: Writing, assumed: Sequence[str]) -> Identified:
    """Put what was measured into a profile; ``assumed``: its other keys that are assumptions."""
    unit = _units(found.part)
    if found.part.moving_mass:
        _set_estimate(document["plant"], "moving_mass", found.part.moving_mass, unit.mass.si, 6)
    names: dict[str, str] = {}
    gains = _merge_modes(document["plant"], found.part, how, names, assumed)
    if stay := tuple(f"{key} = {value}" for key, value in gains.items() if value):
        found = _warned(found, Message("identify-gains-stay", gains=stay))
    of_plant = ("plant.modes", *(["plant.moving_mass"] if found.part.moving_mass else []))
    part, keys = found.part, [*(one for one in assumed if not one.startswith(of_plant)), *gains]
    if states_differ(part.states, part.modes):
        document["machine_states"] = _state_tables(part, names)
    document["identified"] = _statement(part, how.evidence, names)
    requirements = document.setdefault("requirements", tomlkit.table())
    for kind, why in zip(("frequency", "damping"), part.spread.because, strict=True):
        key, spread = f"{kind}_spread", getattr(part.spread, kind)
        stated = str(requirements.get(key, 0.0)).strip()
        share = float(stated.removesuffix("%")) / (100.0 if stated.endswith("%") else 1.0)
        # Who stated a wider one knows more states of the machine than were measured.
        if share < spread:
            _set(requirements, key, f"{100 * spread:.4g} %", how.words(part.rotary).say(why))
            keys = [one for one in keys if one != f"requirements.{key}"]
            keys += [f"requirements.{key}"] if is_assumed(why, len(part.states)) else []
    machine = document.setdefault("machine", tomlkit.table())
    machine.pop("assumed", None)
    if keys:
        machine["assumed"] = keys
    return found


def _merge_modes(
    plant: Any,
    part: IdentifiedPart,
    how: Writing,
    names: dict[str, str],
    before: Sequence[str],
) -> dict[str, str]:
    """Put the measured modes among those of a profile; return the keys that are assumptions.

    With each what the profile stated already; "" where it is chosen here. ``before``: keys that
    were assumptions.
    """
    tables = {f"plant.modes[{n}]": one for n, one in enumerate(plant.get("modes", []), start=1)}
    free = {key: table for key, table in tables.items() if _frequency(table)}
    taken = {str(table.get("name")) for table in tables.values()}
    merged: list[Any] = []
    assumed: dict[str, str] = {}
    for mode in _kept(part):
        f = mode.frequency_hz.value
        near = min(free, key=lambda key: abs(log(_frequency(free[key]) / f)), default=None)
        if near is not None and abs(log(_frequency(free[near]) / f)) < FARTHEST:
            table = free.pop(near)
            if f"{near}.tcp_gain" in before:
                del table["tcp_gain"]
        else:
            table = tomlkit.table()
            name = mode.name
            while name in taken:
                name += "_measured"
            table["name"] = name
        stated = {key: str(table[key]) for key in ("tcp_gain", "measured_gain") if key in table}
        for key in _set_mode(table, mode, part, how):
            value = str(table[key])
            kept = value if stated.get(key) == value else ""
            assumed[f"plant.modes[{len(merged) + 1}].{key}"] = kept
        names[mode.name] = str(table["name"])
        merged.append(table)
    low, high = part.band_hz or (0.0, 0.0)
    for key, table in free.items():
        if len(merged) < MOST_MODES and not low <= _frequency(table) <= high:
            merged.append(table)
            own = (one for one in before if one.startswith(f"{key}."))
            assumed |= {one.replace(key, f"plant.modes[{len(merged)}]"): "" for one in own}
    plant.pop("modes", None)
    if merged:
        plant["modes"] = tomlkit.aot()
    for table in merged:
        plant["modes"].append(table)
    return assumed


def _frequency(table: Any) -> float:
    """Of a mode in a profile [Hz]; 0 where it cannot be read."""
    try:
        return float(str(table.get("frequency")).split()[0])
    except (ValueError, IndexError):
        return 0.0


def _kept(part: IdentifiedPart) -> list[MeasuredMode]:
    """As many modes as a profile holds, those with the largest gains by frequency."""

    def size(mode: MeasuredMode) -> float:
        gains = [abs(gain.value) for gain in (mode.measured_gain, mode.tcp_gain) if gain]
        return max(gains, default=0.0) / mode.frequency_hz.value**2

    largest = sorted(part.modes, key=size, reverse=True)[:MOST_MODES]
    return [mode for mode in part.modes if mode in largest]


def _stated(mode: MeasuredMode, part: IdentifiedPart, *gains: str) -> Stated:
    """What can be stated of a mode: shares only by a known mass, or of a held motor."""
    unit = "" if part.base_excited else _units(part).gain.si
    found = {
        "frequency": (mode.frequency_hz, "Hz", 6),
        "damping_ratio": (mode.damping_ratio, "", 4),
    }
    for key in gains if part.moving_mass or part.base_excited else ():
        if gain := getattr(mode, key):
            found[key] = (gain, unit, 5 if unit else 4)
    return found


def _in_plant(mode: MeasuredMode, part: IdentifiedPart) -> Stated:
    """The same as [plant] states it.

    Of a held motor's modes a single one is the whole tool on its spring: 1, which profiles take
    unless told.
    """
    if part.base_excited:
        return _stated(mode, part, *(["tcp_gain"] if len(part.modes) > 1 else []))
    return _stated(mode, part, "tcp_gain", "measured_gain")


def _set_mode(table: Any, mode: MeasuredMode, part: IdentifiedPart, how: Writing) -> list[str]:
    """Write a measured mode; return which of its gains no sensor showed.

    At the tool it is by the user's word, as before, or the worst case; left out: to be asked.
    """
    words, mass, own = how.words(part.rotary), part.moving_mass, mode.measured_gain
    stated = _in_plant(mode, part)
    has_none = mass and not part.base_excited and "tcp_gain" not in stated
    by_ratio = has_none and how.tool_ratio is not None and own and own.value
    is_worst = has_none and not by_ratio and "tcp_gain" not in table
    shown, last = set(stated), stated.pop("measured_gain", None)
    for key, (one, unit, digits) in stated.items():
        _set_estimate(table, key, one, unit, digits)
    gain, share = _units(part).gain.si, own.value if own else 0.0
    if by_ratio and how.tool_ratio is not None:
        note = words.text("identify-document-tool-ratio", ratio=how.tool_ratio)
        _set(table, "tcp_gain", f"{how.tool_ratio * share:.5g} {gain}", note)
    elif is_worst and mass:
        worst = max(abs(share), 1.0 / mass.value)
        note = words.text("identify-document-tool-worst")
        _set(table, "tcp_gain", f"{-worst if share >= 0.0 else worst:.5g} {gain}", note)
    if last:
        _set_estimate(table, "measured_gain", *last)
    return [key for key in ("tcp_gain", "measured_gain") if key in table and key not in shown]


def _state_tables(part: IdentifiedPart, names: Mapping[str, str]) -> Any:
    tables, taken = tomlkit.aot(), set[str]()
    kept = [mode.name for mode in _kept(part)]
    for place, state in enumerate(part.states, start=1):
        name = _printable(re.sub(r"[^,\s]*/", "", state.name))[-MOST_LETTERS:]
        name = f"{name} ({place})" if name in taken else name
        taken.add(name)
        table: Any = tomlkit.table()
        table["name"] = name
        if part.moving_mass and state.moving_mass:
            table["moving_mass"] = _written(state.moving_mass.value, _units(part).mass.si, 6)
        table["modes"] = tomlkit.aot()
        for seen in (mode for mode in state.modes if mode.name in kept):
            own: Any = tomlkit.table()
            own["name"] = names.get(seen.name, seen.name)
            for key, (one, unit, digits) in _in_plant(seen, part).items():
                own[key] = _written(one.value, unit, digits)
            table["modes"].append(own)
        tables.append(table)
    return tables


def _statement(part: IdentifiedPart, evidence: str, names: Mapping[str, str]) -> Any:
    """[identified]: what was measured, for the sheet, and the file with the points."""
    table: Any = tomlkit.table()
    table["date"] = part.created[:10]
    if part.band_hz:
        table["band"] = [f"{f:.6g} Hz" for f in part.band_hz]
    if part.misfit is not None:
        table["misfit"] = float(f"{part.misfit:.3g}")
    if part.moving_mass:
        table["moving_mass"] = _pair(part.moving_mass, _units(part).mass.si)
    for key, one in (("delay", part.delay), ("lag", part.lag)):
        if one:
            table[key] = _pair(one, "s", most=LONGEST_TIME)
    if evidence:
        table["evidence"] = evidence
        table["checksum"] = evidence_checksum(to_plain(part))
    modes = [
        {"name": names.get(mode.name, mode.name)}
        | {
            key: _pair(one, unit)
            for key, (one, unit, _) in _stated(mode, part, "measured_gain", "tcp_gain").items()
        }
        for mode in part.modes[: 4 * MOST_MODES]
    ]
    files = [
        {"name": _printable(one.name)[-LONGEST_FILE:], "sensor": one.sensor, "sha256": one.sha256}
        for one in part.sources[:MOST_FILES]
    ]
    proposals = [_proposal(one) for one in part.proposals]
    rows: dict[str, list[Any]] = {"calibrate_shaper": proposals, "files": files, "modes": modes}
    for key, items in rows.items():
        if items:
            table[key] = tomlkit.aot()
        for row in items:
            table[key].append(tomlkit.item(row))
    return table


def _proposal(one: ShaperProposal) -> dict[str, str | float | bool]:
    return {
        "shaper": one.shaper,
        "frequency": f"{one.frequency_hz:.6g} Hz",
        "vibration": float(f"{one.vibration:.3g}"),
        "smoothing": f"{1e3 * one.smoothing:.3g} mm",
        "max_acceleration": f"{one.max_acceleration:.6g} m/s^2",
        "recommended": one.is_recommended,
    }


def _printable(text: str) -> str:
    return "".join(letter for letter in text if letter.isprintable())


def _written(value: float, unit: str, digits: int) -> str | float:
    return f"{value:.{digits}g} {unit}" if unit else float(f"{value:.{digits}g}")


def _pair(one: Estimate, unit: str, *, most: float | None = None) -> list[Any]:
    """Value and standard error; one larger than the value says that nothing determines it."""
    sigma = min(one.sigma, abs(one.value) if most is None else most)
    return [_written(one.value, unit, 6), _written(sigma, unit, 3)]


def _heading(found: Identified, how: Writing, more: str = "") -> str:
    """Comments above a profile: who wrote it, from which files, and why with --force."""
    part = found.part
    words = how.words(part.rotary)
    text, lines = words.text, []
    if found.doubt:
        forced = text("identify-forced", **found.doubt.values)
        lines.append(f"{forced} {words.say(found.doubt)}")
    head = text("identify-document-head", version=__version__, date=part.created[:10])
    lines.append(f"{head} {more}".rstrip())
    for file, source in found.files.items():
        dated = {"date": source.measured_on} if source.measured_on else {}
        kind = "identify-document-file-dated" if dated else "identify-document-file"
        lines.append("  " + text(kind, file=file, hash=source.sha256, **dated))
    lines.append(text("identify-document-sigma"))
    if (left := len(part.modes) - MOST_MODES) > 0:
        lines.append(text("identify-document-too-many", most=MOST_MODES, left=left))
    return "".join(f"# {' '.join(line.splitlines())}\n" for line in lines)


def _units(part: IdentifiedPart) -> AxisUnits:
    return ROTARY if part.rotary else LINEAR


def _set_estimate(table: Any, key: str, one: Estimate, unit: str, digits: int) -> None:
    comment = f"± {2.0 * one.sigma:.2g} {unit}".rstrip()
    _set(table, key, _written(one.value, unit, digits), comment)


def _set(table: Any, key: str, value: str | float, comment: str) -> None:
    item = tomlkit.item(value)
    line = f"{key} = {item.as_string()}"
    item.comment(comment)
    item.trivia.comment_ws = " " * max(COLUMN - 1 - len(line), 0) + " "
    table[key] = item
