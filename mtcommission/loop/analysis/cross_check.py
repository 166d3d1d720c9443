"""What python-control says of a loop that it has put together from the same blocks."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi

import control
import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.analysis.analysis import DEAD_TIME_RADIUS
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.loop.model.diagram import build_lifted_model, build_open_loop

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class CrossCheck:
    """Poles and margins of the block diagram."""

    pole_difference: float  # largest distance of one of our poles from theirs, z plane [-]
    gain_margin_db: float  # inf without a crossing
    phase_margin_deg: float  # inf without a crossing


def check_by_blocks(loop: SampledLoop, frequency_hz: Array) -> CrossCheck:
    """Return what the block diagram says of the nominal loop; margins on the same frequencies."""
    plant, controller = loop.plant, loop.controller
    whole = build_lifted_model(plant, controller, model=plant)
    ours, theirs = np.linalg.eigvals(loop.lifted.A), np.linalg.eigvals(whole.A)
    alive = ours[np.abs(ours) > DEAD_TIME_RADIUS]  # several dead times are one defective pole
    omega = 2.0 * pi * frequency_hz
    cut = build_open_loop(plant, controller)(np.exp(1j * omega * controller.velocity_cycle))
    gains, phases, *_ = control.stability_margins(
        control.frd(cut, omega, smooth=True), returnall=True
    )
    return CrossCheck(
        pole_difference=float(np.max(np.min(np.abs(alive[:, None] - theirs), axis=1))),
        gain_margin_db=float(np.min(np.abs(20.0 * np.log10(gains)), initial=inf)),
        phase_margin_deg=float(np.min(np.abs(phases), initial=inf)),
    )
