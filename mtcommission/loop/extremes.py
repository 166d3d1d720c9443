"""Largest magnitudes of signals while setpoints move, and until all has faded."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.free_motion import Grid, lay_grid
from mtcommission.loop.motions import (
    Motions,
    pieces_of,
    sampled,
    seen,
    set_in_motion,
    signals_at,
    wanted,
)
from mtcommission.loop.poles import LoopPoles, restrict
from mtcommission.setpoint.pieces import Pieces
from mtcommission.setpoint.setpoint import JerkSteps

Array = NDArray[np.float64]
Cycles = NDArray[np.int64]

BETWEEN = 6
"""Cycles looked at between two far steps besides those near them: a polynomial has few extremes."""


def extremes(
    motions: Motions, grid: Grid, rows: Array, *, parts: Cycles, less: int | None = None
) -> Array:
    """Return the largest magnitudes of signals while setpoints move, and on until all has faded.

    ``rows``: over the outputs of a velocity cycle, all less the same derivative of the delayed
    setpoint, see ``Signal``; ``parts``: the velocity cycles of a position cycle that are looked at.
    Shape (n_setpoints, n_corners, n_rows).
    """
    poles, first, pieces = motions.poles, motions.first, pieces_of(motions)
    count, steps = first.shape
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.forced)
    begun = np.arange(poles.forced)
    later = np.linspace(0.0, 1.0, BETWEEN + 1)[1:]
    later = (np.maximum(gaps - 1, 0)[..., None] * later).astype(np.int64)
    ages = np.concatenate([np.broadcast_to(begun, (*gaps.shape, len(begun))), later], axis=2)
    own = np.concatenate([begun < gaps[..., None], later >= poles.forced], axis=2)
    setpoint, _, _ = np.nonzero(own)
    at = (first[:, :, None] + ages)[own]
    found = signals_at(motions, pieces, setpoint, at, rows, parts)
    if less is not None:
        t = at[:, None] * poles.dt + poles.velocity_cycle * parts - poles.delay
        found -= wanted(pieces, np.repeat(setpoint, len(parts)), t, less)[:, None, :, None]
    largest = np.zeros((count, len(poles.loops), len(rows)))
    each = np.abs(found).max(axis=2)
    begins = np.flatnonzero(np.diff(setpoint, prepend=-1))
    largest[setpoint[begins]] = np.maximum.reduceat(each, begins, axis=0)
    if poles.factors.size:
        gaps[:, -1] = poles.forced + grid.cycle[-1] + 1
        for part in (slice(0, steps - 1), slice(steps - 1, steps)):
            place, j = np.nonzero(gaps[:, part] > poles.forced)
            if len(place):
                j = j + (part.start or 0)
                _note_far(motions, pieces, grid, rows, largest, place, j, gaps, less)
    return largest


def _note_far(
    motions: Motions,
    pieces: Pieces,
    grid: Grid,
    signals: Array,
    largest: Array,
    own: Cycles,
    j: Cycles,
    gaps: Cycles,
    less: int | None,
) -> None:
    """Add what the poles alone tell of, from ``forced`` cycles after some steps to their next."""
    poles, q = motions.poles, motions.order
    left = gaps[own, j] - poles.forced
    used = int(np.searchsorted(grid.cycle, left.max()))
    cycle, part, R = grid.cycle[:used], grid.part[:used], len(signals)
    shapes = (signals @ poles.shapes)[:, part] * grid.faded[:used].transpose(1, 0, 2)[:, :, None]
    found = seen(motions.held[j, own], shapes.reshape(len(shapes), used * R, -1))
    at = motions.first[own, j, None] + poles.forced + cycle
    x = sampled(pieces, np.repeat(own, used), np.asarray(at.ravel() * poles.dt), q + 1)
    steady = (signals @ poles.steady[..., : q + 1])[:, part]  # (n_corners, used, R, q + 1)
    found = found.reshape(len(own), -1, used, R)
    found += np.einsum("kst,ctrk->sctr", x.reshape(q + 1, *at.shape), steady, optimize=True)
    if less is not None:
        t = at * poles.dt + part * poles.velocity_cycle - poles.delay
        found -= wanted(pieces, np.repeat(own, used), t, less)[:, None, :, None]
    np.abs(found, out=found)
    found *= (cycle < left[:, None])[:, None, :, None]
    np.maximum.at(largest, own, found.max(axis=2, initial=0.0))


def where_signals_lead(poles: LoopPoles, signals: Array) -> tuple[LoopPoles, Cycles]:
    """Return corners, and velocity cycles in a position cycle, in which signals swing furthest.

    Compared by moves of ``RAMPS``; a corner counts that comes within half a per cent.
    """
    return _find_leading(poles, signals.shape, signals.tobytes())


@lru_cache(maxsize=16)
def _find_leading(
    poles: LoopPoles, shape: tuple[int, ...], signal_bytes: bytes
) -> tuple[LoopPoles, Cycles]:
    """Once for all limits that are judged on a loop."""
    signals = np.frombuffer(signal_bytes).reshape(shape)
    t = np.array(RAMPS)
    steps = JerkSteps(
        times=np.column_stack([np.zeros_like(t), t, 1.5 * t, 2.5 * t]),
        steps=np.tile([1.0, -1.0, -1.0, 1.0], (len(t), 1)),
    )
    motions, grid = set_in_motion(poles, steps), lay_grid(poles, 12)
    each = [extremes(motions, grid, signals, parts=np.array([i])) for i in range(poles.cycles)]
    peaks = np.array(each)  # (cycles, n_setpoints, n_corners, n_signals)
    parts = np.unique(peaks.max(axis=2).argmax(axis=0))
    by_corner = peaks.max(axis=0)
    leads = by_corner >= LEADS * by_corner.max(axis=1, keepdims=True)
    return restrict(poles, np.flatnonzero(leads.any(axis=(0, 2))).tolist()), parts


RAMPS = (2e-3, 10e-3, 40e-3, 150e-3)
"""By which poles, corners and velocity cycles are compared [s]."""

LEADS = 0.995
"""A corner leads if it comes within this share of the worst [-]."""
