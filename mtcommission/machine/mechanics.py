"""What a machine knows of its mechanics, whichever kind of plant describes them.

The kinds themselves stand in ``plant``, one file each, or outside the package: ``register`` adds
one, and everything goes through the protocol.
"""

from __future__ import annotations

import cmath
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits, Dimension
from mtcommission.machine import readers as of
from mtcommission.machine.keys import (
    ELSEWHERE,
    ByKind,
    Misfit,
    find_kind,
    keyed,
    read_table,
    table_schema,
)
from mtcommission.machine.readers import (
    IDENTIFIER,
    LONGEST_NAME,
    KeyPath,
    Reading,
    Text,
    must_be,
    one_of,
)

Array = NDArray[np.float64]

EQUAL_POLE_TOLERANCE = 1e-6
"""Relative distance of two poles below which they count as one (empirical: beyond it the
moment equations of the two modes are dependent to half of double precision)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlexibleMode:
    """One mode q'' + 2 ζ ω q' + ω² q = F."""

    name: str = keyed(IDENTIFIER, "Name of the mode.", "column")  # used in state names
    natural_frequency: float = keyed(
        of.FREQUENCIES, "Eigenfrequency, undamped.", "40 Hz", key="frequency", factor=2.0 * pi
    )  # ω [rad/s]
    damping_ratio: float = keyed(of.RATIOS, "Damping ratio, 0 to below 1.", "0.03")  # ζ [-]
    tcp_gain: float = keyed(
        of.MODE_GAINS, "Share in the tool position.", "0.002 1/kg"
    )  # of q, signed
    measured_gain: float = keyed(
        of.MODE_GAINS, "Share in the encoder position.", "0.001 1/kg", default=0.0
    )  # of q, signed [1/kg]

    @property
    def frequency_hz(self) -> float:
        """Natural frequency [Hz]."""
        return self.natural_frequency / (2 * pi)

    @property
    def pole(self) -> complex:
        """The pole with positive imaginary part, -ζω + iω√(1-ζ²) [1/s]; beyond ζ = 1 the slower."""
        zeta, omega = self.damping_ratio, self.natural_frequency
        return -zeta * omega + omega * cmath.sqrt(zeta**2 - 1.0)

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> list[Misfit]:
        """Return key and message of what cannot be."""
        if 0.0 <= self.damping_ratio < 1.0:
            return []
        return [("damping_ratio", Message("damping-ratio-beyond-one", got=self.damping_ratio))]


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldMode(FlexibleMode):
    """One mode q'' + 2 ζ ω q' + ω² q = -x_ref''.

    As every plant has its modes driven by a force, q stands here for -q: so its gain is negative.
    """

    name: str = keyed(IDENTIFIER, "Name of the mode.", "belt")  # used in state names
    natural_frequency: float = keyed(
        of.FREQUENCIES,
        "Eigenfrequency with the motor held, undamped.",
        "48 Hz",
        key="frequency",
        factor=2.0 * pi,
    )  # ω [rad/s]
    damping_ratio: float = keyed(of.RATIOS, "Damping ratio, 0 to below 1.", "0.05")  # ζ [-]
    tcp_gain: float = keyed(
        of.RATIOS,
        "Share in the tool position; 1 where one mode is all of it.",
        "1",
        factor=-1.0,
        default=-1.0,
        left_out=-1.0,
    )  # of q, signed [-]
    measured_gain: float = 0.0


ELSEWHERE[HeldMode] = (FlexibleMode, "servo")


@dataclass(frozen=True, slots=True)
class ModeStates:
    """Where the coordinate q of a mode stands in the plant."""

    deflection: str  # name of the state that is scale times q
    rate: str  # name of the state that is scale times q'
    scale: float = 1.0  # factor from q to the state


class Mechanics(Protocol):
    """A rigid mass with flexible modes; a kind of plant is a frozen dataclass that tells this.

    Its fields are made by ``keyed``, so that a profile can state it. What is written out here holds
    for most kinds.
    """

    kind: ClassVar[str]
    """As ``plant.kind`` of a profile names it."""
    position: ClassVar[str]
    velocity: ClassVar[str]
    """Names of the states of the rigid motion."""

    @property
    def moving_mass(self) -> float:
        """Rigid mass that the drive accelerates [kg]."""

    @property
    def modes(self) -> tuple[FlexibleMode, ...]:
        """The flexible modes, in the order of the plant's states."""

    def mode_states(self) -> tuple[ModeStates, ...]:
        """Return where each mode stands in the plant."""

    @classmethod
    def states(cls, modes: Sequence[str], axis: AxisUnits) -> dict[str, Dimension]:
        """Return the plant's states in order and what they measure, from the modes' names."""

    def mode_key(self, index: int) -> str:
        """Return the key of a mode in the profile; "plant" where it follows from several."""
        return "plant"

    def vary(
        self, *, payload: float, payload_radius: float, frequency: float, damping: float
    ) -> Self:
        """Return the mechanics with payload [kg, m], frequencies and damping ratios scaled [-]."""

    def inertia_ratio(self, mode: str, payload: Array, payload_radius: float) -> Array:
        """Return what a mode moves without payload over that with it [-], shape of payload."""
        return np.ones_like(payload)

    def renew(self, *, mass: float, modes: Sequence[FlexibleMode]) -> Self:
        """Return the mechanics with a rigid mass [kg] and these frequencies and damping ratios.

        Gains stay. What a recorded move showed goes into the profile by the keys that differ.
        """

    def still_tool(self, modes: Collection[str]) -> Self | None:
        """Return the mechanics with a tool that does not move in these modes.

        None where no key states the tool's share in a mode.
        """
        return None

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterable[Misfit]:
        """Return key below [plant] and message of what does not fit together."""
        return ()

    def assumptions(self) -> tuple[Message, ...]:
        """Return what the kind assumes beyond the profile."""
        return ()


