"""Answers <-> profile: what was typed becomes the profile's keys, and back."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from math import pi, sqrt

from mtcommission.base.errors import Refused
from mtcommission.base.units.quantities import (
    FREQUENCY,
    LINEAR,
    RATIO,
    ROTARY,
    AxisUnits,
    Dimension,
    parse_quantity,
)
from mtcommission.machine.mechanics import KINDS, SOURCE
from mtcommission.machine.profile.describe import KeyQuestion, questions
from mtcommission.machine.profile.read import read_key
from mtcommission.machine.readers import read_path, show_key

Answers = Mapping[str, str]
"""What was typed, by dotted key: the profile's own keys, or the wizard's beside them; "": left
out."""

Data = dict[str, object]
"""Nested tables as TOML has them; all values are texts but the schema's number."""

TOWER = "tower: masses and stiffness"
PAIR_BY_STIFFNESS = "motor and load: masses and stiffness"
PAIR_BY_FREQUENCY = "motor and load: masses and measured eigenfrequency"
MODAL = "modes from a Bode plot"
PAIRS = (PAIR_BY_FREQUENCY, PAIR_BY_STIFFNESS)
"""Ways into the mechanics; the wizard converts all to one of the profile's kinds of plant."""

KIND_OF_WAY = {
    MODAL: "modal",
    TOWER: "manipulator",
    **dict.fromkeys(PAIRS, "modal"),
}
"""Of other ways, the kind is the way."""

ACCEPTED = "wizard.accepted"
"""Key under which those keys stand, with blanks between, whose values a profile calls assumed."""

OWN = ("wizard.", "pair.")
"""Beginnings of the keys that only the wizard knows."""

SERVO = "servo"
"""Kind of drive that a profile means without the key."""

SECTIONS = ("machine", "plant", "drive", "moves", "requirements", "control", "today")


def is_rotary(answers: Answers) -> bool:
    """Return whether the answers describe a rotary axis."""
    return answers.get("machine.motion") == "rotary"


def follows(answers: Answers) -> bool:
    """Return whether they describe an open-loop axis."""
    return answers.get("drive.kind") == SOURCE


def axis_units(answers: Answers) -> AxisUnits:
    """Return what is measured on the axis that the answers describe."""
    return ROTARY if is_rotary(answers) else LINEAR


def si_value(answers: Answers, key: str, dimension: Dimension) -> float | None:
    """Return an answer as SI number; None while it is not known, or wrong in a file."""
    try:
        return parse_quantity(answers.get(key, ""), dimension, decimal_comma=True)
    except Refused:
        return None  # asked, or named by the profile's reader, in its turn


def count_of(table: str, answers: Answers, keys: Sequence[str] = ("frequency",)) -> int:
    """Return how many elements of an array have an answer to one of some keys."""
    count = 0
    while any(answers.get(f"{table}.{count}.{key}") for key in keys):
        count += 1
    return count


def move_count(answers: Answers) -> int:
    """Return how many moves have a size."""
    return count_of("moves", answers, ("distance", "velocity_step"))


def schema_key(key: str) -> str:
    """Return a key as the schema has it, whose arrays have but a first element."""
    return re.sub(r"\.\d+(?=\.)", ".0", key)


def known_keys(answers: Answers) -> dict[str, KeyQuestion]:
    """Return what the schema says of each key of a profile with these answers."""
    way = answers.get("wizard.way", "")
    kind = KIND_OF_WAY.get(way, way)
    is_modal = follows(answers) or kind not in KINDS
    return _schema("modal" if is_modal else kind, follows(answers), is_rotary(answers))


@cache
def _schema(kind: str, open_loop: bool, rotary: bool) -> dict[str, KeyQuestion]:
    return {one.key: one for one in questions(kind, follows=open_loop, rotary=rotary)}


# Motor and load


