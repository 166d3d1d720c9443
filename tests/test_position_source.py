"""Axes whose motor simply follows its setpoint: base-excited modes, frequencies with it held."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.commission.commission import commission
from mtcommission.limits.corner_velocity import find_corner_velocity
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.checks import say_jerk
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Positioning
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.limits import limits_part
from mtcommission.record.loop import loop_part
from mtcommission.record.machine import list_data
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.setpoint import plan_setpoint
from tests.independent_loop import behind, profile_of
from tests.test_at_once import axis, text_of

PRINTER = text_of([(45.0, 0.05, 1.0)], '"20 m/s^2"') + '[control]\nkind = "klipper"\n'

MZV = SetpointFilter(kind="mzv", frequency_hz=45.0, damping_ratio=0.05)


def printer() -> Machine:
    return parse_profile(PRINTER, where="printer.toml")


def base_excited_residual(
    limits: MotionLimits, move: Positioning, *, frequency_hz: float, zeta: float
) -> tuple[float, float]:
    """A second program: the modal equation integrated numerically behind a sum of cubics.

    Returns the residual and the end of the setpoint.
    """
    profile = behind(profile_of(move, limits.acceleration, limits.jerk), limits.setpoint_filter)
    omega = 2.0 * pi * frequency_hz
    found = solve_ivp(
        lambda t, y: [y[1], -profile.at(t)[2] - 2.0 * zeta * omega * y[1] - omega**2 * y[0]],
        (0.0, profile.end + 0.1),
        [0.0, 0.0],
        max_step=2e-4,
        rtol=1e-8,
        atol=1e-12,
        dense_output=True,
    )
    after = np.linspace(profile.end, profile.end + 0.1, 4001)
    return float(np.abs(found.sol(after)[0]).max()), profile.end


@pytest.mark.parametrize("item", [None, MZV, SetpointFilter(kind="zv", frequency_hz=45.0)])
def test_residual_by_a_second_program(item):
    """Else the vibration that is printed is not that of a head behind a motor that follows."""
    machine, acceleration = printer(), 18.0
    limits = replace(without_jerk_limit(machine, acceleration), setpoint_filter=item)
    move = machine.moves[0]
    assert isinstance(move, Positioning)
    loop = tune_loop(machine).loops[0]
    response = simulate(loop, plan_setpoint(move, limits), drive=machine.drive, band=20e-6)
    residual, end = base_excited_residual(limits, move, frequency_hz=45.0, zeta=0.05)
    # The tool holds the setpoint 0.25 ms and looks every 0.125 ms: 1 % of what one step of the
    # acceleration leaves, a/omega^2.
    resolution = 0.01 * acceleration / (2.0 * pi * 45.0) ** 2
    assert response.residual_deviation == pytest.approx(residual, abs=resolution)
    assert response.t_end == pytest.approx(end + 0.5e-3, abs=1e-6)


def marlin_residual(
    a: float, move: Positioning, item: SetpointFilter, *, frequency_hz: float, zeta: float
) -> float:
    """What Marlin's Fixed-Time Motion leaves, as its source computes it.

    Positions every millisecond, summed with echoes that are whole samples, even steps in between:
    each sample is a step of velocity, and the mode answers to nothing else. Mean over where the
    move begins between two samples.
    """
    delays, shares = item.impulses
    echoes = [round(delay / 1e-3) for delay in delays]
    v = min(move.max_velocity, sqrt(a * move.distance))
    corners = np.array([0.0, v / a, move.distance / v, move.distance / v + v / a])
    pole = 2.0 * pi * frequency_hz * complex(-zeta, sqrt(1.0 - zeta**2))
    after = corners[-1] + delays[-1] + np.linspace(1e-3, 0.1, 2001)
    found = []
    for phase in np.linspace(0.0, 1e-3, 5, endpoint=False):
        t = np.arange(-100, 400) * 1e-3 - phase
        position = np.clip(t[:, None] - corners, 0.0, None) ** 2 @ np.array([a, -a, -a, a]) / 2.0
        shaped = np.zeros_like(t)
        for share, echo in zip(shares, echoes, strict=True):
            shaped[echo:] += share * position[: t.size - echo]
        steps = np.diff(shaped, 2) / 1e-3
        moved = np.abs(steps) > 1e-12
        swings = np.exp(pole * (after[:, None] - t[1:-1][moved])).imag / pole.imag
        found.append(float(np.abs(swings @ steps[moved]).max()))
    return float(np.mean(found))


@pytest.mark.parametrize(
    ("kind", "wanted"), [("marlin_zv", 41.3), ("marlin_mzv", 52.0), ("marlin_3hump_ei", 41.3)]
)
def test_marlin_as_its_source_computes_it(kind, wanted):
    """Else the sheet's promise is not what the samples of the firmware do."""
    machine, a = printer(), 11.7
    item = SetpointFilter(kind=kind, frequency_hz=wanted, damping_ratio=0.05)
    limits = replace(without_jerk_limit(machine, a), setpoint_filter=item)
    move = machine.moves[0]
    assert isinstance(move, Positioning)
    loop = tune_loop(machine).loops[0]
    response = simulate(loop, plan_setpoint(move, limits), drive=machine.drive, band=20e-6)
    expected = marlin_residual(a, move, item, frequency_hz=45.0, zeta=0.05)
    resolution = 0.02 * a / (2.0 * pi * 45.0) ** 2
    assert response.residual_deviation == pytest.approx(expected, abs=resolution)


