"""Optimal controls of a motor that follows: its acceleration acts at once, without any lag."""

from __future__ import annotations

import json
from itertools import pairwise
from math import acos, cos, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from mtcommission.base.errors import InputError
from mtcommission.limits.optima import find_optima, find_time_optimum
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, Positioning, VelocityStep
from mtcommission.machine.plant.plant import build_plant, driven_at_once
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.readers import SignalValue
from mtcommission.optimal.band import find_band_optimum
from mtcommission.optimal.control import Arc, TimeOptimum
from mtcommission.optimal.open_loop import solve_jerk_limited
from mtcommission.optimal.transcription import transcribe_damping_optimal
from mtcommission.optimal.transcription_settings import TranscriptionSettings
from mtcommission.record.optima import optimum_entry
from mtcommission.record.shape import to_plain
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint

HEAD = """schema = 1
[machine]
name = "random"
axis = "X"
source = "random"
[plant]
kind = "modal"
"""
REST = """[drive]
kind = "position_source"
max_acceleration = {a}
[[moves]]
distance = 0.02
max_velocity = 0.3
[requirements]
tcp_deviation = "20 um"
"""


def text_of(modes: list[tuple[float, float, float]], a: object) -> str:
    """Of an axis whose motor follows; modes as (frequency [Hz], damping ratio, gain)."""
    tables = "".join(
        f'[[plant.modes]]\nname = "m{n}"\nfrequency = "{f} Hz"\ndamping_ratio = {zeta}\n'
        f"tcp_gain = {gain}\n"
        for n, (f, zeta, gain) in enumerate(modes)
    )
    return HEAD + tables + REST.format(a=a)


def axis(modes: list[tuple[float, float, float]], a: float, more: str = "") -> Machine:
    return parse_profile(text_of(modes, a) + more, where="axis.toml")


def random_axis(seed: int) -> tuple[Machine, list[tuple[float, float, float]], float]:
    rng = np.random.default_rng([23, seed])
    count, a = int(rng.integers(1, 4)), float(np.exp(rng.uniform(1.0, 4.0)))
    f = rng.uniform(20.0, 50.0) * np.cumprod(rng.uniform(1.2, 2.5, count))
    zeta, gain = rng.uniform(0.0, 0.1, count), rng.uniform(0.2, 1.0, count)
    modes = list(zip(f.tolist(), zeta.tolist(), gain.tolist(), strict=True))
    return axis(modes, a), modes, a


def integrated(
    arcs: tuple[Arc, ...], modes: list[tuple[float, float, float]]
) -> tuple[list[float], float]:
    """Second program: x, v, then q and q' of each base-excited mode, and the largest velocity."""
    y, fastest = np.zeros(2 + 2 * len(modes)), 0.0
    for arc in arcs:
        k = arc.initial.size

        def slope(_: float, both: np.ndarray, k: int = k, arc: Arc = arc) -> list[float]:
            own, y = both[:k], both[k:]
            a = float(arc.output @ own)
            found = [*(arc.generator @ own), y[1], a]
            for i, (f, zeta, _gain) in enumerate(modes):
                omega, q, rate = 2.0 * pi * f, y[2 + 2 * i], y[3 + 2 * i]
                found += [rate, -a - 2.0 * zeta * omega * rate - omega**2 * q]
            return found

        solved = solve_ivp(
            slope, (arc.t_start, arc.t_end), [*arc.initial, *y], method="DOP853", rtol=1e-12,
            atol=1e-16,
        )  # fmt: skip
        y, fastest = solved.y[k:, -1], max(fastest, np.abs(solved.y[k + 1]).max())
    return y.tolist(), fastest


def is_proved(found: TimeOptimum) -> bool:
    return found.certificate.relative_gap <= 1e-9 and found.method == "exact"


@pytest.mark.parametrize(("distance", "a", "f"), [(1e-3, 20.0, 40.0), (2e-4, 3.0, 90.0)])
def test_one_undamped_mode_in_closed_form(distance, a, f):
    """Antisymmetric about the middle: 2 cos wb = 1 + cos wh, h^2 - 2 b^2 = L/a, t_f = 2 h.

    The sine moment about the middle and the way, for switches at the middle and b about it.
    """
    omega = 2.0 * pi * f

    def inner(h):
        return acos(0.5 * (1.0 + cos(omega * h))) / omega

    h = brentq(
        lambda h: h**2 - 2.0 * inner(h) ** 2 - distance / a,
        sqrt(distance / a), sqrt(distance / a) + pi / omega, xtol=1e-16, rtol=1e-15,
    )  # fmt: skip
    machine = axis([(f, 0.0, 1.0)], a)
    found = find_time_optimum(
        build_plant(machine), Positioning(distance=distance), force_limit=a, bounds=()
    )
    b = inner(h)
    assert found.t_f == pytest.approx(2.0 * h, rel=1e-11)
    assert found.switching_times == pytest.approx((h - b, h, h + b), rel=1e-9)
    assert is_proved(found)
    assert found.certificate.switching_law_holds


