"""Files of measurements: what each format says arrives, in SI, or an error says what is missing.

A wrong factor or sensor here is a wrong mass or gain in every profile that is identified.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.identify.gather import gather, read_file
from mtcommission.measured.measurement import (
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Spectrum,
    TimeRecord,
)
from tests import identify_files as made

LINES = made.LINES
ENCODER, TOOL = made.response(LINES), made.response(LINES, sensor="tcp", derivative=2)
GAMMA2 = np.linspace(0.9, 0.999, LINES.size)
FORCE = Given(sensor=Sensor.ENCODER, input="force", output=Signal.VELOCITY)


def one(data: bytes, given: Given = FORCE) -> FrequencyResponse:
    (found,), _ = read_file(data, given, name="a")
    assert isinstance(found, FrequencyResponse)
    return found


def record_of(data: bytes, given: Given) -> TimeRecord:
    _, (record,) = read_file(data, given, name="a")
    return record


def refusal(data: bytes, given: Given = FORCE) -> str:
    with pytest.raises(InputError) as caught:
        read_file(data, given, name="a.csv")
    return str(caught.value)


def same(found: FrequencyResponse, truth: np.ndarray, *, close: float = 1e-6) -> None:
    assert found.frequency_hz == pytest.approx(LINES, rel=1e-6)
    assert np.abs(found.values / truth - 1).max() < close


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_response_tables_in_every_dialect(separator: str, decimal: str, end: str) -> None:
    if separator == decimal:
        pytest.skip("one sign cannot be both")
    heads = ["frequency_hz", "re [m/s/N]", "im [m/s/N]", "coherence"]
    columns = [LINES, ENCODER.real, ENCODER.imag, GAMMA2]
    data = made.table(heads, columns, separator=separator, decimal=decimal, end=end)
    found = one(data, Given())
    same(found, ENCODER)
    assert found.coherence == pytest.approx(GAMMA2)
    assert (found.input, found.output, found.sensor) == (
        Signal.FORCE, Signal.VELOCITY, Sensor.ENCODER,
    )  # fmt: skip
    assert not found.rotary


@pytest.mark.parametrize(
    ("heads", "columns", "factor"),
    [
        (["f [Hz]", "magnitude [dB]", "phase [deg]"],
         [LINES, 20 * np.log10(np.abs(ENCODER)), np.angle(ENCODER, deg=True)], 1.0),
        (["f [kHz]", "magnitude [dB re mm/s/N]", "phase [rad]"],
         [LINES / 1e3, 20 * np.log10(np.abs(ENCODER)), np.angle(ENCODER)], 1e-3),
        (["omega [rad/s]", "magnitude [(mm/s)/kN]", "phase [°]"],
         [2 * np.pi * LINES, np.abs(ENCODER), np.unwrap(np.angle(ENCODER)) * 180 / np.pi], 1e-6),
        (["Frequenz / Hz", "Realteil in m/s/N", "Imaginärteil / (m/s/N)"],
         [LINES, ENCODER.real, ENCODER.imag], 1.0),
        (["freq", "real", "imag"], [LINES, ENCODER.real, ENCODER.imag], 1.0),
    ],
)  # fmt: skip
def test_response_tables_in_other_words_and_units(
    heads: list[str], columns: list[np.ndarray], factor: float
) -> None:
    same(one(made.table(heads, columns)), factor * ENCODER)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings_of_windows(encoding: str) -> None:
    heads = ["f [Hz]", "re [µm/N]", "im [µm/N]"]
    position = made.response(LINES, derivative=0) * 1e6
    data = made.table(heads, [LINES, position.real, position.imag]).decode().encode(encoding)
    same(one(data, Given(sensor=Sensor.TCP)), position * 1e-6)


def test_falling_frequencies_and_the_line_at_zero() -> None:
    f = np.concatenate(([0.0], LINES))[::-1]
    H = np.concatenate(([1.0], ENCODER))[::-1]
    same(one(made.table(["f", "re", "im"], [f, H.real, H.imag])), ENCODER)


def test_several_responses_in_one_table() -> None:
    heads = ["f [Hz]", "encoder re [m/s/N]", "encoder im", "encoder coherence"]
    heads += ["re_tool [m/s/N]", "im_tool"]
    second = made.response(LINES, sensor="tcp")
    columns = [LINES, ENCODER.real, ENCODER.imag, GAMMA2, second.real, second.imag]
    found, _ = read_file(made.table(heads, columns), FORCE, name="a")
    assert [one_.source.label for one_ in found] == ["encoder", "tool"]
    same(found[1], second)
    assert [one_.sensor for one_ in found] == [Sensor.ENCODER, Sensor.TCP]
    assert [one_.coherence is None for one_ in found] == [False, True]


def test_current_becomes_force_by_the_constant() -> None:
    """Without it mass and gains would be off by the motor constant."""
    heads = ["f", "re [rad/s/A]", "im [rad/s/A]"]
    data = made.table(heads, [LINES, 0.46 * ENCODER.real, 0.46 * ENCODER.imag])
    same(one(data, Given(constant=0.46)), ENCODER)
    assert one(data, Given(constant=0.46)).rotary
    assert "--constant" in refusal(data, Given())


def test_comments_say_what_the_command_line_may_say() -> None:
    comments = "# sensor = tcp\n# input = force\n# output: velocity\n# averages = 12\n# state = B\n"
    data = made.table(["f", "re", "im"], [LINES, ENCODER.real, ENCODER.imag], comments=comments)
    found = one(data, Given())
    assert (found.sensor, found.averages, found.source.state) == (Sensor.TCP, 12.0, "B")


def test_motor_and_axis_are_told_apart() -> None:
    """Motor speed per torque at a linear axis: with r rad/m the mass is r² times the inertia."""
    r = 2 * np.pi / 0.01
    data = made.session(LINES, ENCODER * r**2, GAMMA2)
    assert one(data, Given()).rotary
    same(one(data, Given(rotary=False, motor_turn=r)), ENCODER)
    same(one(made.session(LINES, ENCODER * r**2, GAMMA2, ratio=r), Given(rotary=False)), ENCODER)
    assert "drive.lead" in refusal(data, Given(rotary=False))


def test_a_session_may_lack_the_line_at_zero() -> None:
    """0 / 0 there is no reason to refuse the rest."""
    f = np.concatenate(([0.0], LINES))
    H, gamma2 = np.concatenate(([np.nan], ENCODER)), np.concatenate(([np.nan], GAMMA2))
    same(one(made.session(f, H, gamma2), Given()), ENCODER, close=1e-12)


def test_sinumerik_measurement_by_its_spectra() -> None:
    given = Given(input="torque", output=Signal.VELOCITY)
    found = one(made.measurement(LINES, ENCODER, GAMMA2), given)
    same(found, ENCODER, close=1e-9)
    assert found.coherence == pytest.approx(GAMMA2, rel=1e-9)
    assert found.averages == 6


def test_the_real_sinumerik_measurement_is_that_of_a_loop() -> None:
    """Its spectra agree with its own time series, and it is no mechanics."""
    name = str(made.REAL / "sinumerik" / "freq_trace.XML")
    with pytest.raises(InputError, match="closed loop from its setpoint"):
        gather([name], Given())
    (found,) = gather([name], Given(input="torque", output=Signal.VELOCITY)).responses
    assert found.source.measured_on == "2022-11-23"
    # From the time series of the two directions, transformed here.
    assert np.abs(found.values[0]) == pytest.approx(1.002, abs=0.01)
    assert np.angle(found.values[0], deg=True) == pytest.approx(-4.2, abs=0.5)


def test_uff_with_coherence_and_units() -> None:
    f, H = LINES, made.response(LINES, sensor="tcp", derivative=2)
    data = made.uff(
        made.uff_function(4, f, H / 9.81, units=("g", "N")),
        made.uff_function(6, f, GAMMA2 + 0j),
    )
    found = one(data, Given(sensor=Sensor.TCP))
    assert found.values == pytest.approx(H * 9.80665 / 9.81, rel=1e-6)
    assert found.coherence == pytest.approx(GAMMA2, rel=1e-6)
    assert found.output is Signal.ACCELERATION


def test_klipper_spectra_of_three_versions() -> None:
    f = np.arange(0.0, 200.0, 1.6)
    peak = 1e4 / ((1 - (f / 60) ** 2) ** 2 + (0.1 * f / 60) ** 2) + 1.0
    columns = [f, 0.1 * peak, peak, 0.01 * peak, 1.11 * peak]
    heads = ["freq", "psd_x", "psd_y", "psd_z", "psd_xyz"]
    body = made.table([], columns, digits=5).decode()
    newer = "\n".join(line + ",,0.1,0.2" for line in body.splitlines()) + "\n"
    older = "\n".join(line + ",0.1,0.2" for line in body.splitlines()) + "\n"
    versions = [
        ",".join(heads) + "\n" + body,
        ",".join([*heads, "shapers:", "zv(59.0)", "mzv(52.8)"]) + "\n" + newer,
        "#" + ",".join([*heads, "zv(59.0)", "mzv(52.8)"]) + "\n" + older,
    ]
    for text, is_divided in zip(versions, (False, True, True), strict=True):
        (found,), _ = read_file(text.encode(), Given(), name="a")
        assert isinstance(found, Spectrum)
        assert found.source.label == "psd_y"
        # Klipper judges the numbers as they stand there; those beside shapers' columns are
        # divided by the frequency already, before and since 21 November 2025 (2aff840f).
        judged = found.all_directions
        assert judged is not None
        assert judged.is_divided == is_divided
        assert judged.frequency_hz == pytest.approx(f, abs=1e-12)
        assert judged.density == pytest.approx(1.11 * peak, rel=1e-4)
        assert found.frequency_hz[np.argmax(found.density)] == pytest.approx(60, abs=1.7)


def signals() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, force and encoder position of four periods of a multisine."""
    step, size = 1e-3, 1000
    force = np.tile(made.multisine(size, step, 5.0, 300.0), 5)
    x, _ = made.positions(force, step)
    t = step * np.arange(4 * size)
    return t, force[size:], x[size:]


