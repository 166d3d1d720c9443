"""The matrix exponential of a plant in SI units, without loss of digits."""

from __future__ import annotations

from math import ceil

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, matrix_balance

Array = NDArray[np.float64]

TERMS = 19
"""Of the power series over a norm of at most 1: the next one is below 1/19! = 1e-17."""


def balanced_expm(matrix: Array) -> Array:
    """Return the matrix exponential, computed in states of one size.

    States of 1e-6 rad beside forces of 1e3 N make entries of a feedback A + B K twenty decades
    apart. The method scales by the norm and squares again: on a boundary arc of 50 ms twenty-seven
    times instead of five, with a relative error of 1e-9 instead of 1e-14.

    Source: Al-Mohy & Higham (2009), SIAM J. Matrix Anal. Appl. 31, 970 (overscaling); balancing
    by powers of two after Parlett & Reinsch (1969), which rounds nothing.
    """
    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    return np.asarray(expm(balanced) * scale[:, np.newaxis] / scale)


def powers_of(flow: Array, start: Array, count: int) -> Array:
    """Return start, flow start, ... of states in the last axis, shape (count + 1, ..., n)."""
    samples, filled, power = np.empty((count + 1, *start.shape)), 1, flow.T
    samples[0] = start
    while filled <= count:
        more = min(filled, count + 1 - filled)
        np.matmul(samples[:more], power, out=samples[filled : filled + more])
        filled, power = filled + more, power @ power
    return samples


def carry(generator: Array, states: Array, spans: Array) -> Array:
    """Return e^{G t} x of many short times and states, shapes (m,) [s] and (m, n).

    By its power series, in states of one size: one product a term for all of them.
    """
    balanced, (scale, _) = matrix_balance(generator, permute=False, separate=True)
    parts = max(1, ceil(np.abs(balanced).sum(axis=0).max() * spans.max()))
    total = states / scale
    for _ in range(parts):
        term = total
        for k in range(1, TERMS):
            term = term @ balanced.T * (spans / parts / k)[:, np.newaxis]
            total = total + term
    return np.asarray(total * scale)