@pytest.mark.parametrize("seed", range(6))
def test_random_axes_are_proved_and_end_at_rest(seed):
    """Else the least time on the sheet is not that of the axis, or leaves it swinging."""
    machine, modes, a = random_axis(seed)
    plant = build_plant(machine)
    moves = (machine.moves[0], Positioning(distance=0.005), VelocityStep(velocity_step=0.1))
    for move in moves:
        found = find_time_optimum(plant, move, force_limit=a, bounds=())
        assert is_proved(found)
        (x, v, *tips), _ = integrated(found.arcs, modes)
        step = isinstance(move, VelocityStep)
        assert v == pytest.approx(0.1 if step else 0.0, abs=1e-10)
        if isinstance(move, Positioning):
            assert x == pytest.approx(move.distance, rel=1e-10)
        swing = [abs(value) for value in tips]
        largest = a / (2.0 * pi * modes[0][0])
        assert max(swing[0::2]) < 1e-9 * largest
        assert max(swing[1::2]) < 1e-8 * largest


def test_a_bound_on_the_acceleration_is_a_lower_limit():
    """Else bounding F as a peak ends in an error, or is not kept."""
    machine = axis([(45.0, 0.05, 1.0)], 20.0)
    plant, move = build_plant(machine), machine.moves[0]
    bounded = find_time_optimum(
        plant, move, force_limit=20.0, bounds=(SignalValue(name="F", value=8.0),)
    )
    lower = find_time_optimum(plant, move, force_limit=8.0, bounds=())
    assert bounded.t_f == lower.t_f
    assert bounded.peaks[plant.force] == pytest.approx(8.0)
    assert {bound.name for bound in bounded.bounds} == {"v", "F"}


@pytest.mark.parametrize(
    "move", [Positioning(distance=0.004), VelocityStep(velocity_step=0.1)], ids=["rest", "step"]
)
def test_damping_optimum_is_that_of_a_grid(move):
    """Exact arcs and a transcription know nothing of each other."""
    machine, _, a = random_axis(5)
    plant = build_plant(machine)
    optima = find_optima(machine, plant, move)
    assert optima.damping is not None
    assert optima.damping.t_f == pytest.approx(1.2 * optima.time.t_f)
    grid = transcribe_damping_optimal(
        driven_at_once(plant), move, force_limit=a, t_f=optima.damping.t_f,
        weights=optima.damping.weights, bounds=(), settings=TranscriptionSettings(intervals=800),
    )  # fmt: skip
    assert optima.damping.cost == pytest.approx(grid.cost, rel=1e-4)
    assert optima.damping.certificate.law_residual < 1e-9
    assert np.abs(optima.damping.terminal_error).max() < 1e-9
    for solution in (optima.time, optima.damping):
        entry = to_plain(optimum_entry(plant, solution))
        assert "F" not in entry["certificate"]["adjoint_initial"]
        assert entry["peaks"]["F"] <= a * (1.0 + 1e-12)
        json.dumps(entry, allow_nan=False)


def test_band_is_reached_before_exact_rest():
    """With its own proof; a band of nothing is exact rest."""
    machine, _, a = random_axis(2)
    moved, move = driven_at_once(build_plant(machine)), Positioning(distance=0.01)
    at_rest = find_time_optimum(build_plant(machine), move, force_limit=a, bounds=()).t_f
    times = []
    for band in (2e-5, 1e-9):
        found = find_band_optimum(moved, move, force_limit=a, band=band, at_rest=at_rest)
        assert found.gap < 1e-4
        times.append(found.t_f)
    assert times[0] < times[1] < at_rest * (1.0 + 1e-4)
    assert times[1] == pytest.approx(at_rest, rel=1e-4)


def test_a_weight_of_the_acceleration_is_refused_with_the_way_out():
    more = "[damping_optimal]\nweights = { q_m0 = 1e9, F = 2.0 }\n"
    with pytest.raises(InputError) as caught:
        axis([(45.0, 0.05, 1.0)], 20.0, more)
    said = str(caught.value)
    assert "axis.toml:22: damping_optimal.weights.F" in said
    assert "remove the weight, and divide the others by 1 plus it" in said