def find_equal_poles(modes: Sequence[FlexibleMode]) -> Iterator[tuple[int, Message]]:
    """Yield the place of each mode that has the poles of an earlier one, and what is wrong."""
    for place, mode in enumerate(modes):
        for other in modes[:place]:
            if abs(mode.pole - other.pole) <= EQUAL_POLE_TOLERANCE * abs(mode.pole):
                yield (
                    place,
                    Message(
                        "modes-at-one-frequency",
                        one=other.name,
                        other=mode.name,
                        frequency=mode.frequency_hz,
                    ),
                )


KINDS: dict[str, type[Mechanics]] = {}
"""Kinds of plant by the name that ``plant.kind`` of a profile gives."""

HELD: dict[type[Mechanics], type[Mechanics]] = {}
"""Form of a kind below a motor that follows its setpoint: the same name, other keys."""

SOURCE = "position_source"
"""Word of drive.kind for a motor that follows its setpoint."""


def register(kind: type[Mechanics], *, motor_held: type[Mechanics] | None = None) -> None:
    """Add a kind of plant: profiles may name it from now on.

    ``motor_held``: its form below a motor that follows; without one such a drive is refused.
    """
    KINDS[kind.kind] = kind
    if motor_held is not None:
        HELD[kind] = motor_held
        ELSEWHERE[motor_held] = (kind, "servo")


def plant_kinds(follows: bool) -> dict[str, type[Mechanics]]:
    """Return the kinds of plant by name, each in its form below one kind of drive."""
    return {name: HELD.get(kind, kind) if follows else kind for name, kind in KINDS.items()}


def kind_of(plant: Mapping[str, Any], *, follows: bool) -> type[Mechanics]:
    """Return the kind that a table [plant] names, or the likeliest."""
    kinds = plant_kinds(follows)
    return kinds[find_kind(plant, kinds)]


PLANTS = ByKind(plant_kinds, "Form of the plant.")


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineState:
    """The mechanics in one position, or with one payload, at which the machine was measured."""

    name: str
    mechanics: Mechanics


class States:
    """Reader of a table of [[machine_states]]: a name, and the keys of [plant] that differ there.

    A mode is named, with those of its keys that differ.
    """

    def read(self, value: object, place: KeyPath, reading: Reading) -> MachineState | None:
        """Return the state; what is wrong with [plant] itself is noted there."""
        if not isinstance(value, dict):
            reading.refuse(place, must_be(value, Message("a-table")))
            return None
        plant = reading.data.get("plant", {})
        given = value.get("modes", [])
        stated = plant.get("modes", []) if isinstance(plant.get("modes"), list) else []
        names = [mode.get("name") for mode in stated if isinstance(mode, dict)]
        own: dict[int, int] = {}
        for i, mode in enumerate(given if names and isinstance(given, list) else ()):
            if isinstance(mode, dict) and mode.get("name") in names:
                own[names.index(mode["name"])] = i
            else:
                message = Message("state-mode-unknown", names=one_of(tuple(map(str, names))))
                reading.refuse((*place, "modes", i), message)
        whole = {**plant, **{key: one for key, one in value.items() if key != "name"}}
        if names:
            whole["modes"] = [
                {**mode, **given[own[k]]} if k in own else mode for k, mode in enumerate(stated)
            ]
        before = len(reading.faults)
        mechanics = read_table(
            kind_of(whole, follows=reading.follows), whole, place, reading, beside=("kind",)
        )
        found, reading.faults[before:] = reading.faults[before:], []
        for path, message in found:
            key, *below = path[len(place) :]
            if key == "modes" and below and names:
                if below[0] not in own:
                    continue
                below[0] = own[below[0]]
            if key in value:
                reading.refuse((*place, key, *below), message)
        name = Text(LONGEST_NAME).read(value.get("name", ""), (*place, "name"), reading)
        is_right = mechanics is not None and not found and name
        return MachineState(name=name, mechanics=mechanics) if is_right else None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: a name, and any key of a plant."""
        about = {"description": "Name of the state.", "type": "string", "examples": ['"far end"']}
        properties: dict[str, Any] = {}
        for kind in (*KINDS.values(), *HELD.values()):
            properties |= table_schema(kind, tables)["properties"]
        for form in (FlexibleMode, HeldMode):
            key = f"{form.__name__}InState"
            tables[key] = table_schema(form, tables) | {"required": ["name"]}
        modes = [{"$ref": f"#/$defs/{form.__name__}InState"} for form in (FlexibleMode, HeldMode)]
        items = {"type": "array", "items": {"anyOf": modes}}
        properties["modes"] = properties["modes"] | items
        tables["MachineState"] = {
            "type": "object",
            "description": (States.__doc__ or "").partition("\n")[0],
            "properties": {"name": about, **properties},
            "required": ["name"],
            "additionalProperties": False,
        }
        return {"$ref": "#/$defs/MachineState"}
