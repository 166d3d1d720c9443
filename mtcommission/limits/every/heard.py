"""What a loop leaves after a step of the jerk, as shares of what is allowed: the corners that lead.

From these echoes every bound at every size follows by superposition (``sizes``, ``families``).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kind import Jerk
from mtcommission.loop.analysis.quantisation import encoder_noise
from mtcommission.loop.batch.echoes import Echoes, less_delayed, listen
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

SAMPLES = 20
"""Samples of an echo per period of what a short ramp leaves: the verdict is exact afterwards."""

COARSEST, FINEST = 1e-3, 0.25e-3
"""Largest and least spacing of samples [s]."""

BETWEEN = 2.5
"""Distance of the ramps that are looked at for one limit, in samples that suffice: the worst of
them changes slowly."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Heard:
    """Echoes of all that is bounded, as shares of what is allowed.

    Parameters
    ----------
    dt, delay
        Spacing of the samples, and τ [s].
    wait
        Sample of ``residual`` and ``path`` that lies at τ.
    between
        Samples between ramps that are looked at for one limit.
    residual, path, moving
        Deviation against band and contour (no rows: none asked for), and force and peaks, shapes
        (n_rows, n_samples) [1 per m/s³].
    """

    dt: float
    delay: float
    wait: int
    between: int
    residual: Array
    path: Array
    moving: Array


def hear(machine: Machine, plant: Plant, tuned: TunedLoop) -> Heard:
    """Return the echoes of all that is bounded, encoder noise taken off.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, whose requirements count as they stand, its plant and its loop.

    Returns
    -------
    Heard
    """
    needs, drive, n = machine.requirements, machine.drive, plant.order
    noises = [encoder_noise(loop, resolution=drive.encoder_resolution) for loop in tuned.loops]
    tool, force = max(item.tool for item in noises), max(item.force for item in noises)
    outputs = np.vstack([np.zeros((3, n)), np.eye(n)])
    rows = [np.eye(n + 3)[2], *(outputs @ plant.row(peak.name) for peak in needs.peaks)]
    allowed = [_left(drive.motion_force, force), *(peak.bound for peak in needs.peaks)]
    echoes = listen(tuned.loops, signals=np.array(rows), spacing=FINEST)
    spacing = _spacing(echoes)
    if machine.control.kind.jerk is Jerk.NONE:  # every ramp lasts one cycle, and is to be seen
        spacing = min(spacing, machine.control.position_cycle)
    every = max(int(min(spacing, COARSEST) / echoes.dt + 1e-9), 1)
    moving = echoes.signals[..., ::every] / np.array(allowed)[None, :, None, None]
    dt = every * echoes.dt
    # The tool is judged from τ on: a sample must lie there, where a servo's tail is largest.
    begin = int(echoes.delay / echoes.dt + 1e-9)
    deviation = echoes.deviation[:, begin % every :: every]
    moving = leading_rows(moving.reshape(-1, moving.shape[-1]), dt)
    residual = deviation / _left(needs.tcp_deviation, tool)
    path = leading_rows(deviation / _left(needs.contour_deviation, tool), dt)
    return Heard(
        dt=dt,
        delay=echoes.delay,
        wait=begin // every,
        between=max(round(BETWEEN * spacing / dt), 1),
        residual=residual,
        path=path if isfinite(needs.contour_deviation) else path[:0],
        moving=moving,
    )


def _spacing(echoes: Echoes) -> float:
    """Spacing of samples that suffices, by how quickly what short ramps leave swings [s]."""
    k = max(round(PROBES[0] / echoes.dt), 1)
    left = less_delayed(echoes.deviation, k)[:, k + int(echoes.delay / echoes.dt) + 1 :]
    bent = np.abs(np.diff(left, 2, axis=1)).max(initial=0.0) / echoes.dt**2
    fastest = np.sqrt(bent / max(np.abs(left).max(initial=0.0), 1e-300)) / (2.0 * np.pi)
    return float(1.0 / (SAMPLES * max(fastest, 1e-3)))


def leading_rows(rows: Array, dt: float) -> Array:
    """Return the rows that can ask for most: of the others no ramp leaves as much.

    Parameters
    ----------
    rows
        Echoes, shape (n_rows, n_samples) [1 per m/s³].
    dt
        Spacing of the samples [s].
    """
    sizes = [np.abs(less_delayed(rows, max(round(t / dt), 1))).max(axis=1) for t in PROBES]
    return rows[np.any([size >= LEADING * size.max() for size in sizes], axis=0)]


def rows_left_vibrating(rows: Array, dt: float, wait: int) -> Array:
    """Return the rows that can ask for most behind a shaper, where others lead than before it.

    One that is faster than the shaper expects swings less far, but is left more of it. Compared
    by what there is after a ramp up and down again: a ramp alone leaves the tool held aside.

    Parameters
    ----------
    rows
        Echoes behind the shaper, shape (n_rows, n_samples) [1 per m/s³].
    dt
        Spacing of the samples [s].
    wait
        Sample from which on the residual counts.
    """
    lags = [max(round(t / dt), 1) for t in PROBES]
    twice = [less_delayed(less_delayed(rows, k), k)[:, wait + 2 * k :] for k in lags]
    sizes = [np.abs(left).max(axis=1, initial=0.0) for left in twice]
    return rows[np.any([size >= LEADING * size.max() for size in sizes], axis=0)]


PROBES = (2e-3, 10e-3, 40e-3)
"""Ramps by which corners are compared [s]."""

LEADING = 0.85
"""Corners that are left less than this share of the worst by every such ramp are not looked at
before the verdict, which looks at all."""


def _left(bound: float, noise: float) -> float:
    """What noise leaves of a bound; hardly anything where that is nothing."""
    return max(bound - noise, 1e-3 * bound)
