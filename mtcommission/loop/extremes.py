"""Largest magnitudes of signals while setpoints move, and until all has faded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.free_motion import Grid, lay_grid, shapes_on
from mtcommission.loop.motions import (
    Motions,
    pieces_of,
    seen,
    set_in_motion,
    signals_at,
    wanted,
)
from mtcommission.loop.poles import LoopPoles, once_for_rows, restrict
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
    pieces = pieces_of(motions)
    near = _near_steps(motions, pieces, rows, parts, less).max(axis=2)
    far = _far_from_steps(motions, pieces, grid, rows, less)
    return np.asarray(np.maximum(near, far))


def _near_steps(
    motions: Motions, pieces: Pieces, rows: Array, parts: Cycles, less: int | None
) -> Array:
    """Largest in the cycles after each step, and in some until the next one.

    Shape (n_setpoints, n_corners, n_parts, n_rows).
    """
    poles, first = motions.poles, motions.first
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.recent)
    begun = np.arange(poles.recent)
    later = np.linspace(0.0, 1.0, BETWEEN + 1)[1:]
    later = (np.maximum(gaps - 1, 0)[..., None] * later).astype(np.int64)
    ages = np.concatenate([np.broadcast_to(begun, (*gaps.shape, len(begun))), later], axis=2)
    own = np.concatenate([begun < gaps[..., None], later >= poles.recent], axis=2)
    setpoint, _, _ = np.nonzero(own)
    at = (first[:, :, None] + ages)[own]
    found = signals_at(motions, pieces, setpoint, at, rows, parts)
    if less is not None:
        t = at[:, None] * poles.dt + poles.velocity_cycle * parts - poles.delay
        found -= wanted(pieces, np.repeat(setpoint, len(parts)), t, less)[:, None, :, None]
    largest = np.zeros((len(first), *found.shape[1:]))
    begins = np.flatnonzero(np.diff(setpoint, prepend=-1))
    largest[setpoint[begins]] = np.maximum.reduceat(np.abs(found), begins, axis=0)
    return largest


def _far_from_steps(
    motions: Motions, pieces: Pieces, grid: Grid, rows: Array, less: int | None
) -> Array:
    """Largest of what the poles alone tell of, from ``recent`` cycles after steps to their next.

    At the instants of the grid, in any velocity cycle; shape (n_setpoints, n_corners, n_rows).
    """
    poles, first, q, R = motions.poles, motions.first, motions.order, len(rows)
    largest = np.zeros((len(first), len(poles.loops), R))
    if not poles.factors.size:
        return largest
    shapes = shapes_on(poles, rows, grid)
    steady = (rows @ poles.steady[..., : q + 1])[:, grid.part]
    steady = steady.transpose(1, 3, 0, 2).reshape(len(grid.part), q + 1, -1)
    gaps = np.diff(first, axis=1, append=first[:, -1:] + poles.recent + grid.cycle[-1] + 1)
    is_last = np.arange(gaps.shape[1]) == gaps.shape[1] - 1
    for alike in (~is_last, is_last):  # the last one is followed far longer than the others
        own, j = np.nonzero((gaps > poles.recent) & alike)
        if not len(own):
            continue
        left = gaps[own, j] - poles.recent
        used = int(np.searchsorted(grid.cycle, left.max()))
        cycle, part = grid.cycle[:used], grid.part[:used]
        found = seen(motions.modal[j, own], shapes[:, :, : used * R]).transpose(1, 0, 2)
        found = found.reshape(len(own), -1, used, R)
        at, setpoint = first[own, j, None] + poles.recent + cycle, np.repeat(own, used)
        sampled = np.asarray(at.ravel() * poles.dt)
        x = pieces.sample(sampled, derivatives=q + 1, setpoint=setpoint)
        x = x.reshape(q + 1, *at.shape).transpose(2, 1, 0)
        found += (x @ steady[:used]).reshape(used, len(own), -1, R).transpose(1, 2, 0, 3)
        if less is not None:
            t = at * poles.dt + part * poles.velocity_cycle - poles.delay
            found -= wanted(pieces, setpoint, t, less)[:, None, :, None]
        np.abs(found, out=found)
        found *= (cycle < left[:, None])[:, None, :, None]
        np.maximum.at(largest, own, found.max(axis=2, initial=0.0))
    return largest


@once_for_rows
def where_signals_lead(poles: LoopPoles, signals: Array) -> tuple[LoopPoles, Cycles]:
    """Return corners, and velocity cycles in a position cycle, in which signals swing furthest.

    Compared by moves of ``RAMPS``; a corner counts that comes within half a per cent.
    """
    t = np.array(RAMPS)
    steps = JerkSteps(
        times=np.column_stack([np.zeros_like(t), t, 1.5 * t, 2.5 * t]),
        steps=np.tile([1.0, -1.0, -1.0, 1.0], (len(t), 1)),
    )
    motions = set_in_motion(poles, steps)
    pieces = pieces_of(motions)
    near = _near_steps(motions, pieces, signals, np.arange(poles.cycles), None)
    far = _far_from_steps(motions, pieces, lay_grid(poles, SAMPLES), signals, None)
    peaks = np.maximum(near, far[:, :, None])  # (n_setpoints, n_corners, cycles, n_signals)
    parts = np.unique(peaks.max(axis=1).argmax(axis=1))
    by_corner = peaks.max(axis=2)
    leads = by_corner >= LEADS * by_corner.max(axis=1, keepdims=True)
    return restrict(poles, np.flatnonzero(leads.any(axis=(0, 2))).tolist()), parts


SAMPLES = 12
"""Instants to a period at which these moves are compared (empirical)."""

RAMPS = (2e-3, 10e-3, 40e-3, 150e-3)
"""By which poles, corners and velocity cycles are compared [s]."""

LEADS = 0.995
"""A corner leads if it comes within this share of the worst [-]."""
