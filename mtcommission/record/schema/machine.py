"""The machine of a record: its data as the sheet shows them, and its plant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from mtcommission.machine.machine import DriveKind, Motion
from mtcommission.plant.kinds import KINDS
from mtcommission.record.rules import filled, long, named, one_of, short
from mtcommission.record.schema.values import Matrix, Positive, Words, signals_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Datum:
    """One machine datum as the sheet shows it: its key in the profile, value and SI unit."""

    key: str
    value: float | str
    unit: str
    source: Words


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeEntry:
    """A flexible mode of the plant."""

    name: str
    frequency_hz: float
    damping_ratio: float
    tcp_gain: float
    measured_gain: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PlantEntry:
    """The plant: x' = A x + B F_set and its outputs, rows over the states.

    Where the motor follows its setpoint, F is its acceleration and B the column of its jerk.
    """

    states: Annotated[list[str], filled]
    units: Annotated[dict[str, str], named(signals_of), short]
    A: Annotated[Matrix, long("states", "states")]
    B: Annotated[list[float], long("states")]
    outputs: Annotated[dict[str, list[float]], long("", "states")]
    modes: list[ModeEntry]
    controllability_rank: int
    moving_mass: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineEntry:
    """What the machine is called, and where its data come from."""

    name: str
    axis: str
    motion: Annotated[str, one_of(*(motion.value for motion in Motion))]
    source: str
    kind: Annotated[str, one_of(registered=KINDS)]
    drive: Annotated[str, one_of(*(kind.value for kind in DriveKind))] = "servo"

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint."""
        return self.drive != "servo"
