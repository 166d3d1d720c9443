"""What the search needs of one loop, computed once: transients of the steps, free motion.

A setpoint is a sum of jerk steps. A jerk step of 1 that began the time s before position
sample n is, at that and all later samples, sum_p s^p/p! times the p-th basis input, where
basis p is the setpoint whose p-th lower derivative steps at sample n (p = 0: jerk, 1:
acceleration, 2: velocity, 3: position). The loop answers a basis input by following its
polynomial, once settled, plus a transient A^n X_0 that is known from the first sample. At the
end of a setpoint the polynomials add up to rest or coasting, so the transients alone are
tabulated and summed: exact for any instants of the steps, and without the cancellation of
large positions. What follows is free motion, one matrix product for all setpoints.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial

import numpy as np
from numpy.typing import NDArray

from mtcommission.allowance import require_room, spend
from mtcommission.loop.model.assembly import LiftedLoop, SampledLoop
from mtcommission.plant.plant import Plant

Array = NDArray[np.float64]

SEARCH_HORIZON = 2.0
"""Free motion looked at by the search after t_e [s]; what settles later counts as inf there."""

FORGOTTEN = 1e-13
"""A transient whose every state has fallen below this share of its peak counts as zero."""

DECAY = 1e3
"""A mode is followed until it has decayed by this factor."""

SKETCH_SAMPLES = 12
"""Samples per period at a first look: the peak of a swing is missed by 3 % at most (more of what
dies out within one spacing after t_e + τ)."""

SKETCH_SPACING = 2e-3
"""Largest distance of samples at a first look [s]: some ten per period of the servo's own
motion, which no bandwidth below 50 Hz exceeds."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ResponseTables:
    """What the search needs of one loop.

    Parameters
    ----------
    dt, reference_delay
        [s].
    instants
        When the free motion is sampled, after the end of the setpoint's last position cycle,
        shape (n_samples,) [s].
    order
        Highest derivative that steps: 3 jerk, 4 snap (behind a moving average).
    transients
        Loop state less its steady motion, n cycles after a basis input began, shape
        (n_cycles, order + 1, n); the last one stands for all later cycles and is zero where the
        transient has decayed before the longest setpoint ends.
    free_motion
        Tool deviation at later velocity cycles, shape (n + 1, n_samples): per unit transient and,
        in the last row, per unit velocity while coasting [s], the same in every position cycle
        with a ripple inside it where held setpoints meet moving states.
    """

    dt: float
    instants: Array
    reference_delay: float
    order: int
    transients: Array
    free_motion: NDArray[np.floating]

    @property
    def nbytes(self) -> int:
        """What the tables take [bytes]."""
        return self.transients.nbytes + self.free_motion.nbytes + self.instants.nbytes


def build_tables(loop: SampledLoop, *, longest: float, order: int = 3) -> ResponseTables:
    """Return the tables of one loop, with the free motion at every velocity cycle.

    Parameters
    ----------
    loop
        Under its controller.
    longest
        Longest setpoint that will be asked for [s].
    order
        Derivative of the setpoints that steps: 3 the jerk, one more for each moving average.

    Returns
    -------
    ResponseTables
    """
    lifted = loop.lifted
    T = lifted.dt
    following = following_states(lifted, order)
    tool = [i for i, name in enumerate(lifted.outputs) if name.startswith("tcp[")]
    free = _free_motion(lifted, lifted.C[tool], cycles=int(np.ceil(search_horizon(lifted) / T)))
    tau, T_v = loop.controller.reference_delay, loop.controller.velocity_cycle
    ripple = lifted.C[tool] @ following[1] + tau - T_v * np.arange(len(tool))
    coasting = np.tile(ripple, len(free))
    instants: Array = np.arange(len(coasting), dtype=np.float64) * T_v
    return ResponseTables(
        dt=T,
        instants=instants,
        reference_delay=tau,
        order=order,
        transients=_transients(lifted, -following[::-1], count=int(np.ceil(longest / T)) + 3),
        free_motion=np.vstack([free.reshape(-1, len(lifted.A)).T, coasting]),
    )