def _pair_plant(known: Answers) -> dict[str, str]:
    """The keys of [plant] for motor and load; none while unknown.

    With M = m_1 + m_2 the load that swings by ω = √(k/m_2) against the held motor swings by
    ω √(M/m_1) where the motor is free, and its damping ratio grows likewise. Its share is -1/M at
    the load, and 1/m_1 - 1/M at the motor.
    """
    unit = axis_units(known)
    m_1, m_2 = (si_value(known, f"pair.{one}_mass", unit.mass) for one in ("motor", "load"))
    if m_1 is None or m_2 is None or min(m_1, m_2) <= 0.0:
        return {}
    mass = m_1 + m_2
    f = si_value(known, "pair.frequency", FREQUENCY)
    if known.get("wizard.way") == PAIR_BY_STIFFNESS:
        k = si_value(known, "pair.stiffness", unit.stiffness)
        f = None if k is None or k <= 0.0 else sqrt(k / m_2) / (2.0 * pi)
    zeta, freed = si_value(known, "pair.damping_ratio", RATIO), sqrt(mass / m_1)
    if not f or f < 0.0 or zeta is None:
        return {}
    return {
        "moving_mass": f"{mass:.10g} {unit.mass.si}",
        "modes.0.name": "drive",
        "modes.0.frequency": f"{f * freed:.10g} Hz",
        "modes.0.damping_ratio": f"{zeta * freed:.10g}",
        "modes.0.tcp_gain": f"{-1.0 / mass:.10g} {unit.gain.si}",
        "modes.0.measured_gain": f"{1.0 / m_1 - 1.0 / mass:.10g} {unit.gain.si}",
    }


def profile_key(key: str) -> str:
    """Return the key of the profile that one of motor and load gets to."""
    return "plant.modes.0.damping_ratio" if key == "pair.damping_ratio" else key


# To the profile


def to_profile(answers: Answers, defaults: Answers) -> Data:
    """Return the profile's tables for the answers, as far as they are known.

    ``machine.assumed`` names the defaults, and what an earlier profile called assumed.
    """
    known = {**defaults, **{key: text for key, text in answers.items() if text}}
    flat = {key: text for key, text in known.items() if not key.startswith((*OWN, "plant."))}
    if not follows(answers):
        flat.pop("drive.kind", None)  # a servo is what a profile means without it
    if payload := flat.pop("requirements.payload.1", ""):
        least = flat.pop("requirements.payload.0", f"0 {axis_units(answers).mass.si}")
        flat |= {"requirements.payload.0": least, "requirements.payload.1": payload}
    flat |= {f"plant.{key}": text for key, text in _plant(known).items()}
    accepted = answers.get(ACCEPTED, "").split()
    numbers = (key for key in defaults if not key.endswith((".name", ".source")))
    assumed = _assumed([*accepted, *numbers], flat)
    flat |= {f"machine.assumed.{i}": key for i, key in enumerate(assumed)}
    nested = nest(flat)
    machine = nested.get("machine")
    if isinstance(machine, dict) and machine.get("illustrative") in ("true", "false"):
        machine["illustrative"] = machine["illustrative"] == "true"
    ordered: Data = {"schema": 1}
    ordered |= {name: nested[name] for name in SECTIONS if name in nested}
    return ordered | {name: value for name, value in nested.items() if name not in ordered}


def _plant(known: Answers) -> dict[str, str]:
    way = known.get("wizard.way", "")
    if follows(known):
        way = MODAL
    if way in PAIRS:
        return {"kind": "modal", **_pair_plant(known)}
    own = {schema_key(key) for key in known_keys(known)}
    given = (key for key in known if key.startswith("plant.") and schema_key(key) in own)
    plant = {key.removeprefix("plant."): known[key] for key in given}
    return {"kind": KIND_OF_WAY.get(way, way), **plant} if way else {}


def _assumed(keys: Sequence[str], flat: Answers) -> list[str]:
    """The profile's keys of defaults, as messages spell them."""
    found = dict.fromkeys(map(profile_key, keys))
    there = [one for one in found if any(f"{key}.".startswith(f"{one}.") for key in flat)]
    return [show_key(read_path(key)) for key in there]


