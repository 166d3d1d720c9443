"""A tuned loop must be stable, have the stated margins, and its analysis must be right."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path

import control
import numpy as np
import pytest

from mtcommission.errors import ComputationError, Outcome
from mtcommission.loop.controller import filter_polynomials
from mtcommission.loop.frequency import frequency_response
from mtcommission.loop.tuning import TunedLoop, TuningSettings, tune_loop
from mtcommission.machine import (
    FilterKind,
    ForceFilter,
    Machine,
    Modal,
    StateFeedback,
    StateGain,
    TcpSensor,
    VelocityStep,
    moving_mass,
    vary,
)
from mtcommission.plant import Plant, build_plant
from mtcommission.profile import read_profile
from tests.independent_loop import axis_of, profile_of, quiet_copy, run
from tests.machines import paper_machine, random_modal_machine

PROFILES = sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))
WANTED = TuningSettings()


@cache
def tuned_paper() -> TunedLoop:
    return tune_loop(paper_machine())


def in_corners(seed: int) -> Machine:
    machine = random_modal_machine(seed, n_modes=1 + seed % 4)
    needs = replace(
        machine.requirements, frequency_spread=0.05, payload=(0.0, 0.2 * moving_mass(machine))
    )
    return replace(machine, requirements=needs)


def assert_tuned(tuned: TunedLoop) -> None:
    """Stable in every corner by the eigenvalues, margins by python-control."""
    for loop, lifted, response, analysis in zip(
        tuned.loops, tuned.lifted, tuned.responses, tuned.analyses, strict=True
    ):
        assert np.max(np.abs(np.linalg.eigvals(lifted.A))) < 1.0
        assert loop.controller is tuned.controller
        assert analysis.gain_margin_db >= WANTED.gain_margin_db
        assert analysis.phase_margin_deg >= WANTED.phase_margin_deg
        peak = np.max(1.0 / np.abs(1.0 + response.open_loop))
        assert peak == pytest.approx(analysis.sensitivity_peak)
        assert peak <= WANTED.sensitivity_peak


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_shipped_profiles_are_tuned_with_the_stated_margins(path: Path) -> None:
    assert_tuned(tune_loop(read_profile(path)))


@pytest.mark.parametrize("seed", range(60))
def test_random_machines_are_tuned_or_say_why_not(seed: int) -> None:
    """A user's machine would end in a loop without margins, or in a traceback."""
    machine = in_corners(seed)
    if seed >= 6:  # the nominal machine alone is quicker
        machine = replace(machine, requirements=paper_machine().requirements)
    if seed % 3 == 0:
        machine = quiet_copy(machine, tcp_sensor=TcpSensor.POSITION)
    assert_tuned(tune_loop(machine))


@pytest.mark.parametrize("sensor", TcpSensor)
def test_undamped_modes_end_in_a_loop_or_in_a_named_outcome(sensor: TcpSensor) -> None:
    """Riccati equations and resonances have singular points there."""
    ends: list[Outcome] = []
    for seed in range(4):
        machine = random_modal_machine(seed, n_modes=3)
        mechanics = machine.mechanics
        assert isinstance(mechanics, Modal)
        modes = tuple(
            replace(mode, damping_ratio=0.0 if i == seed % 3 else mode.damping_ratio)
            for i, mode in enumerate(mechanics.modes)
        )
        machine = replace(machine, mechanics=replace(mechanics, modes=modes))
        try:
            tuned = tune_loop(quiet_copy(machine, tcp_sensor=sensor))
        except ComputationError as error:
            ends.append(error.outcome)
        else:
            assert_tuned(tuned)
    assert set(ends) == {Outcome.UNDAMPED_MODE}


def test_poles_are_those_of_the_lifted_matrix() -> None:
    tuned = tuned_paper()
    lifted, poles = tuned.lifted[0], tuned.nominal.poles
    z = np.linalg.eigvals(lifted.A)
    for pole in poles:
        assert np.min(np.abs(z - np.exp(pole * lifted.dt))) < 1e-6
    # No mode with a time constant above a millisecond is left out.
    slow = z[np.abs(z) > np.exp(-lifted.dt / 1e-3)]
    assert all(np.min(np.abs(np.exp(poles * lifted.dt) - pole)) < 1e-6 for pole in slow)


