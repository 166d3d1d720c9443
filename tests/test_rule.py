"""The commissioning rule: its formulas against the loop, its promise on random machines."""

from __future__ import annotations

import re
from cmath import exp, sqrt
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from benchmarks.population import random_machine
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.commissioning_rule.estimate import (
    duration,
    echo,
    estimate_axis,
    ramp_vibration,
    servo_parts,
)
from mtcommission.limits.commissioning_rule.rule import RuleResult, apply_commissioning_rule
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb
from mtcommission.loop.simulate.response import simulate
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.machine import (
    Control,
    Drive,
    Machine,
    Modes,
    Peak,
    Positioning,
    Requirements,
    StateFeedback,
    VelocityStep,
    moving_mass,
)
from mtcommission.machine.mechanics import FlexibleMode
from mtcommission.messages.catalogue import Catalogue
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import read_profile
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint, reached_acceleration, sample_setpoint
from mtcommission.verdict.evaluate import evaluate
from tests.machines import paper_machine

WIDE = Modes(surface=1e-6, accuracy=1e-6, speed=1e-6)


def stiff_axis(
    *, lag: float, position_cycle: float = 2e-3, velocity_cycle: float = 125e-6
) -> Machine:
    """An axis whose tool does not vibrate: what is left is the servo's own tail."""
    stiff = FlexibleMode(name="s", natural_frequency=2500.0, damping_ratio=0.5, tcp_gain=1e-12)
    return Machine(
        name="stiff",
        axis="X",
        source="test",
        mechanics=Modal(moving_mass=500.0, modes=(stiff,)),
        drive=Drive(force_lag=lag, max_force=1e5),
        moves=(VelocityStep(velocity_step=0.5),),
        requirements=Requirements(tcp_deviation=1e-7, modes=WIDE),
        control=Control(
            state_feedback=StateFeedback.OFF,
            position_cycle=position_cycle,
            velocity_cycle=velocity_cycle,
        ),
    )


def apply(machine: Machine) -> tuple[RuleResult, TunedLoop]:
    tuned = tune_loop(machine)
    return apply_commissioning_rule(machine, build_plant(machine), tuned), tuned


@pytest.mark.parametrize(("cycles", "damping"), [(0.3, 0.0), (0.8, 0.02), (1.0, 0.05), (2.1, 0.1)])
def test_ramp_vibration_against_an_integrated_oscillator(cycles: float, damping: float) -> None:
    """If it failed, the chart would promise a rest that does not come."""
    omega = 2 * pi * 40.0
    t_j = cycles * 2 * pi / omega

    def rates(t: float, y: np.ndarray) -> list[float]:
        push = min(t / t_j, 1.0)
        return [y[1], push * omega**2 - 2 * damping * omega * y[1] - omega**2 * y[0]]

    end = solve_ivp(rates, (0.0, t_j), [0.0, 0.0], rtol=1e-9, atol=1e-12).y[:, -1]
    # Amplitude of the free vibration about the static deflection 1, as a pole's residue; a jerk
    # step 1/t_j alone leaves 1/(omega t_j sqrt(1 - zeta^2)).
    p = omega * (-damping + 1j * sqrt(1 - damping**2))
    residue = abs((end[1] - p.conjugate() * (end[0] - 1.0)) / p.imag)
    single = 1.0 / (omega * t_j * sqrt(1 - damping**2).real)
    expected = ramp_vibration(cycles, damping=damping, spread=0.0)
    assert residue / single == pytest.approx(expected, rel=0.02 + damping)


@given(st.floats(0.05, 3.5), st.floats(0.0, 0.1), st.floats(0.0, 0.2))
@settings(max_examples=100, deadline=None)
def test_ramp_vibration_is_the_worst_of_the_spread(
    cycles: float, damping: float, spread: float
) -> None:
    """If it failed, a machine inside the stated spread could vibrate more than predicted."""
    hull = ramp_vibration(cycles, damping=damping, spread=spread)
    for factor in np.linspace(1 - spread, 1 + spread, 9):
        one = abs(1 - exp(2 * pi * cycles * factor * (-damping + 1j)))
        assert one <= hull * (1 + 1e-9) + 1e-12
    assert hull <= 2.0


