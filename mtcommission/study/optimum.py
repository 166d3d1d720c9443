"""The optimum with a band, beside the loop.

It is the honest lower limit of a recommendation that is judged by a band; the robust force is what
of it remains if frequencies and damping are known to their spread only.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.message import Message
from mtcommission.limits.optima import Optima
from mtcommission.machine.machine import Corner, Machine, moving_mass, vary
from mtcommission.machine.moves import Positioning, least_motion_time
from mtcommission.machine.plant.plant import build_plant, driven_at_once, longest_period
from mtcommission.optimal.band import BandForce, find_band_optimum, find_robust_force
from mtcommission.setpoint.smaller_moves import size_of
from mtcommission.study.settings import BAND

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class WithinBand:
    """The fastest controls of one move to a state from which the tool keeps the band by itself."""

    optimum: BandForce | None = None  # on the nominal machine; None where it was not found
    robust: BandForce | None = None  # on all of the spread, without payload; None: no spread
    remarks: tuple[Message, ...] = ()  # what was left out, and why


def find_within_band(machine: Machine, optima: Optima) -> WithinBand:
    """Return the fastest controls of one move that leave the tool within the permitted deviation.

    ``tcp_deviation`` as stated is the band, without reserve.
    """
    plant, needs, move = build_plant(machine), machine.requirements, optima.move
    size, force, band = size_of(move), machine.drive.motion_force, needs.tcp_deviation
    if isinstance(move, Positioning) and size <= band:
        return WithinBand(remarks=(Message("band-wider-than-move", distance=size, band=band),))
    rigid = least_motion_time(move, force / moving_mass(machine))
    left = 1.0 - rigid / optima.time.t_f
    is_long = optima.time.t_f > BAND.many_periods * longest_period(plant)
    if is_long and left < BAND.worthwhile:
        return WithinBand(remarks=(Message("band-saves-nothing", rigid=rigid, share=left),))
    optimum, robust, failed = None, None, "band-optimum-failed"
    try:
        optimum = find_band_optimum(
            driven_at_once(plant),
            move,
            force_limit=force,
            band=band,
            at_rest=optima.time.t_f,
        )
        failed = "robust-force-failed"
        if needs.frequency_spread or needs.damping_spread:
            places = _over_spread(machine)
            robust = find_robust_force(
                [driven_at_once(build_plant(vary(machine, place))) for place in places],
                move,
                force_limit=force,
                band=band,
                guess=optimum.t_f,
            )
    except ComputationError as error:
        remark = Message(failed, error=error.message)
        return WithinBand(optimum=optimum, remarks=(remark,))
    return WithinBand(optimum=optimum, robust=robust)


def _over_spread(machine: Machine) -> list[Corner]:
    """Machines over the frequency spread, at both ends and the middle of damping, each once."""
    needs = machine.requirements
    frequency = np.linspace(-1.0, 1.0, BAND.checked_frequencies) * needs.frequency_spread
    damping = np.array([-1.0, 0.0, 1.0]) * needs.damping_spread
    pairs = product(dict.fromkeys(damping.tolist()), dict.fromkeys(frequency.tolist()))
    return [Corner(frequency_factor=1.0 + f, damping_factor=1.0 + d) for d, f in pairs]
