"""How fast a move can be at all if a band, not exact rest, is asked for: on one machine, on all.

The optimum with the band is the honest lower limit of a recommendation that is judged by it; the
robust force is what of it remains if frequencies and damping are known to their spread only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TypeVar

import numpy as np

from mtcommission.errors import ComputationError
from mtcommission.limits.optima import Optima
from mtcommission.machine.machine import Machine, Positioning, moving_mass
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.machine.variations import Corner, vary
from mtcommission.messages.message import Message
from mtcommission.optimal.band.band_optimum import BandOptimum, find_band_optimum
from mtcommission.optimal.band.robust import RobustForce, find_robust_force
from mtcommission.optimal.band.settings import BandSettings
from mtcommission.plant.plant import Plant, build_plant, driven_at_once, longest_period
from mtcommission.setpoint.smaller_moves import size_of

Found = TypeVar("Found")


@dataclass(frozen=True, slots=True, kw_only=True)
class WithinBand:
    """The fastest controls of one move to a state from which the tool keeps the band by itself."""

    optimum: BandOptimum | None  # on the nominal machine; None where it was not found
    robust: RobustForce | None  # on all machines of the spread, without payload; None: no spread
    remarks: tuple[Message, ...]  # what was left out, and why


def find_within_band(
    machine: Machine, plant: Plant, optima: Optima, *, settings: BandSettings
) -> WithinBand:
    """Return the fastest controls of one move that leave the tool within the permitted deviation.

    ``tcp_deviation`` as stated is the band, without reserve.
    """
    size, needs = size_of(optima.move), machine.requirements
    if isinstance(optima.move, Positioning) and size <= needs.tcp_deviation:
        remark = Message("band-wider-than-move", distance=size, band=needs.tcp_deviation)
        return WithinBand(optimum=None, robust=None, remarks=(remark,))
    force, band = machine.drive.motion_force, needs.tcp_deviation
    rigid = least_motion_time(optima.move, force / moving_mass(machine))
    left = 1.0 - rigid / optima.time.t_f
    is_long = optima.time.t_f > settings.many_periods * longest_period(plant)
    if is_long and left < settings.worthwhile:
        remark = Message("band-saves-nothing", rigid=rigid, share=left)
        return WithinBand(optimum=None, robust=None, remarks=(remark,))
    remarks: list[Message] = []
    found = _tried(
        lambda: find_band_optimum(
            driven_at_once(plant),
            optima.move,
            force_limit=force,
            band=band,
            at_rest=optima.time.t_f,
            settings=settings,
        ),
        "band-optimum-failed",
        remarks,
    )
    if found is None or not (needs.frequency_spread or needs.damping_spread):
        return WithinBand(optimum=found, robust=None, remarks=tuple(remarks))
    places = spread_places(machine, settings)
    robust = _tried(
        lambda: find_robust_force(
            [driven_at_once(build_plant(vary(machine, place))) for place in places],
            optima.move,
            force_limit=force,
            band=band,
            first=range(0, len(places), max((len(places) - 1) // (settings.frequencies - 1), 1)),
            guess=found.force.t_f,
            settings=settings,
        ),
        "robust-force-failed",
        remarks,
    )
    return WithinBand(optimum=found, robust=robust, remarks=tuple(remarks))


def spread_places(machine: Machine, settings: BandSettings) -> list[Corner]:
    """Return machines over the frequency spread, at both ends and the middle of damping.

    Without payload, each once.
    """
    needs = machine.requirements
    frequency = np.linspace(-1.0, 1.0, settings.checked_frequencies) * needs.frequency_spread
    damping = np.array([-1.0, 0.0, 1.0]) * needs.damping_spread
    pairs = product(dict.fromkeys(damping.tolist()), dict.fromkeys(frequency.tolist()))
    return [Corner(frequency_factor=1.0 + f, damping_factor=1.0 + d) for d, f in pairs]


def _tried(find: Callable[[], Found], kind: str, remarks: list[Message]) -> Found | None:
    """Return what is found, or None and a remark that tells why not."""
    try:
        return find()
    except ComputationError as error:
        remarks.append(Message(kind, error=error.message))
        return None