# From a profile, or a file of answers


def to_answers(data: Mapping[str, object]) -> dict[str, str]:
    """Return answers from a profile's tables, or from a file of answers."""
    answers = flatten(data)
    answers.pop("schema", None)
    assumed = [key for key in answers if key.startswith("machine.assumed.")]
    if accepted := [read_key(answers.pop(key)) for key in assumed]:
        answers[ACCEPTED] = " ".join(accepted)
    kind = answers.pop("plant.kind", "")
    if kind and not follows(answers):
        way = next((way for way, own in KIND_OF_WAY.items() if own == kind), kind)
        answers.setdefault("wizard.way", way)
    return answers


def close_arrays(answers: Answers) -> dict[str, str]:
    """Return the answers with no further mode and no further move: there are those that are."""
    counts = {"plant.modes.{}.frequency": count_of("plant.modes", answers)}
    counts["moves.{}.distance"] = move_count(answers)
    return {**answers, **{key.format(count): "" for key, count in counts.items() if count}}


def note_accepted(answers: Answers, key: str) -> dict[str, str]:
    """Return the answers with one that is assumed."""
    keys = dict.fromkeys([*answers.get(ACCEPTED, "").split(), key])
    return {**answers, ACCEPTED: " ".join(keys)}


def note_stated(answers: Answers, key: str) -> dict[str, str]:
    """Return the answers with one that is no longer assumed.

    Examples
    --------
    >>> given = {"drive.max_force": "1 N", "drive.force_lag": "1 s", "wizard.accepted": "drive"}
    >>> note_stated(given, "drive.max_force")["wizard.accepted"]
    'drive.force_lag'
    """
    left: list[str] = []
    rest = {name: text for name, text in answers.items() if name != ACCEPTED}
    for one in answers.get(ACCEPTED, "").split():
        if key.startswith(f"{one}."):  # a profile may name a whole table
            left += [name for name in rest if name.startswith(f"{one}.") and name != key]
        elif one != key:
            left.append(one)
    return {**rest, ACCEPTED: " ".join(left)} if left else rest


def flatten(data: object, path: str = "") -> dict[str, str]:
    """Return nested tables and arrays as texts by dotted key.

    Examples
    --------
    >>> flatten({"moves": [{"dwell": 1.5}], "a.b": "c"})
    {'moves.0.dwell': '1.5', 'a.b': 'c'}
    """
    if isinstance(data, Mapping):
        parts = [(str(key), value) for key, value in data.items()]
    elif isinstance(data, list):
        parts = [(str(i), value) for i, value in enumerate(data)]
    else:
        return {path: as_text(data)}
    flat: dict[str, str] = {}
    for key, value in parts:
        flat |= flatten(value, f"{path}.{key}" if path else key)
    return flat


def as_text(value: object) -> str:
    """Return a TOML value as the text that means the same in a profile."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def nest(flat: Mapping[str, str]) -> Data:
    """Return nested tables and arrays; the reverse of ``flatten``.

    Examples
    --------
    >>> nest({"moves.0.dwell": "1.5 s"})
    {'moves': [{'dwell': '1.5 s'}]}
    """
    tree: Data = {}
    for key, text in flat.items():
        *parents, last = key.split(".")
        table = tree
        for parent in parents:
            below = table.setdefault(parent, {})
            if not isinstance(below, dict):
                break  # a text where a table is needed: the profile reader says so
            table = below
        else:
            table[last] = text
    return {key: _listed(value) for key, value in tree.items()}


def _listed(tree: object) -> object:
    if not isinstance(tree, dict):
        return tree
    below = {key: _listed(value) for key, value in tree.items()}
    if below and all(key.isdigit() for key in below):
        return [below[key] for key in sorted(below, key=int)]
    return below