def _free_motion(lifted: LiftedLoop, rows: Array, *, cycles: int) -> Array:
    """``rows`` of the loop state so many cycles ago, shape (cycles, n_rows, n)."""
    values = float(cycles * rows.size)
    require_room(values, array="allowance-free-motion")
    spend(values * (0.08 * len(lifted.A) + 0.6))
    found = np.empty((cycles, *rows.shape))
    found[0], known, power = rows, 1, lifted.A
    while known < cycles:  # twice as many in each product
        part = found[known : 2 * known]
        np.matmul(found[: len(part)], power, out=part)
        known, power = 2 * known, power @ power
    return found


def _transients(lifted: LiftedLoop, start: Array, *, count: int) -> Array:
    """Free motion from some states, shape (<= count, n_states, n); ends in zero once decayed."""
    blocks, largest, left = [start[None]], np.abs(start), count - 1
    powers = _free_motion(lifted, lifted.A, cycles=min(BLOCK, count)).transpose(0, 2, 1)
    while left > 0:
        last = blocks[-1][-1]
        require_room(float(BLOCK * len(blocks) * last.size), array="allowance-transients")
        spend(BLOCK * last.size * (0.2 * len(lifted.A) + 5.0), calls=4)
        block = np.concatenate([last[None], last @ powers[:left]])
        size = np.abs(block)
        size[0] = largest
        peaks = np.maximum.accumulate(size)
        gone = np.all(size[1:] <= FORGOTTEN * peaks[:-1], axis=(1, 2))
        if gone.any():
            block = block[: int(np.argmax(gone)) + 2]
            block[-1], left = 0.0, 0
        blocks.append(block[1:])
        largest, left = peaks[-1], left - len(block) + 1
    return np.concatenate(blocks)


BLOCK = 32
"""Position cycles that are advanced before it is looked whether anything is left."""


def following_states(lifted: LiftedLoop, order: int) -> Array:
    """Loop state while it follows a polynomial, per unit of each derivative of the position.

    X = sum_k S_k d^k x_ref/dt^k solves X⁺ = A X + B r for every polynomial of the order, with
    the derivatives one cycle later by Taylor; shape (order + 1, n), S_0 first.
    """
    n, T = len(lifted.A), lifted.dt
    inverse = np.linalg.inv(np.eye(n) - lifted.A)
    S = np.zeros((order + 1, n))
    for k in range(order + 1):
        later = sum((S[k - i] * (T**i / factorial(i)) for i in range(1, k + 1)), np.zeros(n))
        S[k] = inverse @ ((lifted.B[:, k] if k < 4 else 0.0) - later)
    return S


def search_horizon(lifted: LiftedLoop) -> float:
    """Return how long the search follows the free motion of a loop [s].

    Until its slowest mode has decayed by ``DECAY``, at most ``SEARCH_HORIZON``.

    Parameters
    ----------
    lifted
        A stable loop.

    Returns
    -------
    float
    """
    slowest = float(np.max(np.abs(np.linalg.eigvals(lifted.A))))
    needed = -np.log(DECAY) / np.log(slowest) * lifted.dt if slowest < 1.0 else SEARCH_HORIZON
    return min(needed, SEARCH_HORIZON)


def sketch_tables(
    tables: ResponseTables, plant: Plant, *, samples: int = SKETCH_SAMPLES
) -> ResponseTables:
    """Return the same tables with fewer samples in single precision, for a first look.

    The samples follow the fastest mode that has not decayed yet (at half the plant's own rate
    of decay, in case the loop slows it).

    Parameters
    ----------
    tables
        From ``build_tables``.
    plant
        The plant of that loop.
    samples
        Per period.

    Returns
    -------
    ResponseTables
    """
    t = tables.instants
    fastest = np.full_like(t, 1.0 / (SKETCH_SAMPLES * SKETCH_SPACING))
    for mode in plant.modes:
        rate = max(0.5 * mode.damping_ratio * mode.natural_frequency, 1e-9)
        alive = t < np.log(DECAY) / rate
        fastest[alive] = np.maximum(fastest[alive], mode.frequency_hz)
    step = t[1] - t[0]
    periods = np.floor(np.cumsum(samples * fastest * step) + 1e-9)
    kept = np.flatnonzero(np.diff(periods, prepend=-1.0))
    return replace(
        tables,
        instants=t[kept],
        free_motion=tables.free_motion[:, kept].astype(np.float32),
    )
