"""A servo tuning session as the control saves it, made from a known plant, gives that plant.

If one of these fails, the file that most users have is read in the wrong unit, or the lines in
which nobody can model the axis decide what is found.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.identify.gather import gather, read_file
from mtcommission.identify.measurement import (
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
)
from tests import identify_files as made
from tests.conftest import Run

INERTIA, MOTOR, FREQUENCY, DAMPING = 0.14, 0.076, 59.0, 0.04
"""Of the two masses [kg m²], and of the mode between them [Hz; -]."""
GAIN = 1 / MOTOR - 1 / INERTIA
"""Of that mode at the motor [1/(kg m²)]."""


def grid() -> made.Array:
    """Lines as the auto-tuning spaces them: 0.49 Hz apart below, 3.9 Hz from 100 Hz to 4 kHz."""
    steps = np.clip(0.04 * np.arange(1.0, 1100.0), 0.489, 3.914)
    f = np.cumsum(steps)
    return f * 4000.0 / f[np.searchsorted(f, 4000.0) - 1]


def measured(seed: int = 4) -> tuple[made.Array, made.ComplexArray, made.Array]:
    """Two masses, twenty shafts above 600 Hz, and sticking friction below 5 Hz; 2 % distortion.

    The coherence tells of none of it: it is that of an excitation which repeats.
    """
    rng, f = np.random.default_rng(seed), grid()
    f = f[f <= 4000.0 * (1 + 1e-9)]
    s = 2j * np.pi * f
    H = 1.0 / (INERTIA * s)
    modes = [(FREQUENCY, DAMPING, GAIN)]
    modes += [
        (hertz, rng.uniform(0.005, 0.03), rng.uniform(1.0, 12.0))
        for hertz in np.geomspace(650.0, 3900.0, 20)
    ]
    for hertz, zeta, gain in modes:
        omega = 2 * np.pi * hertz
        H = H + s * gain / (s * s + 2 * zeta * omega * s + omega**2)
    H = H * (1 + 0.02 / np.sqrt(2) * (rng.normal(size=f.size) + 1j * rng.normal(size=f.size)))
    stuck = f < 5.0
    H[stuck] *= np.exp(rng.normal(size=stuck.sum()) + 0.5j * rng.normal(size=stuck.sum()))
    return f, H, np.where(stuck, 0.97, np.where(f < 9.0, 0.996, 0.9998))


def _read(data: bytes) -> FrequencyResponse:
    (found,), _ = read_file(data, Given(), name="AX1.xml")
    assert isinstance(found, FrequencyResponse)
    return found


@pytest.mark.parametrize("per_hz", [1.0, 2 * np.pi], ids=["Hz", "rad/s"])
def test_a_session_as_it_comes_gives_inertia_and_mode(
    run: Run, tmp_path: Path, per_hz: float
) -> None:
    """Public sessions hold Hz; the sampling rate tells, not the reader's habit."""
    path, out = tmp_path / "AX1.xml", tmp_path / "found.json"
    path.write_bytes(made.session(*measured(), per_hz=per_hz))
    code, printed, said = run("identify", str(path), "--json", str(out))
    assert code == 0, printed + said
    found = json.loads(out.read_text())
    assert found["moving_mass"]["value"] == pytest.approx(INERTIA, rel=0.02)
    mode = min(found["modes"], key=lambda one: abs(one["frequency_hz"]["value"] - FREQUENCY))
    for key, true in (("frequency_hz", FREQUENCY), ("damping_ratio", DAMPING)):
        assert abs(mode[key]["value"] - true) < 3 * mode[key]["sigma"]
    assert mode["frequency_hz"]["sigma"] < 0.01 * FREQUENCY
    assert mode["measured_gain"]["value"] == pytest.approx(GAIN, rel=0.08)
    low, high = found["band_hz"]
    assert 3.0 < low < 12.0
    assert 250.0 < high < 1100.0
    assert found["misfit"] < 10.0
    shown = " ".join((printed + said).split())
    assert "Of 0.4893 Hz to 4 kHz only" in shown
    assert "m_pPlant is taken" in shown
    assert "m_CurrentControllerResponse" in shown


def test_a_session_whose_frequencies_fit_no_sampling_rate_is_refused() -> None:
    f, H, gamma2 = measured()
    data = made.session(f, H, gamma2, step=0.002)  # 250 Hz, or 1571 rad/s
    with pytest.raises(InputError, match="neither in Hz nor in rad/s"):
        _read(data)


def test_a_session_without_a_sampling_time_says_that_hz_are_assumed() -> None:
    found = _read(made.session(*measured(), step=0.0))
    assert "identify-hz-assumed" in {one.kind for one in found.remarks}
    assert found.frequency_hz[-1] == pytest.approx(4000.0)


def test_of_several_records_the_last_is_taken_and_the_others_have_names(tmp_path: Path) -> None:
    f, H, gamma2 = measured()
    path = tmp_path / "AX1.xml"
    path.write_bytes(made.session(f, H, gamma2, repeats=2))
    (last,) = gather([str(path)], Given()).responses
    (first,) = gather([f"{path}@m_pPlant[1]@encoder"], Given()).responses
    assert last.values == pytest.approx(H)
    assert first.values == pytest.approx(1.5 * H)
    (remark,) = [one for one in last.remarks if one.kind == "identify-last-response-taken"]
    assert remark.values["name"] == "m_pPlant[2]"
    assert remark.values["others"] == "m_pPlant[1], m_CurrentControllerResponse"
    given = Given(input="torque", output=Signal.VELOCITY, sensor=Sensor.ENCODER)
    (other,) = gather([f"{path}@m_CurrentControllerResponse"], given).responses
    assert np.abs(other.values[0]) == pytest.approx(1.0, rel=1e-3)
    with pytest.raises(InputError, match=r"there are: m_pPlant\[1\], m_pPlant\[2\]"):
        gather([f"{path}@m_Else"], Given())
