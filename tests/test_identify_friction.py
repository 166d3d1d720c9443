"""A bench that moves slowly reverses under its excitation, and friction shifts what is found.

If one of these fails, an interval is believed that the bench itself does not keep.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.identify.gather import gather
from mtcommission.identify.identified import identify
from mtcommission.measured.measurement import Given
from mtcommission.record.identified import IdentifiedPart
from tests import identify_files as made

FREQUENCY, DAMPING, INERTIA = 76.0, 0.02, 0.01
"""Of two equal inertias on a shaft [Hz; -; kg m², each]."""
STEP, SUB, SIZE, PERIODS = 5e-4, 4, 4096, 4
BENCHES = {
    "friction, slow": (0.09, 0.1),
    "friction, fast": (0.09, 10.0),
    "no friction, slow": (0.0, 0.1),
}
"""Coulomb friction at the load [N m] and offset speed [rad/s]."""


def _simulate() -> tuple[made.Array, made.Array, made.Array]:
    """Torque, motor speed (n, benches) and excitation (n,): a speed loop of 3 Hz, a multisine."""
    friction, offset = np.array(list(BENCHES.values())).T
    rng, h, omega = np.random.default_rng(0), STEP / SUB, 2 * np.pi * FREQUENCY
    spectrum = np.zeros(SIZE // 2 + 1, dtype=complex)
    lines = np.arange(4, int(400 * SIZE * STEP))
    spectrum[lines] = np.exp(2j * np.pi * rng.uniform(size=lines.size))
    excitation = np.fft.irfft(spectrum)
    excitation = np.tile(0.5 * excitation / excitation.std(), PERIODS)
    stiffness, damping = omega**2 * INERTIA / 2, DAMPING * omega * INERTIA
    gain = 2 * INERTIA * 2 * np.pi * 3.0
    motor, load, twist, held = offset.copy(), offset.copy(), 0.0 * offset, 0.0 * offset
    torques, speeds = [], []
    for added in excitation:
        torque = added + gain * (offset - motor) + held
        held = held + gain * 2 * np.pi * 0.75 * (offset - motor) * STEP
        torques.append(torque)
        speeds.append(motor)
        for _ in range(SUB):
            shaft = stiffness * twist + damping * (motor - load)
            motor = motor + h * (torque - shaft) / INERTIA
            # Coulomb: as much as stops it within the step, at most the friction.
            stop = np.clip(shaft + INERTIA * load / h, -friction, friction)
            load = load + h * (shaft - stop) / INERTIA
            twist = twist + h * (motor - load)
    return np.array(torques), np.array(speeds), excitation


@pytest.fixture(scope="module")
def benches(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, IdentifiedPart]]:
    folder = tmp_path_factory.mktemp("benches")
    torque, speed, excitation = _simulate()
    noise = 2e-3 * speed.std(axis=0) * np.random.default_rng(1).normal(size=speed.shape)
    heads = ["t [s]", "torque [N m]", "velocity [rad/s]", "v_ref [N m]"]
    found = {}
    for place, name in enumerate(BENCHES):
        path = folder / f"{place}.csv"
        columns = [STEP * np.arange(excitation.size), torque[:, place]]
        columns += [speed[:, place] + noise[:, place], excitation]
        path.write_bytes(made.table(heads, columns))
        found[name] = path, identify(gather([str(path)], Given())).part
    return found


def test_friction_that_reverses_is_told_with_a_shift_that_holds_the_truth(benches) -> None:
    """Its own interval hardly does: 0.1 rad/s under a swing of as much."""
    path, found = benches["friction, slow"]
    (mode,) = found.modes
    missed = abs(mode.frequency_hz.value - FREQUENCY)
    assert missed > mode.frequency_hz.sigma  # else there is nothing to tell
    (warning,) = [one for one in found.warnings if one.kind == "identify-friction-shifts"]
    shift = warning.values["shift"]
    assert isinstance(shift, float)
    assert missed < shift * mode.frequency_hz.value
    assert shift < 0.05  # and it says something
    text = Catalogue("en", rotary=True).say(warning)
    assert path.name in text
    assert "Measure again at" in text


@pytest.mark.parametrize("name", ["friction, fast", "no friction, slow"])
def test_nothing_is_told_where_friction_keeps_its_sign_or_is_not_there(benches, name: str) -> None:
    _, found = benches[name]
    (mode,) = found.modes
    assert abs(mode.frequency_hz.value - FREQUENCY) < 0.003 * FREQUENCY
    assert not [one for one in found.warnings if "-shift" in one.kind]