T, F, X = signals()


def time_files() -> dict[str, tuple[bytes, Given]]:
    heads = ["t [ms]", "force [kN]", "encoder [mm]"]
    columns = [1e3 * T, 1e-3 * F, 1e3 * X]
    scope = {"Force act": ("kN", 1e-3 * F), "Motor pos": ("mm", 1e3 * X)}
    period = b"# Sampling period is 1000000 ns\n"
    names = Given(columns={"force": "F [kN]", "encoder": "X [mm]"})
    by_number = {"force": "1 [kN]", "encoder": "2 [mm]", "sample_time": "1 ms"}
    halscope = made.table(["F", "X"], columns[1:], separator=";", digits=15)
    return {
        "own": (made.table(heads, columns), Given()),
        "own, units in a line of their own": (
            made.table(["t", "force", "encoder"], columns).replace(b"\n", b"\n[ms],[kN],[mm]\n", 1),
            Given(),
        ),
        "twincat, tab and comma": (made.twincat(T, scope), Given()),
        "twincat, a clock for each": (
            made.twincat(T, scope, separator=";", decimal=".", shared=False, last="EOF"), Given(),
        ),
        "twincat, full stamps": (
            made.twincat(T, scope, separator=",", decimal=".", full=True), Given(),
        ),
        "halscope": (period + halscope, names),
        "halscope with places of the traces": (
            period + halscope.replace(b"\n", b"\n# Position: 0.5;0.5\n# Scale: 1;2\n", 1), names,
        ),
        "halsampler": (made.table([], columns[1:], separator=" "), Given(columns=by_number)),
        "sinumerik trace": (made.servo_trace(T, {"F": 1e-3 * F, "X": 1e3 * X}), names),
        "uff": (
            made.uff(
                made.uff_function(1, T, F, above=13, units=("N", "")),
                made.uff_function(1, T, X, above=8, units=("m", "")) | {"rsp_node": 7},
            ),
            Given(columns={"force": "1:1/2:1", "encoder": "7:1/2:1"}),
        ),
    }  # fmt: skip


