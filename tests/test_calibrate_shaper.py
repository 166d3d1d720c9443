"""Klipper's measurements: what its calibrate_shaper would choose, and profiles from two axes."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.identify.calibrate_shaper import propose_shapers
from mtcommission.identify.gather import by_axis, gather
from mtcommission.identify.identified import identify
from mtcommission.identify.profile import Writing, write_profile
from mtcommission.identify.states import states_differ
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.profile.read import parse_profile
from mtcommission.measured.measurement import AllDirections, Given, Spectrum
from mtcommission.study.rules import compare_shapers

Modes = tuple[tuple[float, float, float], ...]
"""Frequency [Hz], damping ratio and share at the tool of each."""

LINES = np.arange(0.0, 200.1, 1.5625)

ONE: Modes = ((45.0, 0.05, 1.0),)
TWO: Modes = ((36.0, 0.06, 0.8), (92.0, 0.04, 0.2))

OF_THE_SCRIPT = {
    (ONE,): (
        "mzv",
        ("zv", 45.0, 0.005753, 0.081435, 7891.704),
        ("mzv", 46.8, 0.000000, 0.092990, 6452.295),
        ("ei", 57.4, 0.000000, 0.100005, 5999.677),
        ("2hump_ei", 73.8, 0.000000, 0.103968, 5771.012),
        ("3hump_ei", 92.6, 0.000000, 0.105442, 5690.308),
    ),
    (TWO,): (
        "2hump_ei",
        ("zv", 34.6, 0.075440, 0.130220, 4514.155),
        ("mzv", 23.0, 0.012956, 0.385011, 1456.220),
        ("ei", 33.8, 0.000336, 0.288412, 2080.355),
        ("2hump_ei", 60.2, 0.004039, 0.156250, 3840.009),
        ("3hump_ei", 74.0, 0.000048, 0.165110, 3633.935),
    ),
    tuple(((hertz, 0.07, 1.0),) for hertz in (24.0, 30.0, 36.0)): (
        "ei",
        ("zv", 29.8, 0.195915, 0.173370, 3206.289),
        ("mzv", 24.8, 0.035459, 0.331150, 1746.743),
        ("ei", 30.4, 0.001690, 0.356533, 1627.400),
        ("2hump_ei", 39.0, 0.001301, 0.372291, 1476.265),
        ("3hump_ei", 48.6, 0.000000, 0.382794, 1430.337),
    ),
}
"""What Klipper's own find_best_shaper (commit 84104bbb) printed for these spectra: shaper, Hz,
share of vibration, mm, mm/s^2."""


def density(modes: Modes) -> NDArray[np.float64]:
    """Power of a tool that a sweep shakes with an acceleration in proportion to its frequency."""
    s = 2j * np.pi * LINES
    transfer = np.ones(LINES.size, dtype=complex)
    for hertz, zeta, share in modes:
        omega = 2 * np.pi * hertz
        transfer -= share * s**2 / (s**2 + 2 * zeta * omega * s + omega**2)
    return np.asarray(LINES**2 * np.abs(transfer) ** 2 * (LINES < 134.0) + 5.0)


def write(folder: Path, name: str, modes: Modes, scatter: float = 1.0) -> Path:
    """As Klipper's save_calibration_data writes it."""
    power = scatter * density(modes)
    columns = [0.9 * power, 0.07 * power, 0.03 * power, power]
    rows = [
        ",".join([f"{f:.1f}", *(f"{column[i]:.3e}" for column in columns)])
        for i, f in enumerate(LINES)
    ]
    file = folder / name
    file.write_text("\n".join(["freq,psd_x,psd_y,psd_z,psd_xyz", *rows]) + "\n")
    return file


@pytest.mark.parametrize("states", list(OF_THE_SCRIPT), ids=len)
def test_proposals_are_those_of_klippers_own_script(states):
    """If it failed, the sheet would ascribe to Klipper what it would never choose."""
    chosen, *rows = OF_THE_SCRIPT[states]
    measured = [
        AllDirections(frequency_hz=LINES, density=density(modes), is_divided=False)
        for modes in states
    ]
    found = propose_shapers(measured)
    assert [one.shaper for one in found if one.is_recommended] == [chosen]
    for one, (kind, hertz, vibration, smoothing, acceleration) in zip(found, rows, strict=True):
        assert one.shaper == kind
        assert one.frequency_hz == pytest.approx(float(hertz), abs=1e-9)
        assert one.vibration == pytest.approx(float(vibration), abs=1e-6)
        assert 1e3 * one.smoothing == pytest.approx(float(smoothing), abs=1e-6)
        assert 1e3 * one.max_acceleration == pytest.approx(float(acceleration), abs=1e-3)


