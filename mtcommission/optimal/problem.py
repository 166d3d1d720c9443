"""The matrix exponential of a plant, and of a motion that keeps a bound, to the last digit."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, matrix_balance, qr

from mtcommission.base.messages.message import Message
from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.control import terminal_target
from mtcommission.optimal.modes import step_response

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class HeldFlow:
    """x' = G x in coordinates z = T x, of which the first r are the chain and follow it exactly."""

    matrix: Array  # G, shape (n, n) [1/s]
    chart: Array  # T, shape (n, n); its first r rows are multiples of the chain
    inverse: Array  # T^-1, shape (n, n)
    # T G T^-1 with its first r rows as they are without rounding, shape (n, n) [1/s].
    generator: Array

    def over(self, span: float) -> Array:
        """Return expm(G span), shape (n, n), for a span in s that may be negative."""
        return np.asarray(self.inverse @ expm(self.generator * span) @ self.chart)


def held_flow(matrix: Array, chain: Array, *, rate: float, scale: Array) -> HeldFlow:
    """Return a motion that keeps a chain: c_j G = rate c_(j+1), and 0 for the last row.

    A boundary arc is such a motion: c x is constant on it because its derivatives are 0. In the
    states of the plant that is a difference of large numbers, and over a long arc the rounding
    of the matrix exponential lets c x drift by more than a finished control may miss.
    """
    r, n = chain.shape
    # The chain takes the place of the states that it determines best.
    order = qr(chain * scale, mode="economic", pivoting=True)[2]
    given, free = np.sort(order[:r]), np.sort(order[r:])
    solved = np.linalg.inv(chain[:, given] * scale[given]) * scale[given, np.newaxis]
    inverse = np.zeros((n, n))
    inverse[given, :r] = solved
    inverse[np.ix_(given, np.arange(r, n))] = -solved @ chain[:, free]
    inverse[free, np.arange(r, n)] = 1.0
    chart = np.vstack([chain, np.eye(n)[free]])
    generator = chart @ matrix @ inverse
    generator[:r] = rate * np.eye(n, k=1)[:r]
    generator[r - 1] = 0.0
    # In states of one size, see ``balanced_expm``: by powers of two, which round nothing.
    balanced, (sizes, _) = matrix_balance(generator, permute=False, separate=True)
    return HeldFlow(
        matrix=matrix,
        chart=chart / sizes[:, np.newaxis],
        inverse=inverse * sizes,
        generator=np.asarray(balanced, dtype=np.float64),
    )


