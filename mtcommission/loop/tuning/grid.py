"""The loop in every corner on one grid of frequencies, affine in its gains: margins of many gains.

Cut at F_set the loop is L = Kp (P + I/Tn) + Kp Kv (C + D/Tn) + K-terms, with P, I, C and D fixed by
plant, cycles and filters. They are read off the one definition of the open loop, at four settings
of the gains; filters of the set force multiply them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.frequency import (
    BlockResponses,
    open_loop,
    scan,
    scan_blocks_on_grid,
)
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.loop.tuning.tuned import CornerPlants, TuningSettings
from mtcommission.machine.control import ForceFilter

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True, eq=False)
class GainGrid:
    """A controller's loop in every corner over frequency, for any gains."""

    scanned: tuple[BlockResponses, ...]  # plant and observer, in each corner
    terms: Complex  # P, I, C and D of all corners one after the other, (4, n)

    def with_filters(self, filters: Sequence[ForceFilter], velocity_cycle: float) -> GainGrid:
        """Return the same behind more filters of the set force (bilinear, so exact)."""
        z, terms = np.concatenate([known.z for known in self.scanned]), self.terms
        s = 2.0 / velocity_cycle * (z - 1.0) / (z + 1.0)
        for item in filters:
            numerator, denominator = filter_polynomials(item)
            terms = terms * np.polyval(numerator, s) / np.polyval(denominator, s)
        return GainGrid(scanned=self.scanned, terms=terms)

    def open_loop(self, controller: Controller) -> Complex:
        """Return L of all corners one after the other, shape (n,)."""
        Kp, Tn, Kv = controller.velocity_gain, controller.integral_time, controller.position_gain
        P, I, C, D = self.terms  # noqa: E741
        L = Kp * (P + I / Tn + Kv * (C + D / Tn))
        if controller.state_gains.any():
            L = L + _read(replace(controller, velocity_gain=0.0), self.scanned)
        return np.asarray(L)

    def keeps_margins(self, controller: Controller, *, settings: TuningSettings) -> bool:
        """Return whether a controller keeps the margins in every corner, as far as the grid tells.

        Stability by the turns of 1 + L about the origin (Nyquist): three quarters for the three
        integrators of plant, velocity and position loop, where nothing else stands on the unit
        circle.
        """
        L, inside = self.open_loop(controller), self._inside
        away = 1.0 + L
        if np.abs(away).min() * settings.sensitivity_peak < 1.0:
            return False
        size = np.abs(L) - 1.0
        crossing = np.flatnonzero((size[:-1] * size[1:] < 0.0) & inside)
        share = size[crossing] / (size[crossing] - size[crossing + 1])
        at = L[crossing] + share * (L[crossing + 1] - L[crossing])
        least = 2.0 * sin(0.5 * radians(settings.phase_margin_deg))
        if np.any(np.abs(1.0 + at / np.abs(at)) < least):
            return False
        turns = np.angle(away[1:] / away[:-1]) * inside
        turned = np.add.reduceat(np.append(turns, 0.0), self._begins)
        return bool(np.all((np.abs(turned - 1.5 * pi) <= pi) | ~self._is_damped))

    def stiffness(self, controller: Controller) -> float:
        """Return the dynamic stiffness in the worst corner, on the grid [N/m]."""
        each = [np.abs(scan(controller, known).compliance).max() for known in self.scanned]
        return float(1.0 / max(each))

    def weakest_hz(self, controller: Controller) -> float:
        """Return where the sensitivity peaks in the worst corner [Hz]."""
        omega = np.concatenate([known.omega for known in self.scanned])
        return float(omega[np.abs(1.0 + self.open_loop(controller)).argmin()] / (2.0 * pi))

    @cached_property
    def _begins(self) -> NDArray[np.int64]:
        """First frequency of each corner."""
        return np.cumsum([0, *(len(known.z) for known in self.scanned[:-1])])

    @cached_property
    def _inside(self) -> NDArray[np.bool_]:
        """Whether a frequency and the next one are of the same corner."""
        inside = np.ones(self.terms.shape[1] - 1, dtype=bool)
        inside[self._begins[1:] - 1] = False
        return inside

    @cached_property
    def _is_damped(self) -> NDArray[np.bool_]:
        return np.array([known.is_damped for known in self.scanned])


def lay_gain_grid(bench: CornerPlants, controller: Controller) -> GainGrid:
    """Return the loops of all controllers with the same cycles, filters, sensors and observer."""
    scanned = tuple(scan_blocks_on_grid(plant, controller) for plant in bench.plants)
    bare = replace(controller, velocity_gain=1.0, state_gains=0.0 * controller.state_gains)

    def with_gains(integral_time: float, position_gain: float) -> Complex:
        own = replace(bare, integral_time=integral_time, position_gain=position_gain)
        return _read(own, scanned)

    P = with_gains(inf, 0.0)
    both = with_gains(1.0, 0.0), with_gains(inf, 1.0)
    I, C = both[0] - P, both[1] - P  # noqa: E741
    return GainGrid(scanned=scanned, terms=np.array([P, I, C, with_gains(1.0, 1.0) - P - I - C]))


def _read(controller: Controller, scanned: Sequence[BlockResponses]) -> Complex:
    return np.concatenate([open_loop(controller, known).whole for known in scanned])
