"""A tuned loop must be stable, have the stated margins, and its analysis must be right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.loop.analysis import mode_poles
from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.loop.model.diagram import check_by_blocks
from mtcommission.loop.tuning import family, gains
from mtcommission.loop.tuning.family import (
    build,
    cascade_family,
    integral_gain,
    propose_cascades,
    propose_feedback,
    tune_shape,
)
from mtcommission.loop.tuning.gains import observer_gains, regulator_gains, symmetrical_optimum
from mtcommission.loop.tuning.tuned import (
    CLASSIC,
    TUNING,
    Shape,
    TunedLoop,
    close_loop,
    corner_plants,
    has_margins,
)
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import read_profile
from mtcommission.machine.profile.shipped import read_shipped, shipped_names
from mtcommission.machine.readers import SignalValue
from tests.independent_loop import Profile, quiet_copy, run
from tests.machines import paper_machine, random_modal_machine

SERVOS = [
    name
    for name in shipped_names()
    if not read_shipped(name).machine.drive.follows  # no loop: tests/test_position_source.py
]


def in_corners(seed: int) -> Machine:
    machine = random_modal_machine(seed, n_modes=1 + seed % 4)
    needs = replace(
        machine.requirements, frequency_spread=0.05, payload=(0.0, 0.2 * moving_mass(machine))
    )
    return replace(machine, requirements=needs)


def assert_tuned(tuned: TunedLoop) -> None:
    """Stable in every corner by the eigenvalues, margins by python-control."""
    for loop, response, analysis in zip(tuned.loops, tuned.responses, tuned.analyses, strict=True):
        assert np.max(np.abs(np.linalg.eigvals(loop.lifted.A))) < 1.0
        assert loop.controller is tuned.controller
        assert analysis.gain_margin_db >= TUNING.gain_margin_db
        assert analysis.phase_margin_deg >= TUNING.phase_margin_deg
        peak = np.max(1.0 / np.abs(1.0 + response.open_loop))
        assert peak == pytest.approx(analysis.sensitivity_peak)
        assert peak <= TUNING.sensitivity_peak


@pytest.mark.parametrize("seed", [*range(4), *range(6, 14)])
def test_random_machines_are_tuned_or_say_why_not(seed):
    """A user's machine would end in a loop without margins, or in a traceback."""
    machine = in_corners(seed)
    if seed >= 6:  # the nominal machine alone is quicker
        machine = replace(machine, requirements=paper_machine().requirements)
    if seed % 3 == 0:
        machine = quiet_copy(machine, has_tcp_sensor=True)
    assert_tuned(tune_loop(machine))


@pytest.mark.parametrize(
    "machine", [paper_machine(), random_modal_machine(3, n_modes=3)], ids=["paper", "three modes"]
)
def test_margins_and_poles_are_those_of_python_control(machine):
    """Of the block diagram, which only its definitions share with what tunes."""
    tuned = tune_loop(machine)
    found = check_by_blocks(tuned.loops[0], tuned.responses[0].frequency_hz)
    assert found.gain_margin_db == pytest.approx(tuned.nominal.gain_margin_db, abs=1e-5)
    assert found.phase_margin_deg == pytest.approx(tuned.nominal.phase_margin_deg, abs=1e-5)
    assert found.pole_difference < 1e-10


def test_phi_needs_a_sensor_near_the_tool():
    """The encoder does not see the tower: a gain on it would be faked."""
    gain = (SignalValue(name="phi", value=1e5),)
    blind = quiet_copy(paper_machine(), state_feedback=StateFeedback.GIVEN, state_gains=gain)
    with pytest.raises(ComputationError, match="phi") as caught:
        tune_loop(blind)
    assert caught.value.outcome is Outcome.NOT_OBSERVABLE
    seeing = tune_loop(quiet_copy(blind, has_tcp_sensor=True))
    assert seeing.controller.state_gains[build_plant(blind).states.index("phi")] == 1e5


def follow_pole(machine: Machine, tuned: TunedLoop, start: complex) -> complex:
    """Where a pole of the cascade goes while the state feedback is turned up: root locus."""
    bench, pole = corner_plants(machine), start
    for share in np.linspace(0.02, 1.0, 50):
        gains = replace(tuned.controller, state_gains=share * tuned.controller.state_gains)
        poles = close_loop(bench, gains).nominal.poles
        pole = complex(poles[np.argmin(np.abs(poles - pole))])
    return pole


@pytest.mark.parametrize(
    "machine", [paper_machine(), random_modal_machine(3, n_modes=1)], ids=["paper", "random"]
)
def test_shown_damping_is_that_of_the_mode_and_not_of_the_observer(machine, monkeypatch):
    """A pole of the observer beside a mode would be shown as its damping, and chosen by it."""
    monkeypatch.setattr(family, "TUNING", replace(TUNING, mode_weights=(0.1,)))
    tuned = tune_loop(machine)
    observer, plant = tuned.controller.observer, tuned.loops[0].plant
    assert observer.states
    own = np.linalg.eigvals(observer.A - observer.L @ observer.C)
    lifted = np.linalg.eigvals(tuned.loops[0].lifted.A)
    for z in own**tuned.controller.cycles:  # separation principle
        assert np.min(np.abs(lifted - z)) < 1e-6
    cascade = replace(tuned.controller, state_gains=np.zeros(plant.order))
    without = mode_poles(close_loop(corner_plants(machine), cascade).loops[0])
    for start, shown in zip(without, mode_poles(tuned.loops[0]), strict=True):
        pole = follow_pole(machine, tuned, complex(start))
        assert shown.real / abs(shown) == pytest.approx(pole.real / abs(pole), rel=1e-6)