def test_tower_rings_with_its_own_poles_since_the_encoder_does_not_see_it() -> None:
    """The paper's 72 Hz mode is driven, but no feedback from the encoder moves its poles."""
    tower = complex(-22.5, 452.21)
    assert np.min(np.abs(tuned_paper().nominal.poles - tower)) < 0.01


@pytest.mark.parametrize(
    "machine",
    [paper_machine(), random_modal_machine(3, n_modes=3), random_modal_machine(12, n_modes=2)],
    ids=["paper", "three modes", "two modes"],
)
def test_margins_agree_with_python_control(machine: Machine) -> None:
    tuned = tune_loop(machine)
    response, analysis = tuned.responses[0], tuned.nominal
    L = control.frd(response.open_loop, 2 * pi * response.frequency_hz, smooth=True, squeeze=False)
    gains, phases, *_ = control.stability_margins(L, returnall=True)
    theirs = min(abs(20 * np.log10(gain)) for gain in gains)
    assert analysis.gain_margin_db == pytest.approx(theirs, abs=0.05)
    assert analysis.phase_margin_deg == pytest.approx(min(map(abs, phases)), abs=0.1)


def open_loop_again(machine: Machine, plant: Plant, tuned: TunedLoop, z: complex) -> complex:
    """L from blocks sampled by python-control: plant by zero-order hold, filters by Tustin."""
    gains = tuned.controller
    h, N = gains.velocity_cycle, gains.cycles

    def at(system: control.StateSpace) -> complex:
        return complex(np.squeeze(control.evalfr(system, z)))

    def sampled(row: np.ndarray) -> control.StateSpace:
        continuous = control.ss(plant.A, plant.B[:, None], row[None, :], 0)
        return control.sample_system(continuous, h, method="zoh")

    encoder = plant.row("encoder")
    position, rate = at(sampled(encoder)), at(sampled(encoder @ plant.A))
    integral = h / gains.integral_time / (z - 1)
    zero_order_hold = sum(z**-k for k in range(N)) / N
    model = 1.0
    if gains.reference_model_time:
        fade = np.exp(-h / gains.reference_model_time)
        model = (1 - fade) / (z - fade)
    demand = gains.velocity_gain * (1 + integral) * rate
    demand += (
        gains.velocity_gain
        * (1 + integral * model)
        * gains.position_gain
        * z**-N
        * zero_order_hold
        * position
    )
    if gains.observer.states:
        o = gains.observer
        inputs = np.column_stack([o.B, o.L])
        estimator = control.ss(
            o.A - o.L @ o.C, inputs, gains.state_gains[None, list(o.states)], 0, h
        )
        measured = [1.0, *(at(sampled(plant.row(sensor))) for sensor in gains.sensors)]
        response = np.atleast_2d(control.evalfr(estimator, z))
        demand += complex((response @ np.array(measured))[0])
    for item in gains.force_filters:
        block = control.tf(*filter_polynomials(item))
        demand *= complex(control.sample_system(block, h, method="tustin")(z))
    return demand / z


@pytest.mark.parametrize("variant", ["plain", "two encoders", "filters", "reference model"])
def test_open_loop_agrees_with_blocks_of_python_control(variant: str) -> None:
    notch = ForceFilter(kind=FilterKind.NOTCH, natural_frequency=2 * pi * 50.0, damping=0.2)
    changes: dict[str, dict[str, object]] = {
        "plain": {},
        "two encoders": {"tcp_sensor": TcpSensor.POSITION},
        "filters": {"force_filters": (notch,)},
        "reference model": {"reference_model_time": 5e-3},
    }
    machine = quiet_copy(paper_machine(), **changes[variant])
    tuned = tune_loop(machine)
    plant, response = tuned.loops[0].plant, tuned.responses[0]
    for i in range(3, len(response.frequency_hz), 97):
        z = np.exp(2j * pi * response.frequency_hz[i] * tuned.controller.velocity_cycle)
        again = open_loop_again(machine, plant, tuned, z)
        assert response.open_loop[i] == pytest.approx(again, rel=1e-6)


def test_given_gains_are_used_as_given_and_poor_ones_warned() -> None:
    machine = quiet_copy(
        paper_machine(),
        position_gain=95.0,
        velocity_gain=150e3,
        integral_time=15e-3,
        state_feedback=StateFeedback.OFF,
    )
    tuned = tune_loop(machine)
    gains = tuned.controller
    assert (gains.position_gain, gains.velocity_gain, gains.integral_time) == (95.0, 150e3, 15e-3)
    assert tuned.nominal.is_stable
    assert "margins are poor" in tuned.warnings[0]


