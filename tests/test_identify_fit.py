"""What the fit finds in responses whose axis is known, and on a bench that others have fitted.

If one of these fails, a mode is missing or invented in a profile, or an interval promises too much.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.identify_survey import GRIDS, Axis, measure, random_axis, survey
from mtcommission.base.errors import InputError
from mtcommission.identify.fit import fit_state
from mtcommission.identify.gather import gather
from mtcommission.identify.identified import identify
from mtcommission.measured.measurement import (
    Evidence,
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Source,
)

BENCH = Path(__file__).parent / "data" / "identify" / "fdi-motor-bench"
SOURCE = Source(file="made", sha256="0" * 64)


def _axis(**changes) -> Axis:
    known = {
        "mass": 320.0,
        "drag": 3.0,
        "delay": 4e-4,
        "frequency_hz": np.array([37.5, 81.0]),
        "damping_ratio": np.array([0.02, 0.035]),
        "gain": np.array([2e-3, -1.2e-3]),
        "hidden_hz": 1500.0,
        "hidden_gain": 0.0,
    }
    return Axis(**(known | changes))


def _measured(axis: Axis, *, seed: int = 0, noise: float = 0.02, **changes) -> FrequencyResponse:
    clean = measure(np.random.default_rng(seed), axis, GRIDS["log"], noise=noise)
    return replace(clean, source=replace(SOURCE, file=f"made-{seed}"), **changes)


@pytest.mark.parametrize("grid", ["log", "linear"])
def test_random_axes_come_out_without_false_or_missing_modes(grid: str) -> None:
    tally = survey(grid, 12, first=300, tells=False)
    assert tally.right >= 11
    assert tally.false <= 1
    held = np.concatenate([tally.held[name] for name in ("f", "zeta", "gain")])
    assert np.mean(held) >= 0.88


def test_near_modes_are_told_apart_at_the_sum_of_their_half_power_widths() -> None:
    f, zeta = np.array([60.0, 63.7]), np.array([0.015, 0.015])
    axis = _axis(frequency_hz=f, damping_ratio=zeta, gain=np.array([2e-3, 1.5e-3]))
    fit = fit_state([_measured(axis)])
    assert [mode.frequency_hz.value for mode in fit.modes] == pytest.approx(f, rel=5e-3)


def test_a_line_of_the_mains_is_no_mode() -> None:
    response = _measured(_axis())
    hum = response.values.copy()
    hum[np.argmin(np.abs(response.frequency_hz - 50.0))] *= 1.8
    fit = fit_state([replace(response, values=hum)])
    assert len(fit.modes) == 2


def test_a_sensor_that_counts_backwards_is_turned_and_told() -> None:
    encoder = _measured(_axis())
    tool = _measured(_axis(gain=np.array([3e-3, 2e-3])), seed=1, sensor=Sensor.TCP)
    tool = replace(tool, values=-tool.values)
    found = identify(Evidence(findings=(encoder, tool))).part
    kinds = {message.kind for message in found.warnings}
    assert "identify-polarity-reversed" in kinds
    assert [mode.tcp_gain.value for mode in found.modes] == pytest.approx([3e-3, 2e-3], rel=0.05)
    assert [mode.measured_gain.value for mode in found.modes] == pytest.approx(
        [2e-3, -1.2e-3], rel=0.05
    )


def test_points_of_a_hammer_test_share_poles_and_a_failed_one_is_left_out() -> None:
    rng, f = np.random.default_rng(5), np.arange(1.0, 513.0)
    s, omega, zeta = 2j * np.pi * f, 2 * np.pi * np.array([92.0, 224.0]), np.array([0.04, 0.02])
    shapes = np.array([[1.0, 0.7], [0.5, -0.9], [-0.8, 0.4], [0.3, 0.6]])
    modes = s[:, None] ** 2 / (s[:, None] ** 2 + 2 * zeta * omega * s[:, None] + omega**2)
    responses = []
    for place, shape in enumerate(shapes):
        H = modes @ (1e-2 * shapes[0] * shape)
        noise = 0.03 * np.median(np.abs(H))
        H = H + noise * (rng.normal(size=f.size) + 1j * rng.normal(size=f.size)) / np.sqrt(2)
        if place == 3:
            H = H[::-1] * np.exp(2j * np.pi * rng.uniform(size=f.size))
        point = replace(
            _measured(_axis()),
            source=replace(SOURCE, file=f"point-{place}"),
            frequency_hz=f,
            values=H,
            coherence=1 / (1 + 5 * (noise / np.abs(H)) ** 2),
            averages=5,
            output=Signal.ACCELERATION,
            sensor=Sensor.TCP,
        )
        responses.append(point)
    found = identify(Evidence(findings=tuple(responses))).part
    for mode, w, z in zip(found.modes, omega, zeta, strict=True):
        assert mode.frequency_hz.value == pytest.approx(w / (2 * np.pi), rel=3e-3)
        assert mode.damping_ratio.value == pytest.approx(z, rel=0.05)
    assert found.moving_mass is None
    out = [m for m in found.warnings if m.kind == "identify-point-left-out"]
    assert [m.values["file"] for m in out] == ["point-3"]


def test_too_few_lines_are_refused_by_name() -> None:
    with pytest.raises(InputError, match=r"made-0: 3 usable lines between 500"):
        fit_state([_measured(_axis())], band_hz=(500.0, 520.0))


def test_motor_bench_of_fditools_has_the_mode_that_is_trusted() -> None:
    """FdiTools (MIT), motor and load: 76.2 Hz, zeta 0.019, gain x inertia +1.00 and -0.99."""
    files = [
        str(next(BENCH.glob("*motor-velocity*"))),
        f"{next(BENCH.glob('*load-velocity*'))}@tcp",
    ]
    found = identify(gather(files, Given(constant=1.0, sensor=Sensor.ENCODER))).part
    (mode,) = found.modes
    assert mode.frequency_hz.value == pytest.approx(76.2, abs=0.15)
    assert abs(mode.damping_ratio.value - 0.019) < 2 * mode.damping_ratio.sigma
    inertia = found.moving_mass.value
    assert mode.measured_gain.value * inertia == pytest.approx(1.0, abs=0.03)
    assert mode.tcp_gain.value * inertia == pytest.approx(-0.99, abs=0.03)


def test_a_lag_is_told_from_a_delay_and_a_delay_alone_has_none() -> None:
    response = _measured(_axis())
    s = 2j * np.pi * response.frequency_hz
    (one,) = fit_state([response]).responses
    assert one.lag is None
    assert one.delay.value == pytest.approx(4e-4, abs=3 * one.delay.sigma + 1e-6)
    for lag in (3e-4, 2e-3):
        fit = fit_state([replace(response, values=response.values / (1.0 + s * lag))])
        (one,) = fit.responses
        assert one.lag is not None
        assert abs(one.lag.value - lag) < 3 * one.lag.sigma
        assert abs(one.delay.value - 4e-4) < 3 * one.delay.sigma
        for gain, true in zip(one.residues, (2e-3, -1.2e-3), strict=True):
            assert abs(gain.value - true) < 3 * gain.sigma


@pytest.mark.parametrize(("drag", "is_told"), [(0.3, False), (60.0, True)])
def test_friction_that_may_shift_a_mode_is_told_of_a_response_alone(drag, is_told):
    """Without the record nobody sees whether the axis reversed: the doubt stays beside the mode."""
    found = identify(Evidence(findings=(_measured(_axis(drag=drag)),))).part
    kinds = {warning.kind for warning in found.warnings}
    assert ("identify-friction-may-shift" in kinds) is is_told


def test_a_mode_narrower_than_the_lines_lie_apart_is_told_without_its_damping() -> None:
    """Left out, its band would be cut off in silence; with its interval no profile is read."""
    rng = np.random.default_rng(41)
    axis = random_axis(rng)
    noise = float(np.exp(rng.uniform(np.log(0.01), np.log(0.1))))
    shown = measure(rng, axis, GRIDS["linear"], noise=noise)
    found = identify(Evidence(findings=(shown,))).part
    low = found.modes[0]
    assert abs(low.frequency_hz.value - axis.frequency_hz[0]) < 2.0 * low.frequency_hz.sigma < 1.0
    assert low.damping_ratio.sigma > low.damping_ratio.value
    assert found.spread.damping == pytest.approx(0.95)
    assert [one.kind for one in found.spread.because][1] == "identify-damping-unknown"
    assert "identify-lines-too-far-apart" in [one.kind for one in found.warnings]
