"""The machine of a record: its data as the sheet shows them, and its plant."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import Words


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

    states: list[str]
    units: dict[str, str]
    A: list[list[float]]
    B: list[float]
    outputs: dict[str, list[float]]
    modes: list[ModeEntry]
    controllability_rank: int
    moving_mass: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MachineEntry:
    """What the machine is called, and where its data come from.

    ``drive`` is ``servo``, or ``position_source`` where the motor follows its setpoint.
    """

    name: str
    axis: str
    motion: str
    source: str
    kind: str
    drive: str = "servo"

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint."""
        return self.drive != "servo"
