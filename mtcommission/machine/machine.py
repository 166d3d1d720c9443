"""A machine axis as its data sheet tells it: frozen, SI, without files or solvers.

On a rotary axis inertia stands for mass, torque for force and rad for m; the equations
are the same, so the field names stay those of the linear axis.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from math import inf

from mtcommission.machine.control import Control, Today
from mtcommission.machine.identified import Identification
from mtcommission.machine.keys import keyed
from mtcommission.machine.mechanics import Mechanics
from mtcommission.machine.ranges import BANDS, TIMES, VELOCITIES
from mtcommission.units.axis_units import (
    LINEAR,
    LINEAR_SOURCE,
    ROTARY,
    ROTARY_SOURCE,
    AxisUnits,
)


class Motion(Enum):
    """What the axis does: its units follow from it."""

    LINEAR = "linear"
    ROTARY = "rotary"


class DriveKind(Enum):
    """How the motor moves the axis."""

    SERVO = "servo"
    POSITION_SOURCE = "position_source"


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """The motor as the axis feels it.

    A position source follows its setpoint whatever force that takes. What drives the plant is
    then its acceleration: that stands for every force here, in m/s², and the moving mass is 1.
    """

    kind: DriveKind = DriveKind.SERVO  # a force behind a loop, or a motor that simply follows
    force_lag: float  # time constant T of the force loop [s]; 0 of a position source
    max_force: float  # F_max [N]
    max_velocity: float = inf  # of a position source, by step rate or torque [m/s]; inf: none
    force_velocity: float | None = None
    """Velocity at which ``max_force`` was read off the motor's curve [m/s]; None: it was stated."""
    continuous_force: float = inf  # thermal (RMS) limit over move and dwell [N]; inf: not given
    static_load: float = 0.0  # weight or process force [N]; its amount is not available for motion
    coulomb_friction: float = 0.0  # of the guides, on the line of the drive [N]; 0: not stated
    viscous_friction: float = 0.0  # likewise [N s/m]; 0: not stated
    lead: float | None = None
    """Travel of a linear axis per turn of the screw or pinion [m]; None: a linear motor, a rotary
    axis, or not stated."""
    gear: float = 1.0  # turns of the motor per turn of the screw, the pinion or the rotary axis [-]
    encoder_resolution: float = 0.0  # smallest step of the measured position [m]; 0: not stated

    @property
    def follows(self) -> bool:
        """Whether the motor follows its setpoint: a position source, without a loop to tune."""
        return self.kind is DriveKind.POSITION_SOURCE

    @property
    def motion_force(self) -> float:
        """Force left for motion, max_force - |static_load| - coulomb_friction [N]."""
        return self.usable_force - self.coulomb_friction

    @property
    def usable_force(self) -> float:
        """Force left for motion and friction, max_force - |static_load| [N]."""
        return self.max_force - abs(self.static_load)

    @property
    def has_friction(self) -> bool:
        """Whether any friction was stated."""
        return self.coulomb_friction > 0.0 or self.viscous_friction > 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityStep:
    """Accelerate from rest to a velocity; the end position is free."""

    velocity_step: float  # velocity at the end [m/s], > 0
    dwell: float = 0.0  # rest after the move, for the RMS force [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioning:
    """Move from rest to rest."""

    distance: float  # length of the move [m], > 0
    max_velocity: float = inf  # velocity limit [m/s]; inf: none was given
    dwell: float = 0.0  # rest after the move, for the RMS force [s]


Move = VelocityStep | Positioning


