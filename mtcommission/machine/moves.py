"""[[moves]]: what the axis is to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.machine.keys import Table, keyed, read_table
from mtcommission.machine.ranges import DISTANCES, DWELLS, VELOCITIES
from mtcommission.machine.readers import KeyPath, Reading


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityStep:
    """An element of [[moves]]: accelerate from rest to a velocity; the end position is free."""

    velocity_step: float = keyed(
        VELOCITIES, "Accelerate from rest to this velocity; the end position is free.", "0.1 m/s"
    )
    dwell: float = keyed(DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioning:
    """An element of [[moves]]: move from rest to rest."""

    distance: float = keyed(DISTANCES, "Move over this distance from rest to rest.", "20 mm")
    max_velocity: float = keyed(
        VELOCITIES, "Velocity limit of a move over a distance.", "0.5 m/s", default=inf
    )
    dwell: float = keyed(DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


Move = VelocityStep | Positioning


def largest_velocity(move: Move) -> float:
    """Return the velocity that a move reaches at most, as stated [m/s]; inf: it states none."""
    return move.velocity_step if isinstance(move, VelocityStep) else move.max_velocity


class MoveReader:
    """Reader of one move: a step of the velocity, or a distance."""

    kinds: Mapping[str, type[Any]] = {"velocity_step": VelocityStep, "distance": Positioning}
    keys = (*kinds, "max_velocity")

    def read(self, value: object, place: KeyPath, reading: Reading) -> Any:
        """Return the move."""
        given = [key for key in self.kinds if key in value] if isinstance(value, dict) else []
        kind = self.kinds[given[-1]] if given else Positioning
        if not isinstance(value, dict) or len(given) == 1:
            if isinstance(value, dict) and kind is VelocityStep and "max_velocity" in value:
                message = Message("max-velocity-without-distance")
                reading.refuse((*place, "max_velocity"), message)
            return read_table(kind, value, place, reading, beside=self.keys)
        before = len(reading.faults)
        if given:
            VELOCITIES.read(value["velocity_step"], (*place, "velocity_step"), reading)
        known = {key: one for key, one in value.items() if key != "velocity_step"}
        read_table(kind, {"distance": 1.0, **known}, place, reading, beside=self.keys)
        if len(reading.faults) == before:
            message = Message(f"move-with-{'both' if given else 'neither'}")
            reading.refuse(place, message)
        return None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: either form."""
        return {"anyOf": [Table(kind).schema(tables) for kind in self.kinds.values()]}
