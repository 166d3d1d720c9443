"""Answers <-> profile: what was typed becomes the profile's keys, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import copysign, pi, prod, sqrt

from mtcommission.base.errors import Refused
from mtcommission.base.units.axis_units import LINEAR, ROTARY, AxisUnits
from mtcommission.base.units.quantities import FREQUENCY, RATIO, Dimension, parse_quantity
from mtcommission.machine.mechanics import SOURCE
from mtcommission.machine.profile.lines import read_key, show_key
from mtcommission.machine.readers import read_path

Answers = Mapping[str, str]
"""What was typed, by dotted key: the profile's own keys, or the wizard's beside them; "": left
out."""

Data = dict[str, object]
"""Nested tables as TOML has them; all values are texts but the schema's number."""

TOWER_BY_STIFFNESS = "tower: masses and stiffness"
TOWER_BY_FREQUENCY = "tower: masses and measured eigenfrequencies"
PAIR_BY_STIFFNESS = "motor and load: masses and stiffness"
PAIR_BY_FREQUENCY = "motor and load: masses and measured eigenfrequency"
MODAL = "modes from a Bode plot"
FILES = "files with a measured response"
PAIRS = (PAIR_BY_FREQUENCY, PAIR_BY_STIFFNESS)
"""Ways into the mechanics; the wizard converts all to one of the profile's kinds of plant."""

WAY_OF_KIND = {"modal": MODAL, "manipulator": TOWER_BY_STIFFNESS}

MEASURED = "wizard.measured"
"""Key of files with measured responses, with ; or , between them."""

ACCEPTED = "wizard.accepted"
"""Key under which those keys stand, with blanks between, whose values a profile calls assumed."""

OWN = ("wizard.", "measured.", "pair.")
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


def count_of(table: str, key: str, answers: Answers) -> int:
    """Return how many elements of an array have an answer to a key."""
    count = 0
    while answers.get(f"{table}.{count}.{key}"):
        count += 1
    return count


# Motor and load


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """One mode of a chain of masses: shares at the tool and at the encoder."""

    frequency_hz: float
    damping_ratio: float
    tcp_gain: float  # [1/kg]
    measured_gain: float  # [1/kg]


def couple(
    *, motor_mass: float, load_mass: float, stiffness: float, damping_ratio: float
) -> tuple[float, Mode]:
    """Return moving mass and mode of motor - spring - load; the ratio is with the motor held.

    With M = m_1 + m_2 and q = m_1 (x_1 - x_2), the force F on the motor
    drives q'' + 2 ζ ω q' + ω² q = F, ω² = k M/(m_1 m_2); x_1 = x + m_2/(m_1 M) q, x_2 = x - q/M.

    Examples
    --------
    >>> _, mode = couple(motor_mass=1.0, load_mass=3.0, stiffness=3.0, damping_ratio=0.01)
    >>> mode.tcp_gain, mode.measured_gain, round(2 * pi * mode.frequency_hz, 9)
    (-0.25, 0.75, 2.0)
    """
    m_1, m_2, k = motor_mass, load_mass, stiffness
    whole = m_1 + m_2
    return whole, Mode(
        frequency_hz=sqrt(k * whole / (m_1 * m_2)) / (2.0 * pi),
        damping_ratio=damping_ratio * sqrt(whole / m_1),
        tcp_gain=-1.0 / whole,
        measured_gain=m_2 / (m_1 * whole),
    )


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


def _pair(answers: Answers) -> tuple[float, tuple[Mode, ...]] | None:
    """Moving mass and modes of motor and load, and what was measured besides; None: not yet."""
    unit = axis_units(answers)
    m_1, m_2 = (si_value(answers, f"pair.{one}_mass", unit.mass) for one in ("motor", "load"))
    zeta, k = (
        si_value(answers, "pair.damping_ratio", RATIO),
        si_value(answers, "pair.stiffness", unit.stiffness),
    )
    if answers.get("wizard.way") == PAIR_BY_FREQUENCY:
        f = si_value(answers, "pair.frequency", FREQUENCY)
        k = None if f is None or m_2 is None else m_2 * (2.0 * pi * f) ** 2
    if m_1 is None or m_2 is None or k is None or zeta is None or min(m_1, m_2, k) <= 0.0:
        return None
    mass, mode = couple(motor_mass=m_1, load_mass=m_2, stiffness=k, damping_ratio=zeta)
    found = [(mode.frequency_hz, mode.damping_ratio)]
    for i in range(count_of("pair.modes", "frequency", answers)):
        f = si_value(answers, f"pair.modes.{i}.frequency", FREQUENCY)
        ratio = si_value(answers, f"pair.modes.{i}.damping_ratio", RATIO)
        if f and ratio is not None:
            found.append((f, ratio))
    if len(found) == 1:
        return mass, (mode,)
    shares = share_out([f for f, _ in found], motor_mass=m_1, moving_mass=mass)
    modes = (
        Mode(frequency_hz=f, damping_ratio=ratio, tcp_gain=tool, measured_gain=seen)
        for (f, ratio), (tool, seen) in zip(found, shares, strict=True)
    )
    return mass, tuple(modes)


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
    number_keys = (key for key in defaults if not key.endswith((".name", ".source")))
    if assumed := _assumed([*accepted, *number_keys], answers, flat):
        flat |= {f"machine.assumed.{i}": key for i, key in enumerate(assumed)}
    nested = nest(flat)
    machine = nested.get("machine")
    if isinstance(machine, dict) and machine.get("illustrative") in ("true", "false"):
        machine["illustrative"] = machine["illustrative"] == "true"
    ordered: Data = {"schema": 1}
    ordered |= {name: nested[name] for name in SECTIONS if name in nested}
    return ordered | {name: value for name, value in nested.items() if name not in ordered}


