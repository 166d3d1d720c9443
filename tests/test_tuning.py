"""A tuned loop must be stable, have the stated margins, and its analysis must be right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import ComputationError, Outcome
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.loop.analysis import mode_poles
from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.loop.model.diagram import check_by_blocks
from mtcommission.loop.tuning import family, gains
from mtcommission.loop.tuning.family import (
    cascade_family,
    integral_gain,
    propose_cascades,
    propose_feedback,
    tune_shape,
)
from mtcommission.loop.tuning.gains import build_cascade, design_observer, is_seen
from mtcommission.loop.tuning.tuned import CLASSIC, TUNING, TunedLoop, close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import (
    StateFeedback,
)
from mtcommission.machine.machine import Machine, moving_mass
from mtcommission.machine.moves import VelocityStep
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import read_profile
from mtcommission.machine.readers import SignalValue
from tests.independent_loop import Profile, profile_of, quiet_copy, run
from tests.machines import paper_machine, random_modal_machine

PROFILES = [
    path
    for path in sorted((Path(__file__).parent.parent / "profiles").glob("*.toml"))
    if not read_profile(path).drive.follows  # no loop: tests/test_position_source.py
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


@pytest.mark.parametrize("seed", range(60))
def test_random_machines_are_tuned_or_say_why_not(seed: int) -> None:
    """A user's machine would end in a loop without margins, or in a traceback."""
    machine = in_corners(seed)
    if seed >= 6:  # the nominal machine alone is quicker
        machine = replace(machine, requirements=paper_machine().requirements)
    if seed % 3 == 0:
        machine = quiet_copy(machine, has_tcp_sensor=True)
    assert_tuned(tune_loop(machine))


@pytest.mark.parametrize("has_sensor", [False, True])
def test_undamped_modes_end_in_a_loop_or_in_a_named_outcome(*, has_sensor: bool) -> None:
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
            tuned = tune_loop(quiet_copy(machine, has_tcp_sensor=has_sensor))
        except ComputationError as error:
            ends.append(error.outcome)
        else:
            assert_tuned(tuned)
    # State feedback damps what a second encoder sees.
    assert set(ends) == ({Outcome.UNDAMPED_MODE} if not has_sensor else set())


@pytest.mark.parametrize(
    "machine",
    [paper_machine(), random_modal_machine(3, n_modes=3), random_modal_machine(12, n_modes=2)],
    ids=["paper", "three modes", "two modes"],
)
def test_margins_and_poles_are_those_of_python_control(machine: Machine) -> None:
    """Of the block diagram, which only its definitions share with what tunes."""
    tuned = tune_loop(machine)
    found = check_by_blocks(tuned.loops[0], tuned.responses[0].frequency_hz)
    assert found.gain_margin_db == pytest.approx(tuned.nominal.gain_margin_db, abs=1e-5)
    assert found.phase_margin_deg == pytest.approx(tuned.nominal.phase_margin_deg, abs=1e-5)
    assert found.pole_difference < 1e-10


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_gain_margins_are_where_the_loop_becomes_unstable(direction: float) -> None:
    """A drive whose force constant is off by the margin would be called stable, or not."""
    machine = quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)
    tuned, bench = tune_loop(machine), corner_plants(machine)
    margin = tuned.nominal.gain_margin_up_db if direction > 0 else tuned.nominal.gain_margin_down_db
    for share, stable in ((0.97, True), (1.03, False)):
        factor = 10 ** (direction * share * margin / 20)
        gains = replace(tuned.controller, velocity_gain=factor * tuned.controller.velocity_gain)
        assert close_loop(bench, gains).nominal.is_stable is stable


def test_unstable_gains_are_refused_and_really_unstable() -> None:
    machine = quiet_copy(
        paper_machine(),
        position_gain=400.0,
        velocity_gain=600e3,
        integral_time=4e-3,
        state_feedback=StateFeedback.OFF,
    )
    with pytest.raises(ComputationError, match="change a gain as told") as caught:
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


