"""[[moves]]: what the axis is to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

from mtcommission.base.messages.message import Message
from mtcommission.machine import readers as of
from mtcommission.machine.keys import Table, keyed, read_table
from mtcommission.machine.readers import KeyPath, Reading


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityStep:
    """An element of [[moves]]: accelerate from rest to a velocity; the end position is free."""

    velocity_step: float = keyed(
        of.VELOCITIES, "Accelerate from rest to this velocity; the end position is free.", "0.1 m/s"
    )
    dwell: float = keyed(of.DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioning:
    """An element of [[moves]]: move from rest to rest."""

    distance: float = keyed(of.DISTANCES, "Move over this distance from rest to rest.", "20 mm")
    max_velocity: float = keyed(
        of.VELOCITIES, "Velocity limit of a move over a distance.", "0.5 m/s", default=inf
    )
    dwell: float = keyed(of.DWELLS, "Rest after the move.", "0 s", default=0.0)  # for the RMS force


Move = VelocityStep | Positioning


def size_unit(move: Move) -> str:
    """Return the SI unit of what a move is listed by: its velocity step or its distance."""
    return "m/s" if isinstance(move, VelocityStep) else "m"


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
            of.VELOCITIES.read(value["velocity_step"], (*place, "velocity_step"), reading)
        known = {key: one for key, one in value.items() if key != "velocity_step"}
        read_table(kind, {"distance": 1.0, **known}, place, reading, beside=self.keys)
        if len(reading.faults) == before:
            message = Message(f"move-with-{'both' if given else 'neither'}")
            reading.refuse(place, message)
        return None

    def schema(self, tables: dict[str, Any]) -> dict[str, Any]:
        """Return the JSON schema: either form."""
        return {"anyOf": [Table(kind).schema(tables) for kind in self.kinds.values()]}


def peak_velocity(move: Move, acceleration: float) -> float:
    """Return the largest velocity [m/s] of a move under an acceleration limit [m/s²] alone."""
    if isinstance(move, VelocityStep):
        return move.velocity_step
    return min(move.max_velocity, sqrt(acceleration * move.distance))


def least_motion_time(move: Move, acceleration: float) -> float:
    """Return how long a rigid axis needs for a move at this acceleration, without jerk limit [s].

    It is v/a, and for positioning L/v on top, with the largest velocity v that is reached;
    ``acceleration``: a [m/s²], > 0.
    """
    velocity = peak_velocity(move, acceleration)
    cruise = 0.0 if isinstance(move, VelocityStep) else move.distance / velocity
    return velocity / acceleration + cruise
