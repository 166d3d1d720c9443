"""What masses, forces and lengths are on an axis: a mass on a linear one, an inertia on a rotary.

The one place that pairs the quantities of the two kinds of axis; units of messages follow from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from mtcommission.base.units import quantities as of


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisUnits:
    """The quantities of one kind of axis, named as on the linear one."""

    mass: of.Dimension  # what is moved
    force: of.Dimension  # what moves it
    length: of.Dimension
    velocity: of.Dimension
    acceleration: of.Dimension
    jerk: of.Dimension
    stiffness: of.Dimension  # of a spring in the drive train
    damping: of.Dimension  # likewise; the velocity gain Kp is one, too
    gain: of.Dimension  # share of a mode in a position, per mass
    modal_deflection: of.Dimension  # state q of q'' + 2 ζ ω q' + ω² q = F
    modal_rate: of.Dimension  # its rate


_PAIRS = {
    "mass": (of.MASS, of.INERTIA),
    "force": (of.FORCE, of.TORQUE),
    "length": (of.LENGTH, of.ANGLE),
    "velocity": (of.VELOCITY, of.ANGULAR_VELOCITY),
    "acceleration": (of.ACCELERATION, of.ANGULAR_ACCELERATION),
    "jerk": (of.JERK, of.ANGULAR_JERK),
    "stiffness": (of.STIFFNESS, of.ROTARY_STIFFNESS),
    "damping": (of.DAMPING, of.ROTARY_DAMPING),
    "gain": (of.PER_MASS, of.PER_INERTIA),
    "modal_deflection": (of.MODAL_DEFLECTION, of.ROTARY_MODAL_DEFLECTION),
    "modal_rate": (of.MODAL_RATE, of.ROTARY_MODAL_RATE),
}
LINEAR, ROTARY = (AxisUnits(**{name: pair[i] for name, pair in _PAIRS.items()}) for i in (0, 1))


def of_position_source(axis: AxisUnits) -> AxisUnits:
    """Return what the same axis measures where the motor follows its setpoint.

    The plant is then driven by the acceleration of the motor: that stands for the force, on a
    mass of 1, and the modes deflect by q'' + 2 ζ ω q' + ω² q = -x_ref'' as lengths.
    """
    return replace(
        axis,
        mass=of.RATIO,
        force=axis.acceleration,
        gain=of.RATIO,
        modal_deflection=axis.length,
        modal_rate=axis.velocity,
    )


LINEAR_SOURCE, ROTARY_SOURCE = of_position_source(LINEAR), of_position_source(ROTARY)