def test_the_acceleration_judged_is_that_of_the_setpoint_behind_its_filter():
    """A motor follows the steps that come out of the filter, and loses them beyond its limit."""
    machine, item = printer(), SetpointFilter(kind="zvd", frequency_hz=48.0)
    move, limits = machine.moves[0], MotionLimits(acceleration=50.3, jerk=5030.0)
    setpoint = plan_setpoint(move, replace(limits, setpoint_filter=item))
    tuned = tune_loop(machine)
    response = simulate(tuned.loops[0], setpoint, drive=machine.drive, band=20e-6)
    profile = behind(profile_of(move, limits.acceleration, limits.jerk), item)
    asked = max(abs(profile.at(t)[2]) for t in np.linspace(0.0, profile.end, 4001))
    assert asked < 0.9 * limits.acceleration
    assert response.max_force == pytest.approx(asked, rel=1e-2)


def test_torque_that_falls_with_speed_bounds_acceleration_and_velocity():
    """Else the motor would lose steps where it is fastest."""

    def curve(*points):
        rows = ", ".join(f"{{ velocity = {v}, acceleration = {a} }}" for v, a in points)
        stated = 'max_acceleration = "20 m/s^2"\n'
        assert stated in PRINTER
        return PRINTER.replace(stated, f"{stated}acceleration_curve = [{rows}]\n")

    drive = parse_profile(curve((0.1, 30.0), (0.5, 10.0)), where="p").drive
    assert drive.max_force == pytest.approx(20.0)  # 20 at 0.3 m/s, between 30 and 10
    # A curve that sags before the largest velocity counts at its lowest.
    drive = parse_profile(curve((0.1, 30.0), (0.2, 8.0), (0.5, 19.0)), where="p").drive
    assert (drive.max_force, drive.force_velocity) == (8.0, 0.3)
    assert drive.max_velocity == 0.5
    (short,) = faults_of(curve((0.1, 30.0), (0.2, 8.0)))
    assert "got 0.3 m/s, but the motor follows only 0.2 m/s" in short


def faults_of(text: str) -> list[str]:
    with pytest.raises(InputError) as refused:
        parse_profile(text, where="p")
    return [str(fault).removeprefix("p:") for fault in refused.value.faults]


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('kind = "modal"', 'kind = "modal"\nmoving_mass = "1 kg"',
         'plant.moving_mass: belongs to drive.kind = "servo"; remove it, or state that kind of '
         "drive"),
        ('max_acceleration = "20 m/s^2"', "",
         "drive.max_acceleration: missing; add the value of your machine, for example "
         'max_acceleration = "10 m/s^2"'),
        ('max_acceleration = "20 m/s^2"', 'max_acceleration = "20 m/s^2"\nstep_rate = "1 kHz"',
         "drive.step_rate: says nothing alone: state step_length beside it, or remove it"),
        ('kind = "klipper"', 'kind = "klipper"\nposition_gain = "60 1/s"',
         'control.position_gain: drive.kind = "position_source" has no loop: the motor follows its '
         "setpoint; remove the key"),
        ('tcp_deviation = "20 um"', 'tcp_deviation = "20 um"\npayload = ["0 kg", "1 kg"]',
         "requirements.payload: a motor that follows its setpoint moves any payload alike, but "
         "each has frequencies of its own: remove the key, and widen "
         "requirements.frequency_spread"),
    ],
)  # fmt: skip
def test_keys_that_mean_nothing_here(old, new, fault):
    """Else somebody believes that a mass, a loop or a payload was looked at."""
    assert old in PRINTER
    faults = [text.split(": ", 1)[1] for text in faults_of(PRINTER.replace(old, new))]
    assert fault in faults


