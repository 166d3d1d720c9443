"""What an arc of a Hamiltonian system does, told from both of its ends: stable over any length.

Over an arc from a to b the linear system z' = G z + g, z = (x, λ), has the two-point form

    x_b = P x_a + Q λ_b + r
    λ_a = R x_a + S λ_b + q

States are carried forwards and adjoints backwards, the directions in which each decays. Nothing
grows with the length, and two halves make a whole, so 2^k equal pieces take k doublings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TwoPoint:
    """The two-point forms of k arcs."""

    form: Array  # [P Q r; R S q] of each, shape (k, 2 n, 2 n + 1)

    @property
    def order(self) -> int:
        """Number n of states."""
        return int(self.form.shape[1]) // 2

    @property
    def P(self) -> Array:
        """Shape (k, n, n)."""
        return self.form[:, : self.order, : self.order]

    @property
    def Q(self) -> Array:
        """Shape (k, n, n)."""
        return self.form[:, : self.order, self.order : -1]

    @property
    def r(self) -> Array:
        """Shape (k, n, 1)."""
        return self.form[:, : self.order, -1:]

    @property
    def R(self) -> Array:
        """Shape (k, n, n)."""
        return self.form[:, self.order :, : self.order]

    @property
    def S(self) -> Array:
        """Shape (k, n, n)."""
        return self.form[:, self.order :, self.order : -1]

    @property
    def q(self) -> Array:
        """Shape (k, n, 1)."""
        return self.form[:, self.order :, -1:]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Middle:
    """The states in the middle of k arcs."""

    state: Array  # What takes (x_a, λ_b, 1) to x in the middle, shape (k, n, 2 n + 1)
    half: TwoPoint  # Both halves


def two_point(flow: Array, offset: Array) -> TwoPoint:
    """Return the two-point form of short pieces with z_b = flow z_a + offset."""
    n = flow.shape[1] // 2
    # From the second line of the flow, λ_a = S (λ_b - flow_21 x_a - offset_2).
    S = np.linalg.inv(flow[:, n:, n:])
    form = np.zeros((flow.shape[0], 2 * n, 2 * n + 1))
    form[:, n:, :n], form[:, n:, n:-1] = -S @ flow[:, n:, :n], S
    form[:, n:, -1:] = -S @ offset[:, n:, np.newaxis]
    form[:, :n] = flow[:, :n, n:] @ form[:, n:]
    form[:, :n, :n] += flow[:, :n, :n]
    form[:, :n, -1] += offset[:, :n]
    return TwoPoint(form=form)


def middle(half: TwoPoint) -> Middle:
    """Return the state between two equal arcs, one behind the other."""
    right = np.concatenate([half.P, half.Q @ half.S, half.r + half.Q @ half.q], axis=2)
    return Middle(state=np.linalg.solve(np.eye(half.order) - half.Q @ half.R, right), half=half)


def doubled(between: Middle) -> TwoPoint:
    """Return the two-point form of two equal arcs, one behind the other."""
    half, n = between.half, between.half.order
    form = np.zeros_like(half.form)
    form[:, :n] = half.P @ between.state
    form[:, :n, n:-1] += half.Q
    form[:, :n, -1:] += half.r
    adjoint = half.R @ between.state
    adjoint[:, :, n:-1] += half.S
    adjoint[:, :, -1:] += half.q
    form[:, n:] = half.S @ adjoint
    form[:, n:, :n] += half.R
    form[:, n:, -1:] += half.q
    return TwoPoint(form=form)


def inner_nodes(levels: list[tuple[Middle, int]], start: Array, end: Array) -> Array:
    """Return z at the ends of the 2^k equal pieces of one arc, shape (2^k + 1, 2 n)."""
    n, count = start.size // 2, 2 ** len(levels)
    nodes = np.empty((count + 1, 2 * n))
    nodes[0], nodes[-1] = start, end
    stride = count
    for between, i in reversed(levels):
        state, half = between.state[i], between.half.form[i, n:]
        before, after = nodes[:-1:stride, :n], nodes[stride::stride, n:]
        x = before @ state[:, :n].T + after @ state[:, n:-1].T + state[:, -1]
        adjoint = x @ half[:, :n].T + after @ half[:, n:-1].T + half[:, -1]
        nodes[stride // 2 :: stride, :n], nodes[stride // 2 :: stride, n:] = x, adjoint
        stride //= 2
    return nodes


def chain_ends(arcs: TwoPoint, rows: NDArray[np.intp], values: Array) -> Array:
    """Return z at the ends of arcs one behind the other, from x = 0 at the start.

    Raises
    ------
    numpy.linalg.LinAlgError
        If these arcs leave too little freedom to reach what is prescribed.
    """
    k, n = arcs.form.shape[0], arcs.order
    width, reach = 2 * n, 3 * n - 1
    block = np.zeros((k, width, 2 * width))
    block[:, :, :n], block[:, :, 3 * n :] = arcs.form[:, :, :n], arcs.form[:, :, n:-1]
    diagonal = np.arange(n)
    block[:, diagonal, width + diagonal] = block[:, n + diagonal, n + diagonal] = -1.0
    band = np.zeros((2 * reach + 1, (k + 1) * width))
    band[reach, :n] = 1.0
    row, column = np.arange(width)[:, np.newaxis], np.arange(2 * width)
    shift = width * np.arange(k)[:, np.newaxis, np.newaxis]
    band[reach + n + row - column, shift + column] = block
    band[reach + n + diagonal - rows, width * k + rows] = 1.0
    right = np.concatenate([np.zeros(n), -arcs.form[:, :, -1].ravel(), values])
    ends = solve_banded((reach, reach), band, right, check_finite=False)
    return np.asarray(ends).reshape(k + 1, width)