@pytest.mark.parametrize("name", SERVOS)
def test_proposed_loops_keep_margins_stiffness_and_integral_gain(name):
    """A loop that settles sooner but yields to the cutting force would be recommended."""
    cascades = cascade_family(read_shipped(name).machine)
    found = propose_cascades(cascades)
    classic = found.classic
    assert classic is not None
    assert found.loops[0] is classic
    for proposal in found.loops:
        share = integral_gain(proposal.controller) / integral_gain(classic.controller)
        assert share >= TUNING.least_integral_share
    fed_back = propose_feedback(cascades, classic, [CLASSIC]).loops
    assert all(proposal.controller.state_gains.any() for proposal in fed_back)
    for proposal in (*found.loops, *fed_back):
        assert_tuned(proposal)
        assert proposal.least_stiffness >= classic.least_stiffness
        gains = proposal.controller  # those that are typed in
        for gain in (gains.position_gain, gains.velocity_gain, gains.integral_time):
            assert gain == float(f"{gain:.4g}")


@pytest.mark.parametrize("name", SERVOS[::3])
def test_one_step_more_of_Kp_lacks_the_margins(name):
    """Kp would be lower than need be, and the axis softer: seen by the whole loop."""
    machine = read_shipped(name).machine
    free = replace(machine.control, velocity_gain=None, position_gain=None, integral_time=None)
    machine = replace(machine, control=replace(free, force_filters=(), minimum_bandwidth_hz=0.0))
    family = cascade_family(machine)
    for shape in (CLASSIC, Shape(position_ratio=0.125, integral_ratio=16.0)):
        tuned = tune_shape(family, shape, largest=4.0)
        assert tuned is not None
        assert all(has_margins(item) for item in tuned.analyses)
        share = tuned.controller.velocity_gain / symmetrical_optimum(machine)
        assert share < 4.0
        above = build(family, shape, fraction=1.01 * share)
        analyses = close_loop(family.bench, above).analyses
        assert not all(has_margins(item) for item in analyses)


def test_integral_gain_is_what_a_lasting_force_displaces_over_time():
    """The area under the disturbance response, of the encoder's part: one over Kp Kv / Tn."""
    machine = quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)
    tuned = tune_loop(machine)
    push = 100.0
    rest = Profile(knots=(0.0,), jerks=(0.0,))
    motion = run(machine, tuned.controller, rest, nominal=machine, samples=8000, push=push)
    area = float(np.sum(motion.encoder)) * tuned.controller.velocity_cycle
    assert area == pytest.approx(push / integral_gain(tuned.controller), rel=1e-3)


def test_second_encoder_damps_the_tower():
    """Feedback of phi, which only a second encoder sees, must raise its damping from 0.05."""
    tuned = tune_loop(quiet_copy(paper_machine(), has_tcp_sensor=True))
    tower = tuned.loops[0].plant.modes[1]
    assert tuned.controller.state_gains[tower.deflection] != 0.0
    assert tuned.nominal.mode_damping[1] > 2.0 * tower.damping_ratio


def test_no_sine_moves_the_tool_more_than_the_dynamic_stiffness_says():
    """The stiffness in the table and the curve beside it would contradict each other."""
    tuned = tune_loop(paper_machine())
    answer = simulate_disturbance(tuned.loops[0], duration=1.0)
    # The step's derivative is the impulse response; its transform is the compliance.
    T_v = tuned.controller.velocity_cycle
    impulse = np.diff(answer.deflection) / T_v
    omega = 2 * np.pi * tuned.nominal.weakest_frequency_hz
    compliance = abs(np.sum(impulse * np.exp(-1j * omega * answer.t[1:])) * T_v)
    assert compliance == pytest.approx(1.0 / tuned.nominal.dynamic_stiffness, rel=0.01)
    assert np.sum(answer.deflection) > 0.0  # it yields the way it is pushed


# Wrong gains would make a loop that the tables call best by a rule it does not follow.


MACHINES = {
    "paper": paper_machine(),
    "two encoders": quiet_copy(paper_machine(), has_tcp_sensor=True),
    "belt": read_profile(Path("tests/data/belt-servo.toml")),
    "one mode": random_modal_machine(3, n_modes=1),
    "population": random_machine(3),
}


@pytest.mark.parametrize("name", MACHINES)
def test_gains_are_those_of_python_control(name, monkeypatch):
    """Every equation of a whole tuning, solved by a second program."""
    asked = []

    def regulator(A, B, Q):
        ours = regulator_gains(A, B, Q)
        theirs, _, _ = control.lqr(A, B[:, None], Q, np.eye(1))
        asked.append(np.max(np.abs(ours - theirs[0])) / np.max(np.abs(theirs)))
        return ours

    def observer(A, G, C):
        ours = observer_gains(A, G, C)
        theirs, _, _ = control.dlqe(A, G, C, np.eye(G.shape[1]), np.eye(len(C)))
        asked.append(np.max(np.abs(ours - theirs)) / np.max(np.abs(theirs)))
        return ours

    monkeypatch.setattr(gains, "regulator_gains", regulator)
    monkeypatch.setattr(gains, "observer_gains", observer)
    auto = quiet_copy(MACHINES[name], state_feedback=StateFeedback.AUTO)
    tune_loop(auto)
    assert len(asked) >= 3  # the observer and both weights
    assert max(asked) < 1e-8


def test_what_nothing_damps_has_no_gains():
    """An oscillator beside the drive would get gains that leave it ringing, without a word."""
    A = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    B, Q = np.array([0.0, 0.0, 1.0]), np.eye(3)
    with pytest.raises(np.linalg.LinAlgError, match="damps every state"):
        regulator_gains(A, B, Q)
    with pytest.raises(np.linalg.LinAlgError, match="not finite"):
        regulator_gains(A, B, np.diag([1.0, np.inf, 1.0]))
