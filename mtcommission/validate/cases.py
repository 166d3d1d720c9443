"""The paper's problems, solved; its machine and the weights of eq. (17) are a shipped profile."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.manipulator import Manipulator
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.readers import SignalValue
from mtcommission.machine.requirements import Reserve
from mtcommission.optimal.bounded import solve_bounded_time_optimal
from mtcommission.optimal.control import (
    AnyOptimum,
    DampingOptimum,
    TimeOptimum,
    Trajectory,
    sample_trajectory,
)
from mtcommission.optimal.damping import solve_damping_optimal
from mtcommission.optimal.free import solve_time_optimal
from mtcommission.validate.paper import BOUNDED_T_F, FORCE_LIMIT, RATE_BOUND

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cases:
    """The machine of Table 1 and the optimal controls of secs. 5.1, 5.2 and 6."""

    machine: Machine
    mechanics: Manipulator
    plant: Plant
    time: TimeOptimum
    bounded: TimeOptimum
    damping: DampingOptimum

    def peak(self, best: AnyOptimum, name: str) -> float:
        """Return the largest magnitude of a state under an optimal control."""
        return float(best.peaks[self.plant.signals.index(name)])

    def sample(self, best: AnyOptimum, *, count: int) -> Trajectory:
        """Return the motion under an optimal control, in steps of t_f / ``count``."""
        return sample_trajectory(self.plant, best.arcs, step=best.t_f / count)


def solve_cases() -> Cases:
    """Return the solutions of the paper's problems."""
    shipped = read_shipped("milling-manipulator").machine
    # The paper makes one move in a loop without filters, and keeps no reserve.
    needs = replace(shipped.requirements, reserve=Reserve(band=1.0, force=1.0), every_size=False)
    loop = replace(shipped.control, seeks_setpoint_filter=False, seeks_force_filters=False)
    machine = replace(shipped, requirements=needs, control=loop)
    plant, move, F = build_plant(machine), machine.moves[0], FORCE_LIMIT
    bounds = (SignalValue(name="v_phi", value=RATE_BOUND),)
    weights = machine.damping_optimal.weights
    assert isinstance(machine.mechanics, Manipulator)
    return Cases(
        machine=machine,
        mechanics=machine.mechanics,
        plant=plant,
        time=solve_time_optimal(plant, move, force_limit=F),
        bounded=solve_bounded_time_optimal(plant, move, force_limit=F, bounds=bounds),
        damping=solve_damping_optimal(plant, move, force_limit=F, t_f=BOUNDED_T_F, weights=weights),
    )


def symbol(state: str) -> str:
    """Return the paper's sign of a state."""
    return state.replace("phi", "φ")
