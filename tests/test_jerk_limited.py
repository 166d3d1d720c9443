"""The time-optimal motion of a motor that follows, within acceleration and jerk."""

from __future__ import annotations

from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mtcommission.limits.optima import find_time_optimum
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning
from mtcommission.machine.plant.plant import build_plant
from mtcommission.optimal.control import Bound, TimeOptimum
from mtcommission.optimal.open_loop import solve_jerk_limited
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from tests.conftest import Run
from tests.test_at_once import axis, random_axis

PROFILES = Path(__file__).parent.parent / "profiles"
ONE_MODE = [(45.0, 0.05, 1.0)]


def solved(machine: Machine, move: Move, *, a: float, jerk: float) -> TimeOptimum:
    return solve_jerk_limited(build_plant(machine), move, force_limit=a, jerk_limit=jerk, bounds=())


@pytest.mark.parametrize("seed", range(3))
def test_random_axes_are_proved_and_integrate_to_rest(seed: int) -> None:
    """Second program: x, v, a and every mode integrated from the sampled jerk of each arc."""
    machine, modes, a = random_axis(seed)
    jerk = a * 2.0 * pi * modes[0][0] * (0.3, 1.0, 4.0)[seed % 3]
    move = machine.moves[0]
    assert isinstance(move, Positioning)
    found = solved(machine, move, a=a, jerk=jerk)
    assert found.certificate.relative_gap < 1e-9
    assert found.certificate.switching_law_holds
    y = np.zeros(3 + 2 * len(modes))
    for arc in found.arcs:
        k = arc.initial.size

        def slope(_: float, z: np.ndarray, k: int = k, arc=arc) -> np.ndarray:  # type: ignore[no-untyped-def]
            own, y = z[:k], z[k:]
            rate = arc.generator @ own
            out = [y[1], y[2], float(arc.output @ rate)]
            for i, (f, zeta, _gain) in enumerate(modes):
                omega = 2.0 * pi * f
                out += [
                    y[4 + 2 * i],
                    -y[2] - 2 * zeta * omega * y[4 + 2 * i] - omega**2 * y[3 + 2 * i],
                ]
            return np.concatenate([rate, out])

        ends = solve_ivp(
            slope, (arc.t_start, arc.t_end), np.concatenate([arc.initial, y]),
            method="DOP853", rtol=1e-11, atol=1e-14, dense_output=True,
        )  # fmt: skip
        inside = ends.sol(np.linspace(arc.t_start, arc.t_end, 50))[k:]
        assert np.abs(inside[1]).max() <= move.max_velocity * (1.0 + 1e-7)
        assert np.abs(inside[2]).max() <= a * (1.0 + 1e-7)
        y = ends.y[k:, -1]
    assert y[0] == pytest.approx(move.distance, rel=1e-8)
    assert abs(y[1]) < 1e-8
    assert abs(y[2]) < 1e-6 * a
    assert np.abs(y[3::2]).max() < 1e-8 * a / (2 * pi * modes[0][0])
    assert np.abs(y[4::2]).max() < 1e-6 * a / (2 * pi * modes[0][0])


def test_a_large_jerk_leads_to_the_acceleration_that_jumps() -> None:
    """More jerk never takes more time, and without its limit the other solver's time is reached."""
    machine = axis(ONE_MODE, 20.0)
    move = machine.moves[0]
    least = find_time_optimum(build_plant(machine), move, force_limit=20.0, bounds=()).t_f
    times = [solved(machine, move, a=20.0, jerk=jerk).t_f for jerk in (500.0, 5e3, 1e5)]
    assert all(later < earlier for earlier, later in pairwise(times))
    assert least < times[-1] < 1.005 * least


def test_a_stiff_structure_leaves_the_setpoint_of_the_planner() -> None:
    """Where nothing swings the least time is that of Ruckig, which knows the rigid axis alone."""
    machine = axis([(2500.0, 0.1, 1.0)], 20.0)
    move = machine.moves[0]
    found = solved(machine, move, a=20.0, jerk=2e3)
    rigid = plan_setpoint(move, MotionLimits(acceleration=20.0, jerk=2e3)).duration
    assert rigid <= found.t_f * (1.0 + 1e-9)
    assert found.t_f == pytest.approx(rigid, rel=1e-3)


def test_other_bounds_hold_besides() -> None:
    """A bound on the velocity is the max_velocity of a move; both, and that of F, hold together."""
    machine = axis(ONE_MODE, 20.0)
    plant = build_plant(machine)
    slower = Positioning(distance=0.02, max_velocity=0.2)
    bounded = solve_jerk_limited(
        plant, machine.moves[0], force_limit=20.0, jerk_limit=2e3,
        bounds=(Bound(name="v", value=0.2),),
    )  # fmt: skip
    assert bounded.t_f == pytest.approx(solved(machine, slower, a=20.0, jerk=2e3).t_f, rel=1e-9)
    assert [(bound.name, bound.value) for bound in bounded.bounds] == [("v", 0.2)]
    assert bounded.force_limit == 20.0


def test_command_line_says_the_limit_and_where_it_belongs(
    run: Run,
) -> None:
    def call(profile: str, *more: str) -> tuple[int, str]:
        code, out, error = run("optimal", PROFILES / profile, "--kind", "time", *more)
        return code, (out + error).replace("\u202f", " ")

    code, said = call("printer-belt.toml", "--jerk", "20000", "--move", "2")
    assert not code
    assert "t_f = 11.153294 ms" in said
    assert "Limit |jerk| <= 20000 m/s³: reached." in said
    assert "+j_max" in said
    code, said = call("printer-belt.toml", "--jerk", "1e12")
    assert code == 2
    assert "leave --jerk out, which lets it jump" in said
    code, said = call("printer-belt.toml", "--limit", "F=5 m/s^2", "--move", "2")
    assert not code
    assert "Limit |F| <= 5 m/s²: reached." in said
    code, said = call("ball-screw.toml", "--jerk", "9")
    assert code == 2
    assert "--jerk: goes with" in said
