"""A servo tuning session as the control saves it, made from a known plant, gives that plant.

If one of these fails, the file that most users have is read in the wrong unit, or the lines in
which nobody can model the axis decide what is found.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.identify.gather import gather, read_file
from mtcommission.measured.measurement import FrequencyResponse, Given, Sensor, Signal
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


def test_a_session_as_it_comes_gives_inertia_and_mode(run: Run, tmp_path: Path) -> None:
    path, out = tmp_path / "AX1.xml", tmp_path / "found.json"
    path.write_bytes(made.session(*measured()))
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


def test_the_sampling_rate_tells_hz_from_rad_per_s() -> None:
    """Public sessions hold Hz; the reader's habit does not decide."""
    f, H, gamma2 = measured()
    for per_hz in (1.0, 2 * np.pi):
        found = _read(made.session(f, H, gamma2, per_hz=per_hz))
        assert found.frequency_hz == pytest.approx(f)
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
    with pytest.raises(InputError, match=r"there are m_pPlant\[1\], m_pPlant\[2\]"):
        gather([f"{path}@m_Else"], Given())


# Where no model describes what was measured, nobody gets a profile without being told.


LINES = np.geomspace(2.0, 500.0, 400)


def _plant(f: made.Array) -> made.ComplexArray:
    s, omega = 2j * np.pi * f, 2 * np.pi * 62.0
    return 1.0 / (0.12 * s) + 6.0 * s / (s * s + 0.05 * omega * s + omega**2)


def closed_loop(f: made.Array) -> made.ComplexArray:
    """From the setpoint of a speed loop to the speed: 1 at low frequency."""
    s = 2j * np.pi * f
    open_loop = 40.0 * (1.0 + 1.0 / (0.01 * s)) * np.exp(-0.5e-3 * s) * _plant(f)
    return open_loop / (1.0 + open_loop)


def sticking(f: made.Array) -> made.ComplexArray:
    """Below 40 Hz the axis sticks in some lines and slides in others, each time alike."""
    rng = np.random.default_rng(6)
    stuck = np.where(f < 40.0, rng.uniform(0.05, 1.0, f.size), 1.0)
    return _plant(f) * stuck * np.exp(1j * np.where(f < 40.0, rng.uniform(-1.0, 1.0, f.size), 0.0))


def changing(f: made.Array) -> made.ComplexArray:
    """From 30 to 80 Hz other lines than beside belong to another machine."""
    rng = np.random.default_rng(7)
    other = (f > 15.0) & (f < 80.0) & (rng.uniform(size=f.size) < 0.5)
    return np.where(other, 3.0 * _plant(0.8 * f) * np.exp(1j), _plant(f))


def _table(path: Path, values: made.ComplexArray) -> str:
    how = {"noise": 2e-3, "averages": 20, "unit": "rad/s/(N m)", "seed": 8}
    return made.save_response(path, LINES, values, **how)


WRONG = {
    "closed loop": (closed_loop, "probably the wrong response"),
    "sticking": (sticking, "friction that sticks"),
    "changing": (changing, "feedback in the measurement"),
}


@pytest.mark.parametrize("name", list(WRONG))
def test_a_misfit_is_no_answer(run: Run, tmp_path: Path, name: str) -> None:
    values, cause = WRONG[name]
    file, new, out = _table(tmp_path / "x.csv", values(LINES)), tmp_path / "x.toml", "found.json"
    code, printed, _ = run("identify", file, "-o", str(new), "--json", str(tmp_path / out))
    assert code == 1
    first = " ".join(printed.split("x.csv")[0].split())
    assert first.startswith("No profile: the model does not describe what was measured: ")
    shown = " ".join(printed.split())
    assert cause in shown
    assert "easure" in shown  # what to measure instead
    both = ("within the band the axis is a rigid mass", "No rigid body shows in the band")
    assert not all(doubt in shown for doubt in both)
    assert not new.exists()
    found = json.loads((tmp_path / out).read_text())
    assert found["profile"] == ""
    assert "identify-not-described" in {one["message"] for one in found["warnings"]}


def test_force_writes_the_reason_on_the_first_line_and_check_repeats_it(
    run: Run, tmp_path: Path
) -> None:
    """Such a profile is never taken without a word."""
    file, new = _table(tmp_path / "x.csv", sticking(LINES)), tmp_path / "x.toml"
    code, printed, _ = run("identify", file, "--band", "2:500", "-o", str(new), "--force")
    assert code == 0
    assert printed.startswith("Forced: the model does not describe what was measured")
    text = new.read_text(encoding="utf-8")
    first = text.splitlines()[0]
    assert first.startswith("# Forced: the model does not describe what was measured: misfit ")
    needs = '[requirements]\ntcp_deviation = "1 mrad"\n'
    more = '[drive]\nmax_force = "100 N m"\nforce_lag = "1 ms"\n[[moves]]\nvelocity_step = 0.5\n'
    text = re.sub(r"^misfit = .*$", "misfit = 60.0", text, flags=re.MULTILINE)
    new.write_text(text.replace("[requirements]\n", needs) + more, encoding="utf-8")
    code, printed, said = run("check", str(new))
    assert code == 0, said
    assert "misfit 60, at most 10" in " ".join(printed.split())