@pytest.mark.parametrize("name", list(time_files()))
def test_time_records_of_every_control(name: str) -> None:
    data, given = time_files()[name]
    record = record_of(data, given)
    assert record.sample_time == pytest.approx(1e-3, rel=1e-6)
    force, encoder = (channel.values for channel in record.channels)
    assert np.abs(force - F).max() < 1e-5 * np.abs(F).max()
    assert np.abs(encoder - X).max() < 1e-5 * np.abs(X).max()
    found = one(data, given)
    truth = made.held(found.frequency_hz, 1e-3)
    assert np.abs(found.values / truth - 1).max() < 0.02


def test_the_format_is_told_by_content_not_by_name(tmp_path: Path) -> None:
    """Two files with misleading names, mixed, each with its sensor behind it."""
    first, second = tmp_path / "a.xml", tmp_path / "b@work.uff"
    first.write_bytes(made.table(["f", "re [m/s/N]", "im"], [LINES, ENCODER.real, ENCODER.imag]))
    second.write_bytes(made.table(["f", "re [1/kg]", "im"], [LINES, TOOL.real, TOOL.imag]))
    found = gather([f"{first}@encoder", f"{second}@tcp"], Given()).responses
    assert [one_.sensor for one_ in found] == [Sensor.ENCODER, Sensor.TCP]
    assert [len(one_.source.sha256) for one_ in found] == [64, 64]
    same(found[1], TOOL)