@dataclass(frozen=True, slots=True, kw_only=True)
class Peak:
    """A bound on a state or output over the whole closed-loop response."""

    name: str  # state or output of the plant, e.g. ``v_phi``
    bound: float  # largest allowed magnitude, in the SI unit of that signal


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Allowed residual deviation (the band) in each machining mode [m]."""

    surface: float  # for finishing
    accuracy: float  # for contour accuracy
    speed: float  # for roughing


@dataclass(frozen=True, slots=True, kw_only=True)
class Reserve:
    """Share of what is allowed that recommendations may use; given limits may use all of it."""

    band: float = 0.8  # of band, contour and peaks [-]
    force: float = 0.95  # of the set force and of the RMS force [-]


NO_RESERVE = Reserve(band=1.0, force=1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Requirements:
    """What the axis must achieve, in every corner; inf: not asked for.

    Fields with a key stand in the profile as they are.
    """

    tcp_deviation: float = keyed(
        BANDS, "Half width of the band about the delayed setpoint.", "5 um"
    )
    max_settling_time: float = keyed(TIMES, "Longest settling time.", "0.2 s", default=inf)
    contour_deviation: float = keyed(
        BANDS,
        "Allowed deviation from the delayed setpoint during the whole move.",
        "20 um",
        default=inf,
    )
    contour_feed: float = keyed(
        VELOCITIES,
        "Largest velocity at which the contour must be kept; left out: that of each move.",
        "2 m/min",
        default=inf,
    )
    modes: Modes  # bands of the three machining modes
    reserve: Reserve = NO_RESERVE  # share of band and force that recommendations may use
    frequency_spread: float = 0.0  # relative uncertainty of all eigenfrequencies [-]
    damping_spread: float = 0.0  # likewise of all damping ratios [-]
    every_size: bool = False  # whether all but the time must hold for every smaller move, too
    payload: tuple[float, float] = (0.0, 0.0)  # least and largest [kg]
    payload_radius: float = 0.0
    """Radius of gyration of the payload about the rotary joint [m]; 0 leaves the inertia alone."""
    peaks: tuple[Peak, ...] = ()  # bounds on states and outputs


@dataclass(frozen=True, slots=True, kw_only=True)
class Weight:
    """Weight of one squared state in the damping functional, eq. (5)."""

    state: str
    value: float  # c_i [N² per squared unit of the state]


@dataclass(frozen=True, slots=True, kw_only=True)
class DampingOptimal:
    """Settings of the damping-optimal control."""

    t_f: float | None = None
    """Final time [s]; None: that of the constrained optimum where there are peaks, else 1.2 x
    t_f,min."""
    weights: tuple[Weight, ...] = ()  # explicit weights; empty means "balanced"


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """One axis: mechanics, drive, moves, requirements and control."""

    name: str  # for the sheet, like axis and source
    axis: str
    source: str  # where the numbers come from
    mechanics: Mechanics  # the plant, of any kind
    drive: Drive
    moves: tuple[Move, ...]
    requirements: Requirements
    motion: Motion = Motion.LINEAR
    damping_optimal: DampingOptimal = field(default_factory=DampingOptimal)
    control: Control = field(default_factory=Control)
    today: Today | None = None
    illustrative: bool = False  # whether the numbers are plausible, not those of a real machine
    assumed: tuple[str, ...] = ()
    """Keys and tables of the profile whose values nobody stated or measured, spelt as in messages,
    e.g. ``plant.modes[1].damping_ratio``."""
    identified: Identification | None = None  # what was measured; None: numbers from elsewhere

    def is_assumed(self, key: str) -> bool:
        """Return whether a key, or a table that holds it, is one of ``assumed``."""
        return any(key == one or key.startswith((f"{one}.", f"{one}[")) for one in self.assumed)

    @property
    def axis_units(self) -> AxisUnits:
        """What masses, forces and lengths are on this axis."""
        if self.drive.follows:
            return ROTARY_SOURCE if self.motion is Motion.ROTARY else LINEAR_SOURCE
        return ROTARY if self.motion is Motion.ROTARY else LINEAR


def moving_mass(machine: Machine) -> float:
    """Return the rigid mass that the drive accelerates [kg]."""
    return machine.mechanics.moving_mass


def heaviest_mass(machine: Machine) -> float:
    """Return the same with the largest payload [kg]."""
    return moving_mass(machine) + max(machine.requirements.payload)


def practical_ceiling(machine: Machine) -> float:
    """Return what the control's kind is given at most, assumed [m/s²]; inf: no such bound."""
    is_linear = machine.motion is Motion.LINEAR
    return machine.control.kind.largest_acceleration if is_linear else inf


def largest_acceleration(machine: Machine) -> float:
    """Return the largest acceleration that is looked at: by force, and by practical ceiling."""
    return min(machine.drive.motion_force / moving_mass(machine), practical_ceiling(machine))


def mid_payload(machine: Machine) -> float:
    """Return the middle of the payload range [kg]."""
    return 0.5 * sum(machine.requirements.payload)