def test_lines_printed_with_one_decimal_are_evened_again(tmp_path):
    """If it failed, every frequency of the fit would be off by up to 0.05 Hz.

    The script takes them as printed: what it would choose is judged on those.
    """
    evidence = gather([str(write(tmp_path, "a.csv", ONE))], Given())
    (spectrum,) = evidence.findings
    assert isinstance(spectrum, Spectrum)
    assert spectrum.frequency_hz == pytest.approx(LINES[1:], abs=0.01)
    assert spectrum.all_directions is not None
    assert spectrum.all_directions.frequency_hz == pytest.approx(np.round(LINES, 1), abs=1e-12)
    (best,) = [p for p in propose_shapers([spectrum.all_directions]) if p.is_recommended]
    assert best.shaper == "mzv"
    assert best.frequency_hz == pytest.approx(47.0, abs=0.01)  # by the script, of the same file
    assert best.max_acceleration == pytest.approx(6.507561, abs=1e-6)


@pytest.mark.parametrize(
    ("names", "axes"),
    [
        (["resonances_x_20240101_1.csv", "d/resonances_y_20240101_1.csv"], ["X", "Y"]),
        (["raw_data_axis=y_1.csv", "calibration_data_y_2.csv"], ["Y"]),
        (["resonances_x_1.csv", "bode.csv"], [""]),
        (["resonances_xyz.csv"], [""]),
    ],
)
def test_axes_are_told_by_klippers_names(names, axes):
    """If it failed, a payload of Y would widen the spread of X."""
    assert list(by_axis(names)) == axes


def test_three_payloads_of_a_slow_bed_are_one_mode_of_share_one(tmp_path):
    """If it failed, the bed would have three modes at once, each three times too large: their
    peaks hide what lies beside them, so only the sum of the shares tells how large they are."""
    dice, files, order = np.random.default_rng(5), [], (24.0, 36.0, 30.0)
    for state, hertz in enumerate(order):
        modes = ((hertz, 0.055, 0.92), (62.0, 0.05, 0.08))
        scatter = dice.lognormal(sigma=0.15, size=LINES.size)
        files.append(str(write(tmp_path, f"resonances_x_{state}.csv", modes, scatter)))
    found = identify(gather(files, Given())).part
    assert len(found.modes) == 2
    slow = found.modes[0]
    assert slow.frequency_hz.value == pytest.approx(30.0, rel=0.01)
    assert slow.tcp_gain is not None
    assert slow.tcp_gain.value == pytest.approx(0.92, abs=0.08)
    assert states_differ(found.states, found.modes), "each payload is judged by itself"
    each = [state.modes[0].frequency_hz.value for state in found.states]
    assert each == pytest.approx(order, rel=0.02)


def test_two_axes_become_two_profiles(tmp_path, run):
    """If it failed, a printer's two files would need two sessions, or be mixed into one axis."""
    files = [
        str(write(tmp_path, f"resonances_{axis}_20261123_1.csv", modes))
        for axis, modes in (("x", ONE), ("y", TWO))
    ]
    assert run("identify", *files, "-o", tmp_path / "new.toml")[0] == 0
    for axis, modes in (("x", ONE), ("y", TWO)):
        profile = tomllib.loads((tmp_path / f"new-{axis}.toml").read_text())
        assert profile["machine"]["axis"] == axis.upper()
        assert profile["drive"]["kind"] == "position_source"
        assert profile["control"]["kind"] == "klipper"
        assert "drive.max_acceleration" in profile["machine"]["assumed"]
        found = [float(mode["frequency"].split()[0]) for mode in profile["plant"]["modes"]]
        assert found == pytest.approx([hertz for hertz, _, _ in modes], rel=0.01)
        best = [one for one in profile["identified"]["calibrate_shaper"] if one["recommended"]]
        assert best[0]["shaper"] == OF_THE_SCRIPT[(modes,)][0]
    code, _, said = run("identify", *files, "-o", "-")
    assert code == 2
    assert "X, Y" in said


def test_klippers_choice_is_judged_beside_ours(tmp_path):
    """If it failed, a user could not see what the script's choice does on the measured axis."""
    file = write(tmp_path, "resonances_x_1.csv", ONE)
    found = identify(gather([str(file)], Given()), created="2026-11-23")
    how = Writing(file="x.toml", words=lambda _: Catalogue())
    machine = parse_profile(write_profile(found, how).profile, where="x.toml")
    first, *others = compare_shapers(machine, tune_loop(machine))
    assert first.name.kind == "shaper-of-calibration"
    assert "shaper-of-calibration" not in {one.name.kind for one in others if one.name}
    item, (best,) = (
        first.limits.setpoint_filter,
        [p for p in found.part.proposals if p.is_recommended],
    )
    assert (item.kind, item.damping_ratio) == ("mzv", 0.1)
    assert item.frequency_hz == pytest.approx(best.frequency_hz, abs=1e-6)
    assert first.limits.acceleration == pytest.approx(best.max_acceleration, rel=1e-5)
