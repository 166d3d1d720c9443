"""The problems of the comparison, and the scaled form in which every peer is handed them.

    dx/dτ = A x + B u,   |u| <= 1,   |rows x| <= 1,   x(0) = 0,   x_i(end) = target_i where fixed

States are scaled by what F_max could cause, the force by F_max, time by a rough guess of the
final time, so that no peer has to fight units. A peer sees nothing but this.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.control import terminal_target
from mtcommission.optimal.damping import state_scales
from tests.machines import paper_machine, random_modal_machine
from tests.references_optimal import PAPER_WEIGHTS

Array = NDArray[np.float64]

STEP = VelocityStep(velocity_step=0.1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scaled:
    """What a peer is handed.

    Parameters
    ----------
    A, B
        Shapes (n, n), (n,), per unit of time.
    target, fixed
        End of the move and which of its entries are prescribed, shape (n,).
    rows
        Bounded signals, shape (k, n).
    weights
        c of the functional ∫ u² + Σ c x² dτ over the unit of time, shape (n,); empty where the
        final time is minimised instead.
    """

    A: Array
    B: Array
    target: Array
    fixed: NDArray[np.bool_]
    rows: Array
    weights: Array

    @property
    def order(self) -> int:
        """Number of states."""
        return self.target.size

    @property
    def minimises_time(self) -> bool:
        """Whether the final time is free and to be minimised; else it is 1."""
        return not self.weights.size

    def guess(self, points: int) -> tuple[Array, Array]:
        """A rigid motion as starting guess: states of shape (points, n), control (points,)."""
        tau = np.linspace(0.0, 1.0, points)
        states = np.outer(tau, self.target)
        return states, np.full(points, 0.5)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Problem:
    """A problem in SI units.

    Parameters
    ----------
    name
        Of the table.
    plant, move, force_limit, bounds
        As for the solvers of the package.
    t_f
        Given final time [s]; inf where it is minimised.
    weights
        Of the damping-optimal functional; empty where the final time is minimised.
    """

    name: str
    plant: Plant
    move: Move
    force_limit: float
    bounds: tuple[SignalValue, ...] = ()
    t_f: float = inf
    weights: tuple[SignalValue, ...] = ()

    @property
    def time_unit(self) -> float:
        """Given final time, or the rigid body's plus what flexibility may cost [s]."""
        if isfinite(self.t_f):
            return self.t_f
        slowest = max(2.0 * np.pi / mode.natural_frequency for mode in self.plant.modes)
        acceleration = self.force_limit / self.plant.moving_mass
        if isinstance(self.move, Positioning):
            rigid = 2.0 * sqrt(self.move.distance / acceleration)
        else:
            rigid = self.move.velocity_step / acceleration
        return float(rigid + slowest / 2.0 + 4.0 * self.plant.force_lag)

    @property
    def state_scale(self) -> Array:
        """Physical per scaled state, shape (n,)."""
        return state_scales(self.plant, force_limit=self.force_limit, t_f=self.time_unit)

    def scaled(self) -> Scaled:
        """Return the form that a peer is handed."""
        scale, unit, plant = self.state_scale, self.time_unit, self.plant
        target, fixed = terminal_target(plant, self.move)
        c = np.zeros(plant.order if self.weights else 0)
        for weight in self.weights:
            i = plant.states.index(weight.name)
            c[i] += weight.value * (scale[i] / self.force_limit) ** 2
        rows = [plant.row(bound.name) * scale / bound.value for bound in self.bounds]
        return Scaled(
            A=plant.A * scale / scale[:, None] * unit,
            B=plant.B * self.force_limit / scale * unit,
            target=target / scale,
            fixed=fixed,
            rows=np.array(rows).reshape(len(rows), plant.order),
            weights=c,
        )


MAIN = ("P1", "P2", "P3")
FORCES = ("F_max = 0.5 kN", "F_max = 1 kN", "F_max = 4 kN", "F_max = 8 kN")
MODES = tuple(f"{n} mode{'s' if n > 1 else ''}" for n in range(1, 9))
REST = ("rest to rest",)
NAMES = (*MAIN, *FORCES, *MODES, *REST)

MEANING = {
    "P1": "time-optimal velocity step of 0.1 m/s, F_max = 2 kN",
    "P2": "the same under |v_phi| <= 0.005 rad/s",
    "P3": "damping-optimal at t_f = 52.2 ms, weights of the paper's eq. (17)",
    "F_max = ...": "P1 at other force limits",
    "... modes": "time-optimal velocity step of random machines with 1 ... 8 modes (seed 3)",
    "rest to rest": "time-optimal positioning by 5 mm at 2 kN, no velocity limit",
}


def find_problem(name: str) -> Problem:
    """Return a problem by its name; KeyError if there is none."""
    if name not in NAMES:
        raise KeyError(name)
    plant = build_plant(paper_machine())
    first = Problem(name=name, plant=plant, move=STEP, force_limit=2e3)
    if name == "P2":
        return replace(first, bounds=(SignalValue(name="v_phi", value=0.005),))
    if name == "P3":
        return replace(first, t_f=0.0522, weights=PAPER_WEIGHTS)
    if name in FORCES:
        return replace(first, force_limit=1e3 * float(name.split()[2]))
    if name in MODES:
        machine = random_modal_machine(3, n_modes=int(name.split()[0]))
        return Problem(
            name=name,
            plant=build_plant(machine),
            move=machine.moves[0],
            force_limit=machine.drive.max_force,
        )
    if name in REST:
        return replace(first, move=Positioning(distance=5e-3))
    return first