# The time-optimal motion of a motor that follows, within acceleration and jerk.


PROFILES = Path(__file__).parent.parent / "profiles"
ONE_MODE = [(45.0, 0.05, 1.0)]


def solved(machine: Machine, move: Move, *, a: float, jerk: float) -> TimeOptimum:
    return solve_jerk_limited(build_plant(machine), move, force_limit=a, jerk_limit=jerk, bounds=())


@pytest.mark.parametrize("seed", range(3))
def test_random_axes_are_proved_and_integrate_to_rest(seed):
    """Second program: x, v, a and every mode integrated from the sampled jerk of each arc."""
    machine, modes, a = random_axis(seed)
    jerk = a * 2.0 * pi * modes[0][0] * (0.3, 1.0, 4.0)[seed % 3]
    move = machine.moves[0]
    assert isinstance(move, Positioning)
    found = solved(machine, move, a=a, jerk=jerk)
    assert found.certificate.relative_gap < 1e-9
    assert found.certificate.switching_law_holds
    (x, v, *tips), fastest = integrated(found.arcs, modes)
    assert fastest <= move.max_velocity * (1.0 + 1e-7)
    assert found.peaks[-4] <= a * (1.0 + 1e-7)
    assert x == pytest.approx(move.distance, rel=1e-8)
    assert abs(v) < 1e-8
    omega = 2 * pi * modes[0][0]
    assert np.abs(tips[0::2]).max() < 1e-8 * a / omega
    assert np.abs(tips[1::2]).max() < 1e-6 * a / omega


def test_a_large_jerk_leads_to_the_acceleration_that_jumps():
    """More jerk never takes more time, and without its limit the other solver's time is reached."""
    machine = axis(ONE_MODE, 20.0)
    move = machine.moves[0]
    least = find_time_optimum(build_plant(machine), move, force_limit=20.0, bounds=()).t_f
    times = [solved(machine, move, a=20.0, jerk=jerk).t_f for jerk in (500.0, 5e3, 1e5)]
    assert all(later < earlier for earlier, later in pairwise(times))
    assert least < times[-1] < 1.005 * least


def test_a_stiff_structure_leaves_the_setpoint_of_the_planner():
    """Where nothing swings the least time is that of Ruckig, which knows the rigid axis alone."""
    machine = axis([(2500.0, 0.1, 1.0)], 20.0)
    move = machine.moves[0]
    found = solved(machine, move, a=20.0, jerk=2e3)
    rigid = plan_setpoint(move, MotionLimits(acceleration=20.0, jerk=2e3)).duration
    assert rigid <= found.t_f * (1.0 + 1e-9)
    assert found.t_f == pytest.approx(rigid, rel=1e-3)


def test_other_bounds_hold_besides():
    """A bound on the velocity is the max_velocity of a move; both, and that of F, hold together."""
    machine = axis(ONE_MODE, 20.0)
    plant = build_plant(machine)
    slower = Positioning(distance=0.02, max_velocity=0.2)
    bounded = solve_jerk_limited(
        plant, machine.moves[0], force_limit=20.0, jerk_limit=2e3,
        bounds=(SignalValue(name="v", value=0.2),),
    )  # fmt: skip
    assert bounded.t_f == pytest.approx(solved(machine, slower, a=20.0, jerk=2e3).t_f, rel=1e-9)
    assert [(bound.name, bound.value) for bound in bounded.bounds] == [("v", 0.2)]
    assert bounded.force_limit == 20.0


def test_command_line_says_the_limit_and_where_it_belongs(run):
    def call(profile, *more):
        code, out, error = run("optimal", PROFILES / profile, "--kind", "time", *more)
        return code, (out + error).replace("\u202f", " ")

    code, said = call("printer-belt.toml", "--jerk", "20000", "--move", "2")
    assert not code
    assert "t_f = 11.153294 ms" in said
    assert "Limit: Jerk at most 20000 m/s³, reached." in said
    assert "+j_max" in said
    code, said = call("printer-belt.toml", "--jerk", "1e12")
    assert code == 2
    assert "leave --jerk out, which lets it jump" in said
    code, said = call("printer-belt.toml", "--limit", "F=5 m/s^2", "--move", "2")
    assert not code
    assert "at most 5 m/s², reached." in said
    code, said = call("ball-screw.toml", "--jerk", "9")
    assert code == 2
    assert "--jerk: goes with" in said
