"""A damping ratio that stands for less than half of a mode must not stand there unexplained."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from mtcommission.loop.analysis import MixedMode, find_mixed_modes
from mtcommission.loop.tuning.tuning import TunedLoop, tune_loop
from mtcommission.machine.control import StateFeedback
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.quantities import THIN_SPACE
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine

GERMAN = Catalogue("de")


@pytest.fixture(scope="module")
def tuned() -> TunedLoop:
    return tune_loop(paper_machine())


@pytest.fixture(scope="module")
def base(tuned: TunedLoop) -> MixedMode:
    return mixed(tuned)[0]


def mixed(tuned: TunedLoop) -> tuple[MixedMode, ...]:
    return find_mixed_modes(tuned.loops[0], tuned.nominal.mode_damping)


def test_a_deflected_base_rings_as_the_sentence_says(tuned: TunedLoop, base: MixedMode) -> None:
    """What is left late of the base's motion is damped far less than its own pole says."""
    plant, lifted = tuned.loops[0].plant, tuned.loops[0].lifted
    state = np.zeros(len(lifted.A))
    deflection = plant.modes[0].deflection
    state[tuned.loops[0].states.index(f"plant.{plant.states[deflection]}")] = 1.0
    state[tuned.loops[0].states.index(f"observer.{plant.states[deflection]}")] = 1.0
    motion = []
    for _ in range(250):
        motion.append(state[tuned.loops[0].states.index(f"plant.{plant.states[deflection]}")])
        state = lifted.A @ state
    late = np.array(motion[60:])  # the faster poles are gone: e^-8 of 62 1/s
    cuts = np.flatnonzero(late[:-1] * late[1:] < 0.0)
    zeros = cuts + late[cuts] / (late[cuts] - late[cuts + 1])
    half = float(np.mean(np.diff(zeros))) * lifted.dt
    peaks = [np.max(np.abs(late[a:b])) for a, b in pairwise(cuts)]
    decay = -float(np.polyfit(np.arange(len(peaks)) * half, np.log(peaks), 1)[0])
    omega = np.hypot(np.pi / half, decay)
    assert base.shown.frequency_hz == pytest.approx(omega / (2 * np.pi), rel=0.01)
    assert tuned.nominal.mode_damping[0] == pytest.approx(decay / omega, rel=0.02)
    assert base.shown.damping_ratio == pytest.approx(tuned.nominal.mode_damping[0], rel=1e-9)
    assert base.shown.damping_ratio < 0.5 * base.larger.damping_ratio


def test_shares_are_those_of_the_loop_in_observer_errors(tuned: TunedLoop, base: MixedMode) -> None:
    """Wrong shares would name the wrong poles; here the left vectors come from A transposed."""
    plant, lifted = tuned.loops[0].plant, tuned.loops[0].lifted
    turn = np.eye(len(lifted.A))
    for name in plant.states:
        if f"observer.{name}" in tuned.loops[0].states:
            turn[
                tuned.loops[0].states.index(f"observer.{name}"),
                tuned.loops[0].states.index(f"plant.{name}"),
            ] = -1.0
    moved = turn @ lifted.A @ np.linalg.inv(turn)
    z, right = np.linalg.eig(moved)
    z_left, left = np.linalg.eig(moved.T)
    left = left[:, [int(np.argmin(np.abs(z_left - pole))) for pole in z]]
    alive = np.abs(z) > 1e-3
    z, left, right = z[alive], left[:, alive], right[:, alive]
    part = np.abs(left * right) / np.abs(np.sum(left * right, axis=0))
    mode = plant.modes[0]
    rows = [
        tuned.loops[0].states.index(f"plant.{plant.states[i]}")
        for i in (mode.deflection, mode.rate)
    ]
    share = part[rows].sum(axis=0) / part[rows].sum()
    poles = np.log(z) / lifted.dt
    for swing in (base.shown, base.larger):
        near = np.argsort(np.abs(np.abs(poles) - 2 * np.pi * swing.frequency_hz))[:2]
        assert swing.share == pytest.approx(float(share[near].sum()), rel=1e-6)


def test_clear_modes_need_no_sentence() -> None:
    """A remark on every sheet would not be read."""
    stiff = paper_machine()
    alone = tune_loop(quiet_copy(stiff, state_feedback=StateFeedback.OFF))
    names = [item.name for item in mixed(alone)]
    assert "rotation" not in names  # the encoder does not see it: the poles are its own


def test_sentence_is_complete_in_both_languages(base: MixedMode) -> None:
    """The German sheet would speak of other poles than the English one."""
    english = Catalogue().say(base.remark).replace(THIN_SPACE, " ")
    shown, larger = base.shown, base.larger
    assert f"{shown.frequency_hz:.3g} Hz, which hold {shown.share:.0%}" in english.replace(
        " %", "%"
    )
    assert f"ring at {larger.frequency_hz:.3g} Hz with {larger.damping_ratio:.3f}" in english
    german = Catalogue("de").say(base.remark).replace(THIN_SPACE, " ")
    assert f"{shown.share:.0%} der Eigenform" in german.replace(" %", "%")
    decimal = f"{larger.damping_ratio:.3f}".replace(".", ",")
    assert f"Hz mit {decimal}" in german
