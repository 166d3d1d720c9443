"""What is required of a move: one name for each requirement, everywhere."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from mtcommission.machine.machine import Machine, Move, Reserve, VelocityStep
from mtcommission.messages.message import Message


class Kind(Enum):
    """Each kind of requirement, by the name that records give it."""

    RESIDUAL_DEVIATION = "residual deviation"
    SETTLING_TIME = "settling time"
    CONTOUR_DEVIATION = "contour deviation"
    SET_FORCE = "set force"
    RMS_FORCE = "RMS force"
    PEAK = "peak"


@dataclass(frozen=True, slots=True)
class Requirement:
    """One requirement, to be judged, missed, relaxed or printed.

    Parameters
    ----------
    kind
        What is bounded.
    signal
        State or output of the plant, for a peak; else "".
    """

    kind: Kind
    signal: str = ""

    @property
    def value(self) -> str:
        """Name in records, e.g. ``"set force"`` or ``"peak v_phi"``."""
        return f"{self.kind.value} {self.signal}".rstrip()

    def usable_share(self, reserve: Reserve) -> float:
        """Return the share of the limit that recommendations may use [-]."""
        if self.kind is Kind.SETTLING_TIME:
            return 1.0
        is_force = self.kind in (Kind.SET_FORCE, Kind.RMS_FORCE)
        return reserve.force if is_force else reserve.band

    def bound(self, machine: Machine) -> float:
        """Return what a machine allows of it [own unit]."""
        needs, drive = machine.requirements, machine.drive
        match self.kind:
            case Kind.RESIDUAL_DEVIATION:
                return needs.tcp_deviation
            case Kind.CONTOUR_DEVIATION:
                return needs.contour_deviation
            case Kind.SETTLING_TIME:
                return needs.max_settling_time
            case Kind.SET_FORCE:
                return drive.motion_force
            case Kind.RMS_FORCE:
                return drive.continuous_force
            case Kind.PEAK:
                return next(peak.bound for peak in needs.peaks if peak.name == self.signal)

    @property
    def message(self) -> Message:
        """Its text in every language."""
        key = f"requirement-{self.kind.value.lower().replace(' ', '-')}"
        return Message(key, signal=self.signal) if self.signal else Message(key)


RESIDUAL_DEVIATION = Requirement(Kind.RESIDUAL_DEVIATION)
SETTLING_TIME = Requirement(Kind.SETTLING_TIME)
SET_FORCE = Requirement(Kind.SET_FORCE)
RMS_FORCE = Requirement(Kind.RMS_FORCE)
CONTOUR_DEVIATION = Requirement(Kind.CONTOUR_DEVIATION)


def peak_of(signal: str) -> Requirement:
    """Return the requirement on the largest magnitude of a state or output."""
    return Requirement(Kind.PEAK, signal)


def read_requirement(value: str) -> Requirement:
    """Return the requirement of a record's name for it.

    Raises
    ------
    ValueError
        There is no such requirement.

    Examples
    --------
    >>> read_requirement("peak v_phi") == peak_of("v_phi")
    True
    >>> read_requirement("RMS force").message
    Message('requirement-rms-force')
    """
    kind, _, signal = value.partition(" ")
    return peak_of(signal) if kind == "peak" and signal else Requirement(Kind(value))


def slow_to_feed(move: Move, feed: float) -> Move:
    """Return the move as it is where contours are followed: no faster than a feed.

    Parameters
    ----------
    move
        Velocity step or positioning.
    feed
        Largest velocity at which the contour deviation must hold [m/s]; inf: that of the move.

    Returns
    -------
    Move
        The same one where it is not faster.

    Examples
    --------
    >>> slow_to_feed(VelocityStep(velocity_step=0.5), 0.1)
    VelocityStep(velocity_step=0.1, dwell=0.0)
    """
    if isinstance(move, VelocityStep):
        return replace(move, velocity_step=min(move.velocity_step, feed))
    return replace(move, max_velocity=min(move.max_velocity, feed))
