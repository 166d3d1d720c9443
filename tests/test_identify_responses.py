"""Responses from time records: right within the errors they state, by every way of exciting."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from mtcommission.base.errors import InputError
from mtcommission.identify.gather import read_file
from mtcommission.identify.identified import identify
from mtcommission.measured.measurement import (
    Evidence,
    FreeVibration,
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Spectrum,
)
from tests import identify_files as made

STEP = 1e-3
NONE = Given()
HEADS = ["t [s]", "force [N]", "encoder [m]"]


def record(force: np.ndarray, noise: float, seed: int) -> list[np.ndarray]:
    rng = np.random.default_rng(1000 + seed)
    x, _ = made.positions(force, STEP)
    rate = np.diff(x).std()
    return [STEP * np.arange(force.size), force, x + noise * rate * rng.standard_normal(x.size)]


def found(heads: list[str], columns: list[np.ndarray], given: Given = NONE) -> FrequencyResponse:
    (one, *_), _ = read_file(made.table(heads, columns, digits=15), given, name="a")
    assert isinstance(one, FrequencyResponse)
    return one


def kinds(one: FrequencyResponse | Spectrum | FreeVibration) -> set[str]:
    return {remark.kind for remark in one.remarks}


def score(one: FrequencyResponse) -> np.ndarray:
    """Error of each line over the standard error that it states, real and imaginary part."""
    truth = made.held(one.frequency_hz, STEP)
    error = (one.values - truth) / (one.relative_error * np.abs(one.values))
    return np.concatenate([error.real, error.imag])


def test_periods_are_found_and_the_errors_are_as_stated() -> None:
    force = np.tile(made.multisine(1000, STEP, 5.0, 250.0), 13)
    one = found(HEADS, record(force, 0.05, 1))
    assert {"identify-by-periods"} <= kinds(one)
    assert one.averages in (12.0, 13.0)
    assert one.resolution_hz == 0.0
    assert (one.frequency_hz[0], one.frequency_hz[-1]) == pytest.approx((5.0, 250.0), abs=4.0)
    assert 0.9 < np.std(score(one)[20:]) < 1.2


def test_lines_left_out_of_a_multisine_are_not_taken() -> None:
    """They hold what repeats besides: distortion, cogging."""
    size = 2000
    hertz = np.arange(3, 200, 2)
    rng = np.random.default_rng(2)
    t = np.arange(size)
    force = np.cos(2 * np.pi * np.outer(t, hertz) / size + rng.uniform(0, 6.3, hertz.size)).sum(1)
    force += 0.03 * np.cos(2 * np.pi * np.outer(t, np.arange(2, 300)) / size).sum(1)
    one = found(HEADS, record(np.tile(force, 6), 0.01, 2))
    assert set(np.round(one.frequency_hz * size * STEP)) <= set(hertz)
    assert one.frequency_hz.size > 0.9 * hertz.size


def test_welch_says_its_window_and_its_errors_are_as_stated() -> None:
    rng = np.random.default_rng(3)
    one = found(HEADS, record(rng.standard_normal(60_000), 0.05, 3))
    assert {"identify-by-welch", "identify-no-reference"} <= kinds(one)
    assert one.averages > 4
    assert one.resolution_hz > 0.0
    inside = np.abs(one.frequency_hz[:, None] - [38.0, 117.0]).min(axis=1) > 4.0
    both = np.concatenate([inside, inside])
    assert 0.7 < np.std(score(one)[both]) < 1.5  # away from the peaks, which the window smears
    truth = made.held(one.frequency_hz, STEP)
    assert np.abs(one.values / truth - 1)[~inside].max() < 0.3


def test_blows_of_a_hammer() -> None:
    rng = np.random.default_rng(6)
    force = np.zeros(20_000)
    pulse = np.sin(np.pi * np.arange(4) / 4)
    for start in range(100, 20_000, 4000):
        force[start : start + 4] = rng.uniform(50, 100) * pulse
    _, tool = made.positions(force, STEP)
    v = np.gradient(tool, STEP)
    a = np.gradient(v, STEP)
    heads = ["t [s]", "force [N]", "tool acceleration [m/s^2]"]
    noisy = a + 1e-3 * rng.standard_normal(a.size)
    one = found(heads, [STEP * np.arange(force.size), force, noisy])
    assert "identify-by-blows" in kinds(one)
    assert one.averages == 5
    assert one.sensor is Sensor.TCP
    f = one.frequency_hz
    truth = made.held(f, STEP, sensor="tcp")
    truth = truth * (1j * np.sin(2 * np.pi * f * STEP) / STEP) ** 2  # two central differences
    inside = (f > 10) & (f < 150)
    assert np.median(np.abs(one.values / truth - 1)[inside]) < 0.05


def test_free_vibration_after_a_move() -> None:
    """Truth lies within three stated sigma, in nearly all of ten records."""
    t, modes = np.arange(0, 3, STEP), ((21.0, 0.03, 1e-3), (64.0, 0.01, 4e-4))
    good = 0
    for seed in range(10):
        rng = np.random.default_rng(seed)
        reference = 0.2 + np.clip(t / 0.5, 0, 1)
        y, late = reference.copy(), np.maximum(t - 0.5, 0.0)
        for hertz, zeta, size in modes:
            omega = 2 * np.pi * hertz
            damped = omega * np.sqrt(1 - zeta**2)
            y += size * np.exp(-zeta * omega * late) * np.sin(damped * late)
        y += 2e-5 * rng.standard_normal(t.size)
        data = made.table(["t [s]", "x_ref [m]", "tcp [m]"], [t, reference, y])
        (one,), _ = read_file(data, NONE, name="a")
        assert isinstance(one, FreeVibration)
        assert {"identify-by-decay", "identify-loop-in-decay"} <= kinds(one)
        off = [
            abs(seen.value - true) / seen.sigma
            for mode, (hertz, zeta, _) in zip(one.modes, modes, strict=True)
            for seen, true in ((mode.frequency_hz, hertz), (mode.damping_ratio, zeta))
        ]
        good += max(off) < 3.0
    assert good >= 9


def test_klipper_accelerations_become_a_spectrum() -> None:
    """An uneven clock and gravity on one axis; the direction that shakes is taken."""
    rng = np.random.default_rng(7)
    t = np.cumsum(rng.uniform(0.85, 1.15, 20_000)) / 3200
    sweep = np.cos(2 * np.pi * (5 * t + 10 * t**2))
    omega, zeta = 2 * np.pi * 55.0, 0.05
    dt = 1 / 3200
    first, second = (
        2 * np.exp(-zeta * omega * dt) * np.cos(omega * dt),
        np.exp(-2 * zeta * omega * dt),
    )
    a = lfilter([0.0, dt**2], [1.0, -first, second], sweep)
    columns = [t + 1000.0, 1e3 * omega**2 * a, 5 * sweep, 9810 + rng.standard_normal(t.size)]
    data = made.table(["#time", "accel_x", "accel_y", "accel_z"], columns)
    (one,), _ = read_file(data, NONE, name="a")
    assert isinstance(one, Spectrum)
    assert one.source.label == "accel_x"
    assert {"identify-resampled", "identify-by-power"} <= kinds(one)
    assert one.frequency_hz[np.argmax(one.density)] == pytest.approx(55.0, abs=2.5)


def test_the_bench_gives_the_same_response_by_periods_as_its_makers_did() -> None:
    """Current to angle by three periods here, over eighteen and with other tools there."""
    bench = made.REAL / "fdi-motor-bench"
    given = Given(constant=1.0)
    ours, _ = read_file((bench / "multisine-3-periods.csv").read_bytes(), given, name="a")
    assert [one.sensor for one in ours] == [Sensor.ENCODER, Sensor.TCP]
    for one, name in zip(ours, ("motor", "load"), strict=True):
        data = (bench / f"frf-current-to-{name}-velocity.csv").read_bytes()
        (theirs,), _ = read_file(data, given, name="b")
        assert isinstance(one, FrequencyResponse)
        assert isinstance(theirs, FrequencyResponse)
        rate = one.values * 2j * np.pi * one.frequency_hz
        places = np.searchsorted(theirs.frequency_hz, one.frequency_hz - 0.01)
        apart = np.abs(rate - theirs.values[places]) / np.abs(rate)
        stated = one.relative_error
        assert one.frequency_hz.size > 230
        assert np.median(apart / stated) < 2.0
        assert np.median(apart) < 0.01


def test_a_tool_shaken_by_its_motor_shows_the_modes_on_a_held_motor() -> None:
    """Base-excited: q'' + 2 zeta omega q' + omega² q = -x_ref'', tool = x_ref + q."""
    rng, hertz, zeta = np.random.default_rng(4), 41.0, 0.05
    shaken = 3.0 * rng.standard_normal(60000)
    omega = 2 * np.pi * hertz
    f = np.fft.rfftfreq(shaken.size, STEP)
    s = 2j * np.pi * f
    share = (2 * zeta * omega * s + omega**2) / (s**2 + 2 * zeta * omega * s + omega**2)
    tool = np.fft.irfft(share * np.fft.rfft(shaken), shaken.size)
    tool += 0.02 * tool.std() * rng.standard_normal(tool.size)
    columns = [STEP * np.arange(shaken.size), shaken, tool]
    given = Given(input="acceleration", sensor=Sensor.TCP)
    heads = ["t [s]", "motor_acceleration [m/s^2]", "acceleration [m/s^2]"]
    one = found(heads, columns, given)
    assert one.input is Signal.ACCELERATION
    assert one.sensor is Sensor.TCP
    assert "identify-no-reference" not in kinds(one)
    axis = identify(Evidence(findings=(one,))).part
    assert axis.base_excited
    assert axis.moving_mass is None
    (mode,) = axis.modes
    assert abs(mode.frequency_hz.value - hertz) < 3 * mode.frequency_hz.sigma + 0.05
    assert mode.damping_ratio.value == pytest.approx(zeta, rel=0.06)
    assert mode.tcp_gain.value == pytest.approx(1.0, rel=0.06)
    with pytest.raises(InputError, match="no acceleration of the motor"):
        found([heads[0], "motor_velocity [m/s]", heads[2]], columns, given)
