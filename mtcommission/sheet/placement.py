"""Where the labels of points stand so that none hides another."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DIRECTIONS = 16
RINGS = (1.0, 1.6, 2.4, 3.4, 4.6, 6.0, 8.0, 11.0)
"""Directions and distances tried, the nearest first."""

AIR = 0.5
"""Room kept free around a label."""


LONGEST = 36
"""Letters of a name that stands beside its point."""


def shorten(name: str) -> str:
    """Return a name as it stands beside its point; what is longer ends in an ellipsis.

    Examples
    --------
    >>> shorten("j = 10 a"), len(shorten("x" * 80))
    ('j = 10 a', 36)
    """
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"


def place_labels(points: Array, sizes: Array, *, width: float, height: float, gap: float) -> Array:
    """Return the centres of labels beside their points.

    Parameters
    ----------
    points
        Shape (n, 2), inside the frame.
    sizes
        Width and height of each label, shape (n, 2).
    width, height
        Of the frame, which begins at 0.
    gap
        Half the size of a symbol.

    Returns
    -------
    ndarray
        Shape (n, 2). Each label takes the first place of ``RINGS`` by ``DIRECTIONS`` that
        covers neither a point nor a label before it; where there is none, the one that covers
        least.

    Examples
    --------
    >>> place_labels(np.array([[50.0, 50.0]]), np.array([[8.0, 6.0]]),
    ...     width=100.0, height=100.0, gap=3.0).round(1)
    array([[58., 50.]])
    """
    boxes = np.zeros((0, 4))
    symbols = np.hstack([points - gap, points + gap])
    centres = np.zeros_like(points)
    for k, (point, size) in enumerate(zip(points, sizes, strict=True)):
        tried = _candidates(point, size, gap)
        half = size / 2 + AIR
        spots = np.hstack([tried - half, tried + half])
        cost = _covered(spots, symbols) + _covered(spots, boxes)
        cost += 10.0 * _outside(spots, width, height)
        best = int(np.argmin(cost))
        centres[k] = tried[best]
        boxes = np.vstack([boxes, spots[best : best + 1]])
    return centres


def _candidates(point: Array, size: Array, gap: float) -> Array:
    found = []
    for ring in RINGS:
        for k in range(DIRECTIONS):
            # To the right first, then alternately up and down.
            angle = 2 * pi * ((k + 1) // 2) * (-1) ** k / DIRECTIONS
            reach = gap * ring + 1.0 + size / 2
            found.append(point + reach * (cos(angle), -sin(angle)))
    return np.array(found)


def _covered(spots: Array, others: Array) -> Array:
    """Return the area of each spot that others cover, shape (n,)."""
    low = np.maximum(spots[:, None, :2], others[None, :, :2])
    high = np.minimum(spots[:, None, 2:], others[None, :, 2:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=2).sum(axis=1))


def _outside(spots: Array, width: float, height: float) -> Array:
    over = np.maximum(spots[:, 2:] - (width, height), 0.0) + np.maximum(-spots[:, :2], 0.0)
    return np.asarray(over.sum(axis=1))