def test_record_tells_no_loop():
    """Gains and margins that nobody tuned must not be read off a record."""
    machine = printer()
    listed = replace(machine, requirements=replace(machine.requirements, every_size=False))
    found = commission(listed)
    part = loop_part(machine, found.plant, found.loop, found.disturbed)
    assert (part.Kv, part.Kp, part.Tn, part.worst_corner) == (None, None, None, None)
    assert (part.poles, part.corners, part.bode.t) == ([], [], [])
    assert part.closed_loop.states[0] == "plant.x"
    drive = {row.key: row.value for row in list_data(listed, found.plant, PRINTER)}
    assert drive["drive.kind"] == "position_source"
    assert drive["drive.max_acceleration"] == 20.0
    assert "drive.force_lag" not in drive
    # A rule tried with ramps of many cycles is not "no limit": its times come from that jerk.
    words = Catalogue(follows=True)
    for rule in limits_part(found).rules:
        said = say_jerk(rule.acceleration, rule.jerk, part.shortest_ramp, words)
        cycles = rule.acceleration / rule.jerk / part.position_cycle
        assert (said == "no limit") == (cycles <= 1.0001)


def test_the_model_for_python_control_moves_as_the_setpoint_says():
    """A servo's loop in its place would be what somebody at a prompt simulates."""
    machine = parse_profile(PRINTER, where="printer.toml")
    tuned = tune_loop(machine)
    model = tuned.model
    assert model.dt == machine.control.position_cycle
    assert abs(model["encoder", "x_ref"].dcgain()) == pytest.approx(1.0)
    assert abs(model["tcp", "x_ref"].dcgain()) == pytest.approx(1.0)
    poles = model.poles().astype(complex)
    rates = np.log(poles[np.abs(poles) > 1e-9]) / model.dt
    for mode in tuned.loops[0].plant.modes:  # held by the motor: there is no other frequency
        assert np.abs(np.abs(rates) - mode.natural_frequency).min() < 1e-6 * mode.natural_frequency


# The step of velocity at a corner against the residues of the same modes.


MODES = ((45.0, 0.04, 0.8), (97.0, 0.03, 0.2))


@pytest.mark.parametrize(
    "item",
    [
        None,
        SetpointFilter(kind="2hump_ei", frequency_hz=60.0, damping_ratio=0.1),
        SetpointFilter(kind="moving_average", time=0.02),
    ],
    ids=lambda item: item.kind if item else "none",
)
def test_corner_velocity_leaves_just_the_band(item):
    """If it failed, square_corner_velocity would ring beyond the band, or be needlessly small.

    Each copy of the step takes its part of dv off q'; an average spreads it evenly, here over a
    thousand copies. The phases of several modes are not known at a corner of the path, so their
    amplitudes add.
    """
    more = 'frequency_spread = "4 %"\ndamping_spread = "30 %"\n[control]\nkind = "klipper"\n'
    found = find_corner_velocity(axis(list(MODES), 10.0, more), item)
    delays, shares = map(np.array, item.impulses) if item else (np.zeros(1), np.ones(1))
    if item and item.averages:
        delays, shares = item.averages[0] * (np.arange(1000) + 0.5) / 1000, np.full(1000, 1e-3)
    worst = 0.0
    for u, v in product((0.96, 1.0, 1.04), (0.7, 1.0, 1.3)):
        left = 0.0
        for hertz, zeta, gain in MODES:
            omega, ratio = 2 * pi * hertz * u, zeta * v
            pole = omega * complex(-ratio, (1 - ratio**2) ** 0.5)
            swing = shares @ np.exp(pole * (delays.max() - delays)) / pole.imag
            left += gain * found * abs(swing)
        worst = max(worst, left)
    assert worst == pytest.approx(0.8 * 20e-6, rel=2e-3)
