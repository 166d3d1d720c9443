"""What masses, forces and lengths are on an axis: a mass on a linear one, an inertia on a rotary.

The one place that pairs the quantities of the two kinds of axis; units of messages follow from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from mtcommission.units.quantities import (
    ACCELERATION,
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_JERK,
    ANGULAR_VELOCITY,
    DAMPING,
    FORCE,
    INERTIA,
    JERK,
    LENGTH,
    MASS,
    MODAL_DEFLECTION,
    MODAL_RATE,
    PER_INERTIA,
    PER_MASS,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_MODAL_DEFLECTION,
    ROTARY_MODAL_RATE,
    ROTARY_STIFFNESS,
    STIFFNESS,
    TORQUE,
    VELOCITY,
    Dimension,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisUnits:
    """The quantities of one kind of axis, named as on the linear one."""

    mass: Dimension  # what is moved
    force: Dimension  # what moves it
    length: Dimension
    velocity: Dimension
    acceleration: Dimension
    jerk: Dimension
    stiffness: Dimension  # of a spring in the drive train
    damping: Dimension  # likewise; the velocity gain Kp is one, too
    gain: Dimension  # share of a mode in a position, per mass
    modal_deflection: Dimension  # state q of q'' + 2 ζ ω q' + ω² q = F
    modal_rate: Dimension  # its rate


LINEAR = AxisUnits(
    mass=MASS,
    force=FORCE,
    length=LENGTH,
    velocity=VELOCITY,
    acceleration=ACCELERATION,
    jerk=JERK,
    stiffness=STIFFNESS,
    damping=DAMPING,
    gain=PER_MASS,
    modal_deflection=MODAL_DEFLECTION,
    modal_rate=MODAL_RATE,
)
ROTARY = AxisUnits(
    mass=INERTIA,
    force=TORQUE,
    length=ANGLE,
    velocity=ANGULAR_VELOCITY,
    acceleration=ANGULAR_ACCELERATION,
    jerk=ANGULAR_JERK,
    stiffness=ROTARY_STIFFNESS,
    damping=ROTARY_DAMPING,
    gain=PER_INERTIA,
    modal_deflection=ROTARY_MODAL_DEFLECTION,
    modal_rate=ROTARY_MODAL_RATE,
)


def of_position_source(axis: AxisUnits) -> AxisUnits:
    """Return what the same axis measures where the motor follows its setpoint.

    The plant is then driven by the acceleration of the motor: that stands for the force, on a
    mass of 1, and the modes deflect by q'' + 2 ζ ω q' + ω² q = -x_ref'' as lengths.
    """
    return replace(
        axis,
        mass=RATIO,
        force=axis.acceleration,
        gain=RATIO,
        modal_deflection=axis.length,
        modal_rate=axis.velocity,
    )


LINEAR_SOURCE, ROTARY_SOURCE = of_position_source(LINEAR), of_position_source(ROTARY)