@pytest.mark.parametrize("name", ["paper", "tower", "random"])
def test_shown_damping_is_that_of_the_mode_and_not_of_the_observer(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pole of the observer beside a mode would be shown as its damping, and chosen by it."""
    machine = {
        "paper": paper_machine(),
        "tower": quiet_copy(paper_machine(), has_tcp_sensor=True),
        "random": random_modal_machine(3, n_modes=1),
    }[name]
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
    shown_poles = mode_poles(tuned.loops[0])
    for k, mode in enumerate(plant.modes):
        pole = follow_pole(machine, tuned, complex(without[k]))
        # Two visible modes mix; the less damped of both poles is shown.
        shown, followed = -shown_poles[k].real / abs(shown_poles[k]), -pole.real / abs(pole)
        vibrations = tuned.nominal.poles[tuned.nominal.poles.imag > 0]
        assert np.min(np.abs(-vibrations.real / np.abs(vibrations) - shown)) < 1e-9
        assert shown == pytest.approx(followed, rel=1e-6) or name == "tower"
        if not is_seen(mode, tuned.controller.sensors):
            assert tuned.nominal.mode_damping[k] == pytest.approx(mode.damping_ratio, rel=1e-6)


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_state_feedback_keeps_the_same_margins_and_what_the_cascade_had(path: Path) -> None:
    """Otherwise the comparison of settling times is one of margins."""
    cascades = cascade_family(read_profile(path))
    classic = tune_shape(cascades, CLASSIC, largest=1.0)
    assert classic is not None
    for proposal in propose_feedback(cascades, classic, [CLASSIC]).loops:
        assert_tuned(proposal)
        assert proposal.controller.state_gains.any()
        assert proposal.least_stiffness >= classic.least_stiffness


@pytest.mark.parametrize("path", PROFILES, ids=lambda path: path.stem)
def test_proposed_loops_keep_margins_stiffness_and_integral_gain(path: Path) -> None:
    """A loop that settles sooner but yields to the cutting force would be recommended."""
    found = propose_cascades(cascade_family(read_profile(path)))
    assert found.classic is not None
    assert found.loops[0] is found.classic
    for proposal in found.loops:
        assert_tuned(proposal)
        assert proposal.least_stiffness >= found.classic.least_stiffness
        share = integral_gain(proposal.controller) / integral_gain(found.classic.controller)
        assert share >= TUNING.least_integral_share


def test_tuned_gains_are_those_that_are_typed_in() -> None:
    """Terminal and sheet would name two values of one gain, and the loop would be a third."""
    found = tune_loop(paper_machine()).controller
    for gain in (found.position_gain, found.velocity_gain, found.integral_time):
        assert gain == float(f"{gain:.4g}")


def test_integral_gain_is_what_a_lasting_force_displaces_over_time() -> None:
    """The area under the disturbance response, of the encoder's part: one over Kp Kv / Tn."""
    machine = quiet_copy(paper_machine(), state_feedback=StateFeedback.OFF)
    tuned = tune_loop(machine)
    push = 100.0
    rest = Profile(knots=(0.0,), jerks=(0.0,))
    motion = run(machine, tuned.controller, rest, nominal=machine, samples=8000, push=push)
    area = float(np.sum(motion.encoder)) * tuned.controller.velocity_cycle
    assert area == pytest.approx(push / integral_gain(tuned.controller), rel=1e-3)


def test_second_encoder_damps_the_tower() -> None:
    """Feedback of phi, which only a second encoder sees, must raise its damping from 0.05."""
    tuned = tune_loop(quiet_copy(paper_machine(), has_tcp_sensor=True))
    tower = tuned.loops[0].plant.modes[1]
    assert tuned.controller.state_gains[tower.deflection] != 0.0
    assert tuned.nominal.mode_damping[1] > 2.0 * tower.damping_ratio


def test_no_sine_moves_the_tool_more_than_the_dynamic_stiffness_says() -> None:
    """The stiffness in the table and the curve beside it would contradict each other."""
    tuned = tune_loop(paper_machine())
    answer = simulate_disturbance(tuned.loops[0], duration=1.0)
    # The step's derivative is the impulse response; its transform is the compliance.
    T_v = tuned.controller.velocity_cycle
    impulse = np.diff(answer.deflection) / T_v
    omega = 2 * np.pi * tuned.nominal.weakest_frequency_hz
    compliance = abs(np.sum(impulse * np.exp(-1j * omega * answer.t[1:])) * T_v)
    assert compliance == pytest.approx(1.0 / tuned.nominal.dynamic_stiffness, rel=0.01)


def swift_belt() -> Machine:
    """The printer's belt axis with a force that answers a thousand times faster."""
    machine = read_profile(Path("tests/data/belt-servo.toml"))
    return replace(machine, drive=replace(machine.drive, force_lag=2e-6))


def test_observer_is_found_beside_a_force_without_inertia() -> None:
    """In SI units this Riccati equation defeats scipy: the run ended as an internal error."""
    machine = swift_belt()
    cascade = build_cascade(machine, build_plant(machine), fraction=1.0)
    found = design_observer(machine, build_plant(machine), cascade)
    assert np.all(np.abs(np.linalg.eigvals(found.A - found.L @ found.C)) < 1.0)


def test_failed_design_of_the_state_feedback_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """The cascade alone is still a loop; why it stands alone must be readable."""

    def fail(*_: object) -> None:
        raise np.linalg.LinAlgError("ill-conditioned")

    monkeypatch.setattr(gains, "observer_gains", fail)
    found = propose_feedback(cascade_family(paper_machine()), None, [CLASSIC])
    assert found.loops == ()
    assert found.remark is not None
    assert Catalogue().say(found.remark) == "No state feedback: observer: ill-conditioned."
    assert not tune_loop(paper_machine()).controller.state_gains.any()