@pytest.mark.parametrize(
    ("lag", "position_cycle", "velocity_cycle"),
    [(2.5e-3, 2e-3, 125e-6), (4e-3, 1e-3, 125e-6), (1e-3, 4e-3, 500e-6), (1.5e-3, 2e-3, 250e-6)],
)
def test_following_error_transient_against_the_loop(
    lag: float, position_cycle: float, velocity_cycle: float
) -> None:
    """If it failed, the tail that binds most stiff machines would be misjudged.

    Where a ramp takes two to six times the loop's own time, its second jerk step meets the swing
    of the first: a rule for one step alone would promise two thirds of what is left there.
    """
    machine = stiff_axis(lag=lag, position_cycle=position_cycle, velocity_cycle=velocity_cycle)
    tuned = tune_loop(machine)
    axis = estimate_axis(machine, build_plant(machine), tuned.controller)
    omega_v = tuned.controller.velocity_gain / tuned.controller.feedforward_mass
    shares = []
    for ramp in (0.7, 2.0, 4.0, 6.0, 20.0):
        limits = MotionLimits(acceleration=2.0, jerk=2.0 * omega_v / ramp)
        response = simulate(
            tuned.loops[0],
            plan_setpoint(machine.moves[0], limits),
            drive=machine.drive,
            band=machine.requirements.tcp_deviation,
        )
        tail, _ = servo_parts(axis, limits.jerk_time)
        shares.append(response.residual_deviation / (limits.jerk * tail))
    # The parts have signs, the rule adds their sizes: it may exceed the loop, not the reverse.
    assert max(shares) < 1.05
    assert max(shares[1:4]) > 0.6


def test_velocity_setpoint_meets_the_encoder_while_accelerating() -> None:
    """Half a velocity cycle too early would drag a T_v/(2 Kv), which the rule does not know."""
    machine = stiff_axis(lag=1.5e-3, position_cycle=4e-3, velocity_cycle=500e-6)
    tuned = tune_loop(machine)
    move = VelocityStep(velocity_step=2.0)
    setpoint = plan_setpoint(move, MotionLimits(acceleration=2.0, jerk=200.0))
    response = simulate(tuned.loops[0], setpoint, drive=machine.drive, band=1e-7)
    late = response.t - tuned.controller.reference_delay
    drag = response.deviation[(late > 0.7) & (late < 0.9)]
    assert np.all(sample_setpoint(setpoint, np.array([0.7, 0.9]))[:, 2] == pytest.approx(2.0))
    half_a_cycle = 2.0 * 250e-6 / tuned.controller.position_gain
    assert abs(float(np.mean(drag))) < 0.02 * half_a_cycle


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5])
def test_rule_meets_the_band_on_random_machines(seed: int) -> None:
    """If it failed, the sheet would print a rule that does not do what it is for."""
    machine = random_machine(seed)
    found, tuned = apply(machine)
    candidate = evaluate(machine, build_plant(machine), tuned, found.limits)
    assert candidate.assessment.is_met
    assert candidate.settling_time == pytest.approx(found.predicted_settling_time, abs=1e-9)


def test_rule_on_the_papers_machine_meets_the_band() -> None:
    """If it failed, the rule would fail on the one machine that everybody looks at."""
    machine = paper_machine()
    machine = replace(machine, control=Control(state_feedback=StateFeedback.OFF))
    found, tuned = apply(machine)
    assert evaluate(machine, build_plant(machine), tuned, found.limits).assessment.is_met