ORDER_TOLERANCE = 1e-10
"""Share of its own terms below which c A^j B counts as zero (rounding of the sum)."""
FOLLOW_LEVEL = 0.5
"""Share of a bound that the target itself takes, above which the bound is scaled with the target:
otherwise a bound that the target just meets (|v_s| <= velocity step) would cap the reachable
multiple at 1 for every longer t_f, and t_f could not be told from it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Atom:
    """A point where a bound acts, with its part of the measure of that bound."""

    remaining: float  # Remaining time [s]
    limit: int  # Index of the bound
    weight: float  # Signed mass; positive where c x = +1 is held

    @property
    def side(self) -> int:
        """Side of the bound, +1 or -1."""
        return 1 if self.weight > 0.0 else -1


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcInterior:
    """An interval on which a bound is held and σ = 0."""

    # start, end: Remaining times, start > end [s].
    start: float
    end: float
    limit: int  # Index of the bound
    side: int  # +1 or -1

    def holds(self, remaining: float) -> bool:
        """Return whether a remaining time lies inside."""
        return self.end < remaining < self.start


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limit:
    """One bound with what follows from its order."""

    bound: SignalValue  # As the user gave it
    row: Array  # c divided by the bound's value, shape (n,)
    # Whether the program scales this bound with the target
    # (``FOLLOW_LEVEL``).
    follows: bool
    gain: float  # c (A/rate)^(r-1) B [1/(N s)]
    output_chain: Array  # Rows c (A/rate)^j, j < r; shape (r, n)
    force_chain: Array  # Columns (A/rate)^j B, j < r; shape (n, r)
    # Columns of the force chain combined so that each moves one row of the output chain by 1
    # and the others not at all, shape (n, r).
    impulses: Array
    feedback: Array  # K, shape (n,) [N per unit of state]
    boundary_flow: HeldFlow  # A + B K: the motion on a boundary arc
    adjoint_flow: HeldFlow  # A - A^r B c / (c A^(r-1) B), transposed: the adjoint on a boundary arc
    # A^r B / (c A^(r-1) B): λ times it is the density of the multiplier, shape (n,).
    density_column: Array
    # Largest real part of the zeros from force to signal, at least 0 [1/s]: with zeros in the
    # right half-plane the motion on a boundary arc grows like exp(growth t).
    growth: float

    @property
    def order(self) -> int:
        """Number of differentiations after which the force appears."""
        return len(self.output_chain)

    def missed(self, state: Array, side: int) -> Array:
        """Return c x ∓ 1 and the scaled derivatives of c x, shape (r,): all 0 where it is held."""
        levels = self.output_chain @ state
        levels[0] -= side
        return np.asarray(levels)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BoundedProblem:
    """Reach a target state from rest within a force limit and bounds."""

    plant: Plant  # Plant with n states
    force_limit: float  # F [N]
    limits: tuple[Limit, ...]  # The bounds
    fixed: NDArray[np.intp]  # Indices of the states fixed at exact rest
    ends: Array  # Rows E with E x(t_f) + offsets y = E target, shape (k, n)
    offsets: Array  # What the offset y of the reference adds, shape (k,); 0 at exact rest
    # Rows r with |r x - y| <= 1 for the free motion after t_f, one for each machine, shape
    # (n_machines, n); none at exact rest.
    tails: Array
    target: Array  # State at the end, shape (n,); 0 where free
    state_scale: Array  # Typical size of each state, shape (n,)
    rate: float  # Fastest rate of the plant [1/s]

    @property
    def vibration_rate(self) -> float:
        """Natural frequency of the fastest mode, or the fastest rate without modes [1/s]."""
        return max((mode.natural_frequency for mode in self.plant.modes), default=self.rate)

    @property
    def ramp(self) -> float:
        """Time to the bound on the rigid velocity at full force; inf without one [s]."""
        name = self.plant.states[self.plant.velocity]
        speed = next((bound.value for bound in self.bounds if bound.name == name), inf)
        return speed * self.plant.moving_mass / self.force_limit

    @property
    def bounds(self) -> tuple[SignalValue, ...]:
        """The bounds of all limits."""
        return tuple(limit.bound for limit in self.limits)

    @property
    def rows(self) -> Array:
        """The rows c of all limits, shape (n_limits, n)."""
        return np.array([limit.row for limit in self.limits]).reshape(-1, self.plant.order)

    @property
    def orders(self) -> NDArray[np.intp]:
        """Orders of all limits, shape (n_limits,)."""
        return np.array([limit.order for limit in self.limits], dtype=np.intp)


def all_bounds(
    plant: Plant, move: Move, bounds: tuple[SignalValue, ...]
) -> tuple[SignalValue, ...]:
    """Return one bound for each signal, the tightest, with that on the velocity of the move.

    Raises
    ------
    KeyError
        If there is no such signal.
    """
    values: dict[str, float] = {}
    given = list(bounds)
    if isinstance(move, Positioning) and isfinite(move.max_velocity):
        given.append(SignalValue(name=plant.states[plant.velocity], value=move.max_velocity))
    for bound in given:
        plant.row(bound.name)
        values[bound.name] = min(bound.value, values.get(bound.name, bound.value))
    return tuple(SignalValue(name=name, value=value) for name, value in values.items())


def describe_bounds(plant: Plant, bounds: tuple[SignalValue, ...]) -> tuple[Message, ...]:
    """Return bounds for a message, with their units."""
    return tuple(
        Message("signal-bound", signal=k.name, value=k.value, unit=plant.unit(k.name))
        for k in bounds
    )


def bounded_problem(
    plant: Plant,
    move: Move,
    *,
    force_limit: float,
    bounds: tuple[SignalValue, ...],
    horizon: float,
) -> BoundedProblem:
    """Return the problem with everything that follows from the orders of its bounds.

    Source: order of a state constraint after Hartl, Sethi & Vickson (1995), sec. 2.
    """
    rate = plant.fastest_rate
    target, is_fixed = terminal_target(plant, move)
    fixed = np.flatnonzero(is_fixed)
    steps = step_response(plant, np.linspace(0.0, horizon, 200))
    travel = np.abs(np.diff(steps, axis=0)).sum(axis=0) * force_limit
    scale = np.maximum(travel, np.abs(target))
    return BoundedProblem(
        plant=plant,
        force_limit=force_limit,
        limits=tuple(
            _limit(plant, bound, rate=rate, target=target, scale=scale) for bound in bounds
        ),
        fixed=fixed,
        ends=np.eye(plant.order)[fixed],
        offsets=np.zeros(fixed.size),
        tails=np.empty((0, plant.order)),
        target=target,
        state_scale=scale,
        rate=rate,
    )


def _limit(
    plant: Plant,
    bound: SignalValue,
    *,
    rate: float,
    target: Array,
    scale: Array,
) -> Limit:
    A, B = plant.A / rate, plant.B
    row = plant.row(bound.name) / bound.value
    outputs, forces = [row], [B]
    while abs(outputs[-1] @ B) <= ORDER_TOLERANCE * (np.abs(outputs[-1]) @ np.abs(B)):
        outputs.append(outputs[-1] @ A)
        forces.append(A @ forces[-1])
    gain = float(outputs[-1] @ B)
    feedback = -rate * (outputs[-1] @ A) / gain
    density_column = rate * (A @ forces[-1]) / gain
    output_chain, force_chain = np.array(outputs), np.column_stack(forces)
    boundary_flow = held_flow(plant.A + np.outer(B, feedback), output_chain, rate=rate, scale=scale)
    zeros = np.linalg.eigvals(boundary_flow.generator[len(outputs) :, len(outputs) :])
    return Limit(
        bound=bound,
        row=row,
        follows=abs(float(row @ target)) > FOLLOW_LEVEL,
        gain=gain,
        output_chain=output_chain,
        force_chain=force_chain,
        impulses=force_chain @ np.linalg.inv(output_chain @ force_chain),
        feedback=feedback,
        boundary_flow=boundary_flow,
        adjoint_flow=held_flow(
            (plant.A - np.outer(density_column, row)).T, force_chain.T, rate=rate, scale=1.0 / scale
        ),
        density_column=density_column,
        growth=float(zeros.real.max(initial=0.0)),
    )