def test_good_given_gains_are_not_warned() -> None:
    cascade = quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)
    tuned = tune_loop(cascade).controller
    machine = quiet_copy(
        paper_machine(),
        position_gain=0.8 * tuned.position_gain,
        velocity_gain=0.8 * tuned.velocity_gain,
        integral_time=tuned.integral_time / 0.8,
        state_feedback=StateFeedback.OFF,
    )
    assert tune_loop(machine).warnings == ()


def test_unstable_gains_are_refused_and_really_unstable() -> None:
    machine = quiet_copy(
        paper_machine(),
        position_gain=400.0,
        velocity_gain=600e3,
        integral_time=4e-3,
        state_feedback=StateFeedback.OFF,
    )
    with pytest.raises(ComputationError, match="lower velocity_gain") as caught:
        tune_loop(machine)
    assert caught.value.outcome is Outcome.UNSTABLE_LOOP
    gains = replace(
        tune_loop(quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)).controller,
        position_gain=400.0,
        velocity_gain=600e3,
        integral_time=4e-3,
    )
    move = VelocityStep(velocity_step=0.01)
    profile = profile_of(move, 1.0, 100.0)
    motion = run(machine, gains, profile, nominal=machine, samples=4000)
    e = np.abs(motion.tool - motion.reference)
    assert np.max(e[3200:]) > 1.3 * np.max(e[1600:2400]) > 1.3 * np.max(e[800:1600])


def test_phi_needs_a_sensor_near_the_tool() -> None:
    """The encoder does not see the tower: a gain on it would be faked."""
    gain = (StateGain(state="phi", value=1e5),)
    blind = quiet_copy(paper_machine(), state_feedback=StateFeedback.GIVEN, state_gains=gain)
    with pytest.raises(ComputationError, match="phi") as caught:
        tune_loop(blind)
    assert caught.value.outcome is Outcome.NOT_OBSERVABLE
    seeing = tune_loop(quiet_copy(blind, tcp_sensor=TcpSensor.POSITION))
    assert seeing.controller.state_gains[build_plant(blind).states.index("phi")] == 1e5


def test_second_encoder_damps_the_tower() -> None:
    """Notes to the paper: feedback of phi raises its damping from 0.05 to about 0.18."""
    machine = quiet_copy(paper_machine(), tcp_sensor=TcpSensor.POSITION)
    tuned = tune_loop(machine)
    tower = tuned.loops[0].plant.modes[1]
    poles = tuned.nominal.poles
    near = poles[np.abs(np.abs(poles.imag) - tower.natural_frequency) < 100.0]
    assert near.size
    if tuned.controller.state_gains[tower.deflection]:
        assert np.min(-near.real / np.abs(near)) > 1.5 * tower.damping_ratio


def test_bandwidth_out_of_reach_is_said() -> None:
    with pytest.raises(ComputationError) as caught:
        tune_loop(quiet_copy(paper_machine(), minimum_bandwidth_hz=200.0))
    assert caught.value.outcome is Outcome.BANDWIDTH_OUT_OF_REACH
    assert "200 Hz" in str(caught.value)


def test_compliance_is_the_answer_to_a_slow_push() -> None:
    """Disturbance stiffness stands beside the settling time so that a soft loop cannot hide."""
    machine = paper_machine()
    tuned = tuned_paper()
    response = tuned.responses[0]
    # With an integrator the tool is pushed only by what the encoder does not see: the tower
    # bends by h r / k per newton.
    tower = axis_of(machine).modes[1]
    static = tower.tool / abs(tower.pole) ** 2
    assert abs(response.compliance[0]) < 3 * static + 1e-9
    least = np.argmax(np.abs(response.compliance))
    assert tuned.nominal.dynamic_stiffness == pytest.approx(1 / np.abs(response.compliance[least]))


def test_corner_loops_are_those_of_the_varied_machine() -> None:
    machine = in_corners(5)
    tuned = tune_loop(machine)
    for corner, response in zip(tuned.corners, tuned.responses, strict=True):
        again = frequency_response(build_plant(vary(machine, corner)), tuned.controller)
        assert np.array_equal(again.open_loop, response.open_loop)