@pytest.mark.parametrize("seed", [4, 9, 17])
def test_twice_the_mass_with_twice_the_force_is_the_same_motion(seed: int) -> None:
    """If it failed, the rule would not be dimensionally sound."""
    machine = random_machine(seed)
    mechanics = machine.mechanics
    assert isinstance(mechanics, Modal)
    modes = tuple(
        replace(mode, tcp_gain=mode.tcp_gain / 2, measured_gain=mode.measured_gain / 2)
        for mode in mechanics.modes
    )
    low, high = machine.requirements.payload
    double = replace(
        machine,
        mechanics=Modal(moving_mass=2 * moving_mass(machine), modes=modes),
        drive=replace(machine.drive, max_force=2 * machine.drive.max_force),
        requirements=replace(machine.requirements, payload=(2 * low, 2 * high)),
    )
    one, two = apply(machine)[0].limits, apply(double)[0].limits
    assert two.acceleration == pytest.approx(one.acceleration, rel=1e-6)
    assert two.jerk == pytest.approx(one.jerk, rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_the_acceleration_is_reached_and_the_band_predicted(seed: int) -> None:
    """If it failed, the printed a would be a number that no move ever sees."""
    machine = random_machine(seed)
    found, _ = apply(machine)
    for move in machine.moves:
        reached = reached_acceleration(
            move, acceleration=found.limits.acceleration, jerk=found.limits.jerk
        )
        assert reached == pytest.approx(found.limits.acceleration, rel=1e-6)
    assert found.best.residual_deviation <= machine.requirements.tcp_deviation * (1 + 1e-9)
    shortest = min(candidate.duration for candidate in found.tried)
    assert found.predicted_settling_time >= shortest


def test_a_wider_band_is_never_slower() -> None:
    """If it failed, roughing limits could be lower than finishing limits."""
    machine = random_machine(12)
    times = []
    for band in (2e-6, 5e-6, 2e-5, 1e-4):
        needs = replace(machine.requirements, tcp_deviation=band)
        times.append(apply(replace(machine, requirements=needs))[0].predicted_settling_time)
    assert times == sorted(times, reverse=True)


def test_the_steps_suffice_to_calculate_the_residual_by_hand() -> None:
    """If it failed, the sheet's hand calculation would lack a line or show another number."""
    machine = random_machine(5)
    found, tuned = apply(machine)
    mechanics, gains = machine.mechanics, tuned.controller
    assert isinstance(mechanics, Modal)
    steps = {Catalogue().say(step.name): step.value for step in found.steps}
    omega_v, t_j = gains.velocity_gain / gains.feedforward_mass, found.limits.jerk_time
    assert steps["speed loop ω_v"] == pytest.approx(omega_v, rel=0.3)  # largest mass counts
    parts = [
        steps["jerk sensitivity C_S of the servo"],
        steps["jerk sensitivity C_P by the payload"],
    ]
    for mode in mechanics.modes:
        sensitivity = steps[f"jerk sensitivity C of mode {mode.name}"]
        pull = gains.feedforward_mass * mode.measured_gain
        if pull:
            widened = pull * min(1.0, omega_v / mode.natural_frequency)
            shown = steps[f"spread of mode {mode.name} beyond the stated one"]
            assert shown == pytest.approx(
                min(widened, 0.5 - machine.requirements.frequency_spread), rel=1e-9
            )
        parts.append(sensitivity * steps[f"vibration V of mode {mode.name}"])
    by_hand = found.limits.jerk * float(np.sqrt(np.sum(np.square(parts))))
    assert by_hand == pytest.approx(steps["predicted residual"], rel=1e-9)
    assert found.limits.acceleration == pytest.approx(found.limits.jerk * t_j, rel=1e-12)


def test_what_the_rule_does_not_know_is_said() -> None:
    """If it failed, the sheet would print the rule where it was never tried."""
    machine = random_machine(3)
    assert not apply(machine)[0].warnings
    needs = replace(machine.requirements, peaks=(Peak(name="v", bound=1.0),))
    control = replace(machine.control, moving_average_time=0.02, velocity_feedforward=0.9)
    warnings = apply(replace(machine, requirements=needs, control=control))[0].warnings
    assert len(warnings) == 3


@pytest.mark.parametrize("cycles", [0.4, 0.9, 1.7])
@pytest.mark.parametrize(
    "move",
    [
        VelocityStep(velocity_step=0.3),
        Positioning(distance=0.15, max_velocity=0.4),
        Positioning(distance=0.06),
    ],
)
def test_no_setpoint_leaves_more_than_ramp_and_echo(
    move: VelocityStep | Positioning, cycles: float
) -> None:
    """If it failed, a motion could vibrate more than the rule counts on."""
    machine = replace(random_machine(0), moves=(move,))
    axis = estimate_axis(machine, build_plant(machine), tune_loop(machine).controller)
    for mode in axis.modes:
        omega, zeta = 2 * pi * mode.frequency_hz, mode.damping
        p = omega * (-zeta + 1j * sqrt(1 - zeta**2))
        t_j = cycles / mode.frequency_hz
        limits = MotionLimits(acceleration=1.3, jerk=1.3 / t_j)
        setpoint = plan_setpoint(move, limits)
        left = abs(
            sum(
                step * exp(p * (setpoint.duration - t))
                for t, step in zip(setpoint.knot_times, setpoint.jerk_steps, strict=True)
            )
        )
        ramp = ramp_vibration(cycles, damping=zeta, spread=0.0)
        # The oscillator's damped frequency differs from the undamped one by zeta^2/2.
        allowed = ramp + pi * cycles * zeta**2
        assert left <= limits.jerk * allowed * echo(machine, mode, 1.3) * (1 + 1e-6)
        assert duration(move, limits) == pytest.approx(setpoint.duration, rel=1e-9)


DOC = Path(__file__).parent.parent / "docs" / "commissioning-rule.md"


def example_of_the_document(folder: Path) -> Machine:
    """The profile in the document, as a reader saves it."""
    found = re.search(r"```toml\n(.*?)```", DOC.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert found is not None
    path = folder / "example.toml"
    path.write_text(found[1], encoding="utf-8")
    return read_profile(path)


def test_the_example_by_hand_gives_what_the_program_gives(tmp_path: Path) -> None:
    """If it failed, an engineer with a pocket calculator would get other limits than the sheet."""
    found, tuned = apply(example_of_the_document(tmp_path))
    # Once more from the document's text alone, with its numbers.
    Kp, m, T, F, v, e = 88889.0, 400.0, 2e-3, 2e3, 0.2, 4e-6
    assert tuned.controller.velocity_gain == pytest.approx(Kp, rel=1e-5)
    omega = 2 * pi * 40.0 * 0.97
    C, C_S = m * 0.002 / omega**3, 0.4 * T**2 * 1.5 * m / Kp
    by_force = F / (1.17 * m + Kp * 1e-3 / 2)
    decayed = 1 + np.exp(-omega * 0.03 * v / by_force)
    times = {"no cancelling": np.sqrt(v * 1.25 * np.hypot(C_S, 2 * C * decayed) / e)}
    for k in (1, 2, 3):
        times[f"{k} period{'s' if k > 1 else ''} of column"] = k / 40.0
    for candidate in found.tried:
        t_j = times[Catalogue().say(candidate.name)]
        low, high = 40.0 * t_j * 0.97, 40.0 * t_j * 1.03
        left, gone = np.exp(-2 * pi * 0.03 * low), 1 - np.exp(-2 * pi * 0.03 * high)
        S = max(abs(np.sin(pi * low)), abs(np.sin(pi * high)))
        R = np.sqrt(gone**2 + 4 * left * S**2)
        by_band = e * t_j / (1.25 * np.hypot(C_S, C * R * decayed))
        a = min(by_force, by_band, v / t_j)
        assert candidate.limits.acceleration == pytest.approx(a, rel=2e-3), candidate.name
        assert candidate.duration == pytest.approx(v / a + t_j, rel=2e-3), candidate.name
        text = f"| **{1e3 * (v / a + t_j):.1f} ms** |" if candidate == found.best else ""
        assert text in DOC.read_text(encoding="utf-8")


def test_the_example_prints_what_is_simulated(tmp_path: Path) -> None:
    """If it failed, the document would promise figures that nobody finds again."""
    machine = example_of_the_document(tmp_path)
    plant = build_plant(machine)
    found, tuned = apply(machine)
    candidate = evaluate(machine, plant, tuned, found.limits)
    force = next(check for check in candidate.assessment.checks if check.name == "set force")
    text = " ".join(DOC.read_text(encoding="utf-8").split())
    assert (
        f"Simulated: {1e3 * candidate.settling_time:.1f} ms, "
        f"{1e6 * candidate.residual_deviation:.2f} µm, "
        f"{force.value:.0f} N of 2000 N."
    ) in text
    searched = choose_limits(machine, plant, tuned).limits
    best = evaluate(machine, plant, tuned, searched).settling_time
    cost = 100.0 * (candidate.settling_time / best - 1.0)
    assert (
        f"The search finds {1e3 * best:.1f} ms with {searched.acceleration:g} m/s² and "
        f"{searched.jerk:g} m/s³: the rule costs {cost:.0f} % here."
    ) in text
    naive = next(
        item
        for item in apply_rules_of_thumb(machine, plant)
        if item.name.kind == "rule-of-thumb-periods"
    )
    other = evaluate(machine, plant, tuned, naive.limits)
    assert (
        f"leaves {1e6 * other.residual_deviation:.1f} µm and settles after "
        f"{1e3 * other.settling_time:.1f} ms"
    ) in text
