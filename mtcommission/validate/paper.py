"""What the paper prints, misprints included, and its problems, solved.

Source: B. Christiansen, H. Maurer, O. Zirn, Optimal Control of Machine Tool Manipulators.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.control_kinds.kinds import STATE_SPACE
from mtcommission.machine.control import Control, StateFeedback
from mtcommission.machine.drive import Drive
from mtcommission.machine.machine import Machine, Weight
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.requirements import Modes, Requirements
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.damping import solve_damping_optimal
from mtcommission.optimal.free.time_optimal import solve_time_optimal
from mtcommission.optimal.solution import AnyOptimum, Bound, DampingOptimum, TimeOptimum
from mtcommission.plant.manipulator import Manipulator
from mtcommission.plant.plant import Plant, build_plant

Array = NDArray[np.float64]

MECHANICS = Manipulator(
    base_mass=450.0,
    slider_mass=750.0,
    rotary_inertia=40.0,
    lever_arm=0.25,
    tcp_height=0.21,
    base_stiffness=44.41e6,
    base_damping=8500.0,
    rotary_stiffness=8.2e6,
    rotary_damping=1800.0,
)
"""Table 1, SI."""
FORCE_LAG = 2.5e-3
"""T, Table 1 [s]."""

FORCE_LIMIT = 2e3
"""F_max of secs. 5.1, 5.2 and 6 [N]."""
LARGEST_FORCE = 4e3
"""Upper limit of F_max "for mechanical reasons", Table 1 [N]."""
VELOCITY_STEP = 0.1
"""v_s(t_f), eq. (3) [m/s]."""

KALMAN_RANK = 7
"""Rank of eq. (10)."""
JACOBIAN_RANK = 6
"""Rank of the Jacobian of the terminal conditions, sec. 5.1."""
SWITCHES = 5
"""Number of switches "for all values of F_max > 0", eq. (11)."""

SWITCHING_TIMES = (0.009337, 0.009668, 0.036552, 0.037653, 0.041942)
"""t_1 ... t_5, eq. (12) [s]."""
T_F = 0.043505
"""t_f, eq. (12) [s]."""
ADJOINT = (-11.87902, 0.0, 14.75425, 0.05508, -0.23018, 0.01149, -1.2503e-6)
"""λ(0), sec. 5.1, in the order of the states."""
TIME_ACCURACY = 1e-4
"""The text calls switching times "correct up to 3-4 decimals", sec. 5 [s]."""

RATE_BOUND = 0.005
"""c_φ, sec. 5.2 [rad/s]."""
BOUNDED_T_F = 0.0522
"""t_f under that bound, sec. 5.2, and t_f of sec. 6 [s]."""
INCREASE = 0.23
"""By how much that is longer than (12), sec. 5.2 [-]."""
BANG_ARCS = (2, 5, 2)
"""Bang arcs before, between and after the two boundary arcs, sec. 5.2."""

WEIGHTS = (
    Weight(state="x_b", value=1.8858e15),
    Weight(state="phi", value=1.0961e15),
    Weight(state="v_b", value=8.6070e10),
    Weight(state="v_phi", value=2.8505e10),
)
"""Eq. (17)."""
PEAKS = (0.008916, 0.005, 0.022444)
"""Sec. 6, printed as ‖φ‖: damping-optimal, bounded and free time-optimal control [rad/s]."""


def paper_machine() -> Machine:
    """Return the machine of Table 1 with the velocity step of eq. (3)."""
    return Machine(
        name="Milling machine workpiece manipulator",
        axis="X",
        source="Christiansen, Maurer, Zirn, Table 1",
        mechanics=MECHANICS,
        drive=Drive(force_lag=FORCE_LAG, max_force=FORCE_LIMIT),
        moves=(VelocityStep(velocity_step=VELOCITY_STEP),),
        requirements=Requirements(
            tcp_deviation=5e-6,
            modes=Modes(surface=2e-6, accuracy=5e-6, speed=20e-6),
            frequency_spread=0.05,
            damping_spread=0.3,
        ),
        control=Control(kind=STATE_SPACE, state_feedback=StateFeedback.AUTO),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cases:
    """The machine of Table 1 and the optimal controls of secs. 5.1, 5.2 and 6."""

    machine: Machine
    plant: Plant
    time: TimeOptimum
    bounded: TimeOptimum
    damping: DampingOptimum

    def peak(self, solution: AnyOptimum, name: str) -> float:
        """Return the largest magnitude of a state under one of the controls."""
        return float(solution.peaks[self.plant.signals.index(name)])


def solve_cases() -> Cases:
    """Return the solutions of the paper's problems."""
    machine = paper_machine()
    plant, move = build_plant(machine), machine.moves[0]
    bound = Bound(name="v_phi", value=RATE_BOUND)
    return Cases(
        machine=machine,
        plant=plant,
        time=solve_time_optimal(plant, move, force_limit=FORCE_LIMIT),
        bounded=solve_bounded_time_optimal(plant, move, force_limit=FORCE_LIMIT, bounds=(bound,)),
        damping=solve_damping_optimal(
            plant, move, force_limit=FORCE_LIMIT, t_f=BOUNDED_T_F, weights=WEIGHTS
        ),
    )
