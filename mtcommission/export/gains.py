"""Gains as a control takes them: rounded to the safe side, and judged as rounded."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.export.rounding import round_down, round_up_digits
from mtcommission.export.subject import Gains, Subject


@dataclass(frozen=True, slots=True, kw_only=True)
class GainUnits:
    """Units of the gains that are exported with the limits, in SI; 0 for those that are not.

    Parameters
    ----------
    position
        Of Kv [1/s].
    velocity
        Of Kp [N s/m].
    integral_time
        Of Tn [s].
    is_whole
        Whether the control takes Kv as a whole number only.
    """

    position: float = 0.0
    velocity: float = 0.0
    integral_time: float = 0.0
    is_whole: bool = False


NO_GAINS = GainUnits()
"""For controls that take their gains elsewhere."""


def round_gains(subject: Subject, units: GainUnits) -> Gains:
    """Return the gains of the record as they are typed: Kv and Kp down, Tn up, in SI.

    Less gain and a slower integrator keep more phase margin; gains that are not exported stay
    as they are.

    Parameters
    ----------
    subject
        The axis.
    units
        Of the control; 0 where it does not take a gain.

    Returns
    -------
    Gains
        Kv [1/s], Kp [N s/m or N m s/rad], Tn [s].
    """
    loop = subject.record.loop
    kv, kp, tn = loop.Kv, loop.Kp, loop.Tn
    if units.position:
        number = round_down(kv / units.position, is_whole=units.is_whole)
        kv = float(number) * units.position if number else kv
    if units.velocity:
        kp = float(round_down(kp / units.velocity)) * units.velocity
    if units.integral_time:
        tn = float(round_up_digits(tn / units.integral_time)) * units.integral_time
    return Gains(position=kv, velocity=kp, integral_time=tn)
