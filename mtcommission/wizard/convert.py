"""Answers <-> profile: what was typed becomes the profile's keys, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import copysign, pi, prod, sqrt

from mtcommission.machine.machine import MOST_MOVES
from mtcommission.machine.readers import read_path
from mtcommission.plant.modal import MOST_MODES
from mtcommission.profile.lines import read_key, show_key
from mtcommission.units.axis_units import LINEAR, ROTARY
from mtcommission.units.quantities import FREQUENCY, RATIO, parse_quantity
from mtcommission.wizard.axis_units import (
    MEASURED,
    MODAL,
    NO,
    PAIR_BY_FREQUENCY,
    PAIRS,
    TOWER_BY_FREQUENCY,
    TOWER_BY_STIFFNESS,
    UNKNOWN,
    YES,
    axis_units,
    follows,
)
from mtcommission.wizard.question import Answers, list_accepted, note_accepted, si_value
from mtcommission.wizard.script import POSITIONING, STEP, list_questions

Data = dict[str, object]
"""Nested tables as TOML has them; all values are texts but the schema's number."""

OWN = ("wizard.", "measured.", "pair.")
"""Beginnings of the keys that only the wizard knows."""

SECTIONS = (
    "machine",
    "plant",
    "drive",
    "moves",
    "requirements",
    "control",
    "today",
    "damping_optimal",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """Two masses with a spring as a rigid mass and one mode.

    Parameters
    ----------
    moving_mass
        [kg].
    frequency_hz, damping_ratio
        Both masses free [Hz, -].
    tcp_gain, measured_gain
        Tool on the load, encoder on the motor [1/kg].
    """

    moving_mass: float
    frequency_hz: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PairMode:
    """One mode of motor and load, or a further one: frequency [Hz], and shares [1/kg]."""

    frequency_hz: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float


def couple(*, motor_mass: float, load_mass: float, stiffness: float, damping_ratio: float) -> Pair:
    """Return the modal form of motor - spring - load.

    With M = m_1 + m_2 and q = m_1 (x_1 - x_2), the force F on the motor
    drives q'' + 2 ζ ω q' + ω² q = F, ω² = k M/(m_1 m_2); x_1 = x + m_2/(m_1 M) q, x_2 = x - q/M.

    Parameters
    ----------
    motor_mass, load_mass
        m_1 and m_2 [kg].
    stiffness
        k [N/m].
    damping_ratio
        Of the load against the held motor [-].

    Examples
    --------
    >>> pair = couple(motor_mass=1.0, load_mass=3.0, stiffness=3.0, damping_ratio=0.01)
    >>> pair.tcp_gain, pair.measured_gain, round(2 * pi * pair.frequency_hz, 9)
    (-0.25, 0.75, 2.0)
    """
    m_1, m_2, k = motor_mass, load_mass, stiffness
    whole = m_1 + m_2
    return Pair(
        moving_mass=whole,
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


MOST_SHARE = 3.0
"""Largest share at the tool that is taken without a measurement there, in 1/M (empirical)."""


def to_profile(answers: Answers) -> Data:
    """Return the profile's tables for the answers.

    Parameters
    ----------
    answers
        As far as known; what is missing is left out.

    Returns
    -------
    dict
        Tables in the profile's order, after ``schema``; ``machine.assumed`` names the defaults
        that were only accepted.
    """
    data = _tables(answers)
    machine, assumed = data.get("machine"), list_unmeasured(answers)
    if isinstance(machine, dict):
        if machine.get("illustrative") in ("true", "false"):
            machine["illustrative"] = machine["illustrative"] == "true"
        if assumed:
            machine["assumed"] = list(assumed)
    return data


def _tables(answers: Answers) -> Data:
    flat = {key: text for key, text in answers.items() if text and _is_profile_key(key)}
    flat = {key: text for key, text in flat.items() if not key.startswith("plant.")}
    if not follows(answers):
        flat.pop("drive.kind", None)  # a servo is what a profile means without it
    if flat.get("control.position_loop") == UNKNOWN:
        del flat["control.position_loop"]  # the profile's reader calls it assumed
    plant = {key: text for key, text in _plant(answers).items() if text}
    payload = flat.pop("requirements.payload.1", "")
    least = flat.pop("requirements.payload.0", "")
    if payload and parse_quantity(payload, axis_units(answers).mass) > 0.0:
        flat["requirements.payload.0"] = least or f"0 {axis_units(answers).mass.si}"
        flat["requirements.payload.1"] = payload
    nested = nest({**flat, **plant})
    ordered: Data = {"schema": 1}
    ordered |= {name: nested[name] for name in SECTIONS if name in nested}
    return ordered | {name: value for name, value in nested.items() if name not in ordered}


DERIVED_FROM = {
    "measured.base_damping_ratio": "plant.base_damping",
    "measured.rotary_damping_ratio": "plant.rotary_damping",
    "pair.damping_ratio": "plant.modes.0.damping_ratio",
}
"""Where a default of the wizard's own keys gets to in the profile."""


def list_unmeasured(answers: Answers) -> tuple[str, ...]:
    """Return the profile's keys whose values are defaults that were only accepted.

    Parameters
    ----------
    answers
        As far as known.

    Returns
    -------
    tuple of str
        As messages spell them, in the order in which they were accepted.

    Examples
    --------
    >>> list_unmeasured({"drive.force_lag": "2 ms", "wizard.accepted": "drive.force_lag"})
    ('drive.force_lag',)
    """
    asked = {question.key for question in list_questions(answers)}
    # The same key of [plant] may come from another description of the mechanics by now.
    valid = [key for key in list_accepted(answers) if key in asked or not key.startswith("plant.")]
    keys = [_written_as(key) for key in valid if _has(answers, key)]
    if modes := further_modes(answers):
        places = [f"plant.modes.{i}" for i in range(1 + len(modes))]
        keys += [f"{place}.{gain}" for place in places for gain in ("tcp_gain", "measured_gain")]
    written = flatten(_tables(answers))
    return tuple(show_key(read_path(key)) for key in dict.fromkeys(keys) if _has(written, key))


def _written_as(key: str) -> str:
    """The profile's key of a default; a further mode of a pair is one later there."""
    _, _, rest = key.partition("pair.modes.")
    if rest:
        index, _, name = rest.partition(".")
        return f"plant.modes.{int(index) + 1}.{name}"
    return DERIVED_FROM.get(key, key)


def _has(answers: Answers, key: str) -> bool:
    """Whether there is a key, or one below it."""
    return any(text and (one == key or one.startswith(f"{key}.")) for one, text in answers.items())


ASKED = {"modal": MODAL, "manipulator": TOWER_BY_STIFFNESS}
"""Kinds of plant that there are questions for, and the way that asks for each key of them."""


def to_answers(data: Mapping[str, object]) -> dict[str, str]:
    """Return answers from a profile's tables, or from a file of answers.

    Parameters
    ----------
    data
        From tomllib; the profile's own keys, nested or dotted, and the wizard's.

    Returns
    -------
    dict
        With the choices that the tables imply.
    """
    answers = flatten(data)
    answers.pop("schema", None)
    files = [answers.pop(key) for key in list(answers) if key.startswith(f"{MEASURED}.")]
    if files:
        answers[MEASURED] = "; ".join(files)
    assumed = [key for key in answers if key.startswith("machine.assumed.")]
    accepted = [read_key(answers.pop(key)) for key in assumed]
    if accepted:
        answers = note_accepted(answers, *accepted)
    kind = answers.pop("plant.kind", "")
    if kind and "wizard.way" not in answers and not follows(answers):
        answers["wizard.way"] = ASKED.get(kind, TOWER_BY_STIFFNESS)
    if any(key.startswith("pair.modes.") for key in answers):
        answers.setdefault("pair.further", YES)
    for table in ("plant.modes", "pair.modes", "moves"):
        most = MOST_MOVES if table == "moves" else MOST_MODES
        for i in range(most):
            here, there = f"{table}.{i}.", f"{table}.{i + 1}."
            if any(key.startswith(here) for key in answers):
                goes_on = any(key.startswith(there) for key in answers)
                answers.setdefault(f"{here}more", YES if goes_on else NO)
                if table == "moves":
                    step = f"{here}velocity_step" in answers
                    answers.setdefault(f"{here}kind", STEP if step else POSITIONING)
    detailed = ("damping_optimal.t_f", "damping_optimal.weights.")
    if any(key.startswith(detailed) for key in answers):
        answers.setdefault("wizard.experts", YES)
    return answers


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
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)


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


def _is_profile_key(key: str) -> bool:
    if key.startswith("moves.") and key.endswith((".kind", ".more")):
        return False
    return not key.startswith(OWN)


def _plant(answers: Answers) -> dict[str, str]:
    """The keys of [plant], from whichever way the mechanics were described."""
    given = {
        key: text
        for key, text in answers.items()
        if key.startswith("plant.") and not key.endswith(".more")
    }
    tower = {key: text for key, text in given.items() if not key.startswith("plant.mo")}
    modal = {key: text for key, text in given.items() if key.startswith("plant.mo")}
    if follows(answers):
        held = {key: text for key, text in modal.items() if key.startswith("plant.modes.")}
        return {"plant.kind": "modal", **held}
    match answers.get("wizard.way", ""):
        case chosen if chosen == TOWER_BY_STIFFNESS:
            return {"plant.kind": "manipulator", **tower}
        case chosen if chosen == TOWER_BY_FREQUENCY:
            return {"plant.kind": "manipulator", **tower, **_tower_springs(answers)}
        case chosen if chosen in PAIRS:
            return {"plant.kind": "modal", **_pair_plant(answers)}
        case chosen if chosen == MODAL:
            return {"plant.kind": "modal", **modal}
    return {}


def _tower_springs(answers: Answers) -> dict[str, str]:
    """Stiffness and damping from measured frequencies: k = m ω², d = 2 ζ m ω."""
    found = {}
    for name, mass_key, unit in (
        ("base", "plant.base_mass", LINEAR),
        ("rotary", "plant.rotary_inertia", ROTARY),
    ):
        m = si_value(answers, mass_key, unit.mass)
        f = si_value(answers, f"measured.{name}_frequency", FREQUENCY)
        zeta = si_value(answers, f"measured.{name}_damping_ratio", RATIO)
        if m is None or f is None:
            continue
        omega = 2.0 * pi * f
        found[f"plant.{name}_stiffness"] = f"{m * omega**2:.10g} {unit.stiffness.si}"
        if zeta is not None:
            found[f"plant.{name}_damping"] = f"{2.0 * zeta * m * omega:.10g} {unit.damping.si}"
    return found


def pair_of(answers: Answers) -> Pair | None:
    """Return the two masses with their spring; None while something is missing."""
    unit = axis_units(answers)
    m_1 = si_value(answers, "pair.motor_mass", unit.mass)
    m_2 = si_value(answers, "pair.load_mass", unit.mass)
    zeta = si_value(answers, "pair.damping_ratio", RATIO)
    k = si_value(answers, "pair.stiffness", unit.stiffness)
    if answers.get("wizard.way") == PAIR_BY_FREQUENCY:
        f = si_value(answers, "pair.frequency", FREQUENCY)
        k = None if f is None or m_2 is None else m_2 * (2.0 * pi * f) ** 2
    if m_1 is None or m_2 is None or k is None or zeta is None or min(m_1, m_2, k) <= 0.0:
        return None
    return couple(motor_mass=m_1, load_mass=m_2, stiffness=k, damping_ratio=zeta)


def further_modes(answers: Answers) -> tuple[tuple[float, float], ...]:
    """Return frequency [Hz] and damping ratio of what was measured besides motor and load."""
    found, more = list[tuple[float, float]](), "pair.further"
    while answers.get("wizard.way") in PAIRS and answers.get(more) == YES:
        place = f"pair.modes.{len(found)}"
        f = si_value(answers, f"{place}.frequency", FREQUENCY)
        zeta = si_value(answers, f"{place}.damping_ratio", RATIO)
        if not f or zeta is None:
            break
        found.append((f, zeta))
        more = f"{place}.more"
    return tuple(found)


def pair_modes(answers: Answers) -> tuple[PairMode, ...]:
    """Return the mode of motor and load, then the further ones; none while something is missing."""
    pair = pair_of(answers)
    if pair is None:
        return ()
    first = PairMode(
        frequency_hz=pair.frequency_hz,
        damping_ratio=pair.damping_ratio,
        tcp_gain=pair.tcp_gain,
        measured_gain=pair.measured_gain,
    )
    further = further_modes(answers)
    if not further:
        return (first,)
    found = [(pair.frequency_hz, pair.damping_ratio), *further]
    shares = share_out(
        [f for f, _ in found],
        motor_mass=1.0 / (pair.measured_gain + 1.0 / pair.moving_mass),
        moving_mass=pair.moving_mass,
    )
    return tuple(
        PairMode(frequency_hz=f, damping_ratio=zeta, tcp_gain=tool, measured_gain=seen)
        for (f, zeta), (tool, seen) in zip(found, shares, strict=True)
    )


def _pair_plant(answers: Answers) -> dict[str, str]:
    pair, unit = pair_of(answers), axis_units(answers)
    if pair is None:
        return {}
    plant = {"plant.moving_mass": f"{pair.moving_mass:.10g} {unit.mass.si}"}
    for i, mode in enumerate(pair_modes(answers)):
        plant |= {
            f"plant.modes.{i}.name": f"mode{i + 1}" if i else "drive",
            f"plant.modes.{i}.frequency": f"{mode.frequency_hz:.10g} Hz",
            f"plant.modes.{i}.damping_ratio": f"{mode.damping_ratio:.10g}",
            f"plant.modes.{i}.tcp_gain": f"{mode.tcp_gain:.10g} {unit.gain.si}",
            f"plant.modes.{i}.measured_gain": f"{mode.measured_gain:.10g} {unit.gain.si}",
        }
    return plant
