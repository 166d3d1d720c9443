"""Answers <-> profile: what was typed becomes the profile's keys, and back."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from math import copysign, pi, prod, sqrt

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
FILES = "files with a measured response"
PAIRS = (PAIR_BY_FREQUENCY, PAIR_BY_STIFFNESS)
"""Ways into the mechanics; the wizard converts all to one of the profile's kinds of plant."""

KIND_OF_WAY = {
    MODAL: "modal",
    TOWER: "manipulator",
    FILES: "modal",
    **dict.fromkeys(PAIRS, "modal"),
}
"""Of other ways, the kind is the way."""

MEASURED = "wizard.measured"
"""Key of files with measured responses, with ; or , between them."""

ACCEPTED = "wizard.accepted"
"""Key under which those keys stand, with blanks between, whose values a profile calls assumed."""

OWN = ("wizard.", "pair.")
"""Beginnings of the keys that only the wizard knows."""

SERVO = "servo"
"""Kind of drive that a profile means without the key."""

SECTIONS = ("machine", "plant", "drive", "moves", "requirements", "control", "today")

MOST_SHARE = 3.0
"""Largest share at the tool that is taken without a measurement there, in 1/M (empirical)."""


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


def share_out(
    frequencies: Sequence[float], *, motor_mass: float, moving_mass: float
) -> tuple[tuple[float, float], ...]:
    """Return the shares of modes at tool and encoder [1/kg] where only frequencies were measured.

    The tool ends a chain of masses that begins at the motor. Then the response from force to tool
    has no zeros, 1/(M s²) Π ω_j²/(s² + ω_j²), so the share of mode k at the tool is
    -1/M Π_{j≠k} ω_j²/(ω_j² - ω_k²), whatever the masses between. A mode of the frame may stand
    beside the chain instead: no share is taken for less than 1/M, the worst case of a tool on the
    far side of one spring. Close frequencies would ask for a tool of hardly any mass: no share is
    taken for more than ``MOST_SHARE``/M. At the encoder the shares add up to 1/m_motor - 1/M, since
    the motor alone moves at first; they are divided like those at the tool, which is what the chain
    with the heaviest tool does. Of one mode both are exact: motor, spring and load.

    Examples
    --------
    >>> share_out([40.0, 80.0], motor_mass=1.0, moving_mass=4.0)
    ((-0.333..., 0.428...), (0.25, 0.321...))
    """
    m = moving_mass
    tool = []
    for k, own in enumerate(frequencies):
        others = [f for j, f in enumerate(frequencies) if j != k]
        chain = prod(f**2 / (f**2 - own**2) for f in others if f != own)
        tool.append(-copysign(min(max(abs(chain), 1.0), MOST_SHARE), chain) / m)
    seen = (1.0 / motor_mass - 1.0 / m) / sum(map(abs, tool))
    return tuple((gain, seen * abs(gain)) for gain in tool)