DERIVED_FROM = {
    "measured.base_damping_ratio": "plant.base_damping",
    "measured.rotary_damping_ratio": "plant.rotary_damping",
    "pair.damping_ratio": "plant.modes.0.damping_ratio",
}
"""Where a default of the wizard's own keys gets to in the profile."""


def _assumed(keys: Sequence[str], answers: Answers, flat: Answers) -> tuple[str, ...]:
    """The profile's keys of defaults, as messages spell them."""
    found = list[str]()
    for key in keys:
        _, _, rest = key.partition("pair.modes.")
        index, _, name = rest.partition(".")
        found.append(f"plant.modes.{int(index) + 1}.{name}" if rest else DERIVED_FROM.get(key, key))
    further = count_of("pair.modes", "frequency", answers)
    if answers.get("wizard.way") in PAIRS and further:
        places = [f"plant.modes.{i}" for i in range(1 + further)]
        found += [f"{place}.{gain}" for place in places for gain in ("tcp_gain", "measured_gain")]
    there = [one for one in found if any(f"{key}.".startswith(f"{one}.") for key in flat)]
    return tuple(show_key(read_path(key)) for key in dict.fromkeys(there))


def _plant(known: Answers) -> dict[str, str]:
    """The keys of [plant], from whichever way the mechanics were described."""
    given = {
        key.removeprefix("plant."): text for key, text in known.items() if key.startswith("plant.")
    }
    if follows(known):
        held = {key: text for key, text in given.items() if key.startswith("modes.")}
        return {"kind": "modal", **held}
    match known.get("wizard.way", ""):
        case "":
            return {}
        case chosen if chosen in PAIRS:
            return {"kind": "modal", **_pair_plant(known)}
        case chosen if chosen == TOWER_BY_FREQUENCY:
            return {"kind": "manipulator", **_without_modes(given), **_tower_springs(known)}
        case chosen if chosen == TOWER_BY_STIFFNESS:
            return {"kind": "manipulator", **_without_modes(given)}
        case chosen if chosen in (MODAL, FILES):
            kept = ("moving_mass", "modes.")
            return {"kind": "modal", **{k: text for k, text in given.items() if k.startswith(kept)}}
        case kind:
            return {"kind": kind, **given}


def _without_modes(given: Answers) -> dict[str, str]:
    return {key: text for key, text in given.items() if not key.startswith("mo")}


def _tower_springs(known: Answers) -> dict[str, str]:
    """Stiffness and damping from measured frequencies: k = m ω², d = 2 ζ m ω."""
    found = {}
    for name, mass_key, unit in (
        ("base", "plant.base_mass", LINEAR),
        ("rotary", "plant.rotary_inertia", ROTARY),
    ):
        m = si_value(known, mass_key, unit.mass)
        f = si_value(known, f"measured.{name}_frequency", FREQUENCY)
        zeta = si_value(known, f"measured.{name}_damping_ratio", RATIO)
        if m is not None and f is not None and zeta is not None:
            omega = 2.0 * pi * f
            found[f"{name}_stiffness"] = f"{m * omega**2:.10g} {unit.stiffness.si}"
            found[f"{name}_damping"] = f"{2.0 * zeta * m * omega:.10g} {unit.damping.si}"
    return found


def _pair_plant(known: Answers) -> dict[str, str]:
    pair, unit = _pair(known), axis_units(known)
    if pair is None:
        return {}
    mass, modes = pair
    plant = {"moving_mass": f"{mass:.10g} {unit.mass.si}"}
    for i, mode in enumerate(modes):
        plant |= {
            f"modes.{i}.name": f"mode{i + 1}" if i else "drive",
            f"modes.{i}.frequency": f"{mode.frequency_hz:.10g} Hz",
            f"modes.{i}.damping_ratio": f"{mode.damping_ratio:.10g}",
            f"modes.{i}.tcp_gain": f"{mode.tcp_gain:.10g} {unit.gain.si}",
            f"modes.{i}.measured_gain": f"{mode.measured_gain:.10g} {unit.gain.si}",
        }
    return plant


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
        answers.setdefault("wizard.way", WAY_OF_KIND.get(kind, kind))
    return answers


def move_count(answers: Answers) -> int:
    """Return how many moves have a size."""
    count = 0
    while any(answers.get(f"moves.{count}.{key}") for key in ("distance", "velocity_step")):
        count += 1
    return count


def close_arrays(answers: Answers) -> dict[str, str]:
    """Return the answers with no further mode and no further move: there are those that are."""
    counts = {
        table: count_of(table, "frequency", answers) for table in ("plant.modes", "pair.modes")
    }
    ends = {f"{table}.{count}.frequency": "" for table, count in counts.items() if count}
    count = move_count(answers)
    return {**answers, **ends, **({f"moves.{count}.distance": ""} if count else {})}


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


def flatten(data: object, *, path: str = "") -> dict[str, str]:
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
        flat |= flatten(value, path=f"{path}.{key}" if path else key)
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
    listed = _listed(tree)
    return listed if isinstance(listed, dict) else {}


def _listed(tree: object) -> object:
    """Turn tables whose keys are 0, 1, 2, ... into arrays."""
    if not isinstance(tree, dict):
        return tree
    below = {key: _listed(value) for key, value in tree.items()}
    if below and all(key.isdigit() for key in below):
        return [below[key] for key in sorted(below, key=int)]
    return below