def test_real_twincat_export_is_read_and_asks_for_names() -> None:
    name = str(made.REAL / "twincat-scope" / "scope-decimal-comma.csv")
    with pytest.raises(InputError, match="func_units_unscaled"):
        gather([name], Given())
    columns = {"encoder": "func_OS [mm]"}
    with pytest.raises(InputError):  # a ramp: neither force nor vibration
        gather([name], Given(columns=columns))


MASS_LINE = [LINES, ENCODER.real, ENCODER.imag]
HEADS = ["f [Hz]", "re [m/s/N]", "im [m/s/N]"]
RECORD = ["t [s]", "force [N]", "encoder [m]"]
NONE = Given()
BROKEN = {
    "empty": (b" \n", NONE, "is empty"),
    "binary": (b"PK\x03\x04abc", NONE, "xlsx"),
    "cut xml": (made.session(LINES, ENCODER, GAMMA2)[:3000], NONE, "no whole XML"),
    "swapped columns": (made.table(HEADS, MASS_LINE[::-1]), NONE, "must rise"),
    "swapped ends": (
        made.table(HEADS, [LINES, (1 / ENCODER).real, (1 / ENCODER).imag]), NONE, "swapped",
    ),
    "coherence above one": (
        made.table([*HEADS, "coherence"], [*MASS_LINE, 10 + GAMMA2]), NONE, "coherence of 10.9",
    ),
    "time in the wrong unit": (made.table(RECORD, [1e3 * T, F, X]), NONE, "samples 1 s"),
    "frequency in the wrong unit": (
        made.table(["f [kHz]", *HEADS[1:]], MASS_LINE), NONE, "check their unit",
    ),
    "nan": (made.table(HEADS, MASS_LINE).replace(b"\n4.", b"\nnan,", 1), NONE, "a.csv:"),
    "hole": (
        b"\n".join([*made.table(HEADS, MASS_LINE).splitlines()[:60], b"5,6", b"7,8,9"]),
        NONE, "a.csv:61:",
    ),
    "unknown unit": (
        made.table(["f", "re [V/V]", "im"], MASS_LINE), NONE, "--input.*--output.*--sensor",
    ),
    "unit against option": (
        made.table(HEADS, MASS_LINE), Given(output=Signal.POSITION), "that of velocity",
    ),
    "clipped": (made.table(RECORD, [T, np.clip(F, -9, 9), X]), NONE, "force runs into"),
    "uneven": (
        made.table(RECORD, [np.delete(column, slice(900, 950)) for column in (T, F, X)]),
        NONE, "a.csv:902: a step of 0.051 s",
    ),
    "unit off by 1000": (
        made.table(["t [s]", "force [N]", "encoder [mm]", "velocity [m/s]"],
                   [T, F, X, np.gradient(X, 1e-3)]),
        NONE, "times the rate",
    ),
    "names without units": (made.table(["t", "Kanal 1", "Kanal 2"], [T, F, X]), NONE, "Kanal 2"),
    "no such column": (
        made.table(["t", "a", "b"], [T, F, X]), Given(columns={"force": "c [N]"}), "1: t|1: a",
    ),
    "acceleration without place": (
        made.table([*RECORD[:2], "acceleration [m/s^2]"], [T, F, X]), NONE, "--sensor",
    ),
    "no clock": (made.table([], [F, X], separator=" "), NONE, "sample_time"),
    "still": (made.table(RECORD, [T, F, 0 * X]), NONE, "stands still"),
    "no force": (made.table(RECORD, [T, 0 * F, X]), NONE, "does not change"),
}  # fmt: skip


@pytest.mark.parametrize("name", list(BROKEN))
def test_what_cannot_be_used_is_said(name: str) -> None:
    data, given, words = BROKEN[name]
    assert re.search(words, refusal(data, given)), refusal(data, given)