def _pair_plant(known: Answers) -> dict[str, str]:
    """The keys of [plant] for motor, load and what was measured besides; none while unknown.

    With M = m_1 + m_2 the load that swings by ω = √(k/m_2) against the held motor swings by
    ω √(M/m_1) where the motor is free, and its damping ratio grows likewise.
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
    found = [(f * freed, zeta * freed)]
    for i in range(count_of("pair.modes", known)):
        further = si_value(known, f"pair.modes.{i}.frequency", FREQUENCY)
        ratio = si_value(known, f"pair.modes.{i}.damping_ratio", RATIO)
        if further and ratio is not None:
            found.append((further, ratio))
    shares = share_out([f for f, _ in found], motor_mass=m_1, moving_mass=mass)
    plant = {"moving_mass": f"{mass:.10g} {unit.mass.si}"}
    for i, ((frequency, ratio), (tool, seen)) in enumerate(zip(found, shares, strict=True)):
        plant |= {
            f"modes.{i}.name": f"mode{i + 1}" if i else "drive",
            f"modes.{i}.frequency": f"{frequency:.10g} Hz",
            f"modes.{i}.damping_ratio": f"{ratio:.10g}",
            f"modes.{i}.tcp_gain": f"{tool:.10g} {unit.gain.si}",
            f"modes.{i}.measured_gain": f"{seen:.10g} {unit.gain.si}",
        }
    return plant


def profile_key(key: str) -> str:
    """Return the key of the profile that one of motor and load gets to.

    Examples
    --------
    >>> profile_key("pair.modes.0.frequency"), profile_key("drive.lead")
    ('plant.modes.1.frequency', 'drive.lead')
    """
    if key == "pair.damping_ratio":
        return "plant.modes.0.damping_ratio"
    return re.sub(r"^pair\.modes\.(\d+)", lambda one: f"plant.modes.{int(one[1]) + 1}", key)


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
    assumed = _assumed([*accepted, *numbers], answers, flat)
    flat |= {f"machine.assumed.{i}": key for i, key in enumerate(assumed)}
    nested = nest(flat)
    machine = nested.get("machine")
    if isinstance(machine, dict) and machine.get("illustrative") in ("true", "false"):
        machine["illustrative"] = machine["illustrative"] == "true"
    ordered: Data = {"schema": 1}
    ordered |= {name: nested[name] for name in SECTIONS if name in nested}
    return ordered | {name: value for name, value in nested.items() if name not in ordered}


def _plant(known: Answers) -> dict[str, str]:
    """The keys of [plant], from whichever way the mechanics were described."""
    way = known.get("wizard.way", "")
    if follows(known):
        way = MODAL
    if way in PAIRS:
        return {"kind": "modal", **_pair_plant(known)}
    own = {schema_key(key) for key in known_keys(known)}
    given = (key for key in known if key.startswith("plant.") and schema_key(key) in own)
    plant = {key.removeprefix("plant."): known[key] for key in given}
    return {"kind": KIND_OF_WAY.get(way, way), **plant} if way else {}


def _assumed(keys: Sequence[str], answers: Answers, flat: Answers) -> list[str]:
    """The profile's keys of defaults, as messages spell them."""
    found = [profile_key(key) for key in keys]
    further = count_of("pair.modes", answers)
    if answers.get("wizard.way") in PAIRS and further:
        places = [f"plant.modes.{i}" for i in range(1 + further)]
        found += [f"{place}.{gain}" for place in places for gain in ("tcp_gain", "measured_gain")]
    there = [one for one in found if any(f"{key}.".startswith(f"{one}.") for key in flat)]
    return [show_key(read_path(key)) for key in dict.fromkeys(there)]


# From a profile, or a file of answers


def to_answers(data: Mapping[str, object]) -> dict[str, str]:
    """Return answers from a profile's tables, or from a file of answers."""
    answers = flatten(data)
    answers.pop("schema", None)
    files = [answers.pop(key) for key in list(answers) if key.startswith(f"{MEASURED}.")]
    if files:
        answers[MEASURED] = "; ".join(files)
    assumed = [key for key in answers if key.startswith("machine.assumed.")]
    if accepted := [read_key(answers.pop(key)) for key in assumed]:
        answers[ACCEPTED] = " ".join(accepted)
    kind = answers.pop("plant.kind", "")
    if MEASURED in answers:
        answers.setdefault("wizard.way", FILES)
    elif kind and not follows(answers):
        way = next((way for way, own in KIND_OF_WAY.items() if own == kind), kind)
        answers.setdefault("wizard.way", way)
    return answers


def close_arrays(answers: Answers) -> dict[str, str]:
    """Return the answers with no further mode and no further move: there are those that are."""
    counts = {f"{table}.{{}}.frequency": count_of(table, answers) for table in ARRAYS}
    counts["moves.{}.distance"] = move_count(answers)
    return {**answers, **{key.format(count): "" for key, count in counts.items() if count}}


ARRAYS = ("plant.modes", "pair.modes")


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
    """Turn tables whose keys are 0, 1, 2, ... into arrays."""
    if not isinstance(tree, dict):
        return tree
    below = {key: _listed(value) for key, value in tree.items()}
    if below and all(key.isdigit() for key in below):
        return [below[key] for key in sorted(below, key=int)]
    return below
