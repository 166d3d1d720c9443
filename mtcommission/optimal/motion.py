"""The motion that a control causes: its end, peaks between all samples, and squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.exponential import balanced_expm, powers_of
from mtcommission.optimal.peaks import hermite_peaks, signal_rows
from mtcommission.optimal.solution import Arc, follow_runs

Array = NDArray[np.float64]

RADIANS_PER_CELL = 0.015
"""Cells for the peaks: the cubic between samples is right to (ω h)^4 / 384 = 1.3e-10."""
BLOCK = 4096
"""Samples at a time: a long arc has millions, and their states would take gigabytes."""
TERMS = 8
"""Of the series of a cell's squares: the next one is below (2 ω h)^8 / 9! = 2e-18."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FollowedMotion:
    """What a control does."""

    arcs: tuple[Arc, ...]
    final: Array  # State at the end, shape (n,)
    peaks: Array  # Largest magnitude of each of ``Plant.signals``
    force_peak: float  # Largest |F_set| [N]
    effort: float  # Integral of F_set² [N² s]
    squares: Array  # Integrals of the squared states, shape (n,)


def follow_control(plant: Plant, arcs: tuple[Arc, ...], *, rate: float = 0.0) -> FollowedMotion:
    """Return what a plant of ``driven_at_once`` does under the arcs, from rest.

    Cells are short against the plant's fastest rate, and against one of the control [1/s].

    Source: d/dt z z' = J z z' + z z' J' for the joint generator J, so the integral of z z' over
    cells of one length is the power series of that map on the sum of z z' at their starts.
    """
    n, rows, fastest = plant.order, signal_rows(plant).T, max(rate, plant.fastest_rate)
    peaks, force_peak, effort, squares = np.zeros(rows.shape[1]), 0.0, 0.0, np.zeros(n)
    for run in follow_runs(plant, arcs):
        length, output, joint = run.arcs[0].length, run.arcs[0].output, run.joint.T
        count = int(np.ceil(length * fastest / RADIANS_PER_CELL)) + 1
        step, together, starts = length / count, max(1, BLOCK // count), np.zeros_like(joint)
        flow = balanced_expm(run.joint * step)
        for first in range(0, len(run.arcs), together):
            z = run.begins[first : first + together]
            for done in range(0, count, BLOCK):
                along = powers_of(flow, z, min(BLOCK, count - done))
                values, rates = along[..., :n] @ rows, (along @ joint)[..., :n] @ rows
                peaks = np.maximum(peaks, _largest(step, values, rates))
                force_peak = max(force_peak, float(np.abs(along[..., n:] @ output).max()))
                every = along[:-1].reshape(-1, len(joint))
                starts += every.T @ every
                z = along[-1]
        products = term = starts * step
        for k in range(2, TERMS + 1):
            term = (term @ joint + joint.T @ term) * (step / k)
            products = products + term
        effort += float(output @ products[n:, n:] @ output)
        squares += np.diag(products)[:n]
    return FollowedMotion(
        arcs=arcs,
        final=run.final[:n],
        peaks=peaks,
        force_peak=force_peak,
        effort=effort,
        squares=squares,
    )


def _largest(step: float, values: Array, rates: Array) -> Array:
    """Return the peaks along some arcs, values and rates of shape (n_samples, n_arcs, k)."""
    start, end, start_rate, end_rate = (
        part.reshape(-1, values.shape[-1])
        for part in (values[:-1], values[1:], rates[:-1], rates[1:])
    )
    steps = np.full(len(start), step)
    return hermite_peaks(steps, start, end, start_rate=start_rate, end_rate=end_rate)
