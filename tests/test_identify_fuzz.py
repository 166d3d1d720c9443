"""Broken files of every format: evidence or an error with the file's name, soon, never a traceback.

MTCOMMISSION_FUZZ sets how many mutated files are tried (default: 200).
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from benchmarks.fuzz import call
from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.identify.gather import read_file
from mtcommission.measured.measurement import (
    Finding,
    FrequencyResponse,
    Given,
    Sensor,
    Signal,
    Spectrum,
)
from mtcommission.record.shape import dump_json
from mtcommission.verify.report import report, verification_entry
from mtcommission.verify.trace import read_trace
from mtcommission.verify.verify import verify
from tests import identify_files as made
from tests.recorded_traces import Spoilt, record_moves, write_csv
from tests.test_identify_formats import ENCODER, GAMMA2, LINES, time_files
from tests.test_verify import GANTRY, axis_of, limits_of, rebuilt_of, record_of

COUNT = int(os.environ.get("MTCOMMISSION_FUZZ", "200"))


def files() -> list[tuple[bytes, Given]]:
    f = np.arange(1.0, 150.0, 1.6)
    peak = 1e4 / ((1 - (f / 60) ** 2) ** 2 + 0.01) + 1.0
    given = Given(sensor=Sensor.TCP, input="force", output=Signal.VELOCITY)
    heads = ["f [Hz]", "re [m/s/N]", "im", "coherence"]
    columns = [LINES, ENCODER.real, ENCODER.imag, GAMMA2]
    raw = ["#time", "accel_x", "accel_y", "accel_z"]
    t = np.arange(3000) / 3200
    shaking = [t, 100 * np.sin(300 * t), np.cos(500 * t), 9810 + 0 * t]
    response = made.uff_function(4, LINES, ENCODER)
    made_here = [
        (made.table(heads, columns), given),
        (made.table(heads, columns, separator=";", decimal=","), given),
        (made.table(["freq", "psd_x", "psd_y", "psd_z", "psd_xyz"], [f, *[peak] * 4]), given),
        (made.table(raw, shaking), Given()),
        (made.session(LINES, ENCODER, GAMMA2), Given()),
        (made.measurement(LINES, ENCODER, GAMMA2), given),
        (made.uff(response, made.uff_function(6, LINES, GAMMA2)), given),
        (made.uff(response | {"binary": 1}), given),
        ((made.REAL / "sinumerik" / "freq_trace.XML").read_bytes(), given),
        ((made.REAL / "twincat-scope" / "scope-decimal-comma.csv").read_bytes(), Given()),
    ]
    return made_here + list(time_files().values())


def attempt(data: bytes, given: Given) -> tuple[tuple[Finding, ...], InputError | None]:
    try:
        return read_file(data, given, name="broken.dat")[0], None
    except InputError as error:
        return (), error


def test_broken_files_are_used_or_refused_by_name() -> None:
    good, words = files(), Catalogue("de")
    used = refused = 0
    for seed in range(COUNT):
        rng = np.random.default_rng([31, seed])
        data, given = good[seed % len(good)]
        broken = made.mutated(data, rng)
        findings, error = attempt(broken, given)
        if error is not None:
            refused += 1
            assert all(fault.where for fault in error.faults), (seed, str(error))
            assert "None" not in str(error), (seed, str(error))
            assert error.text(words), seed
        else:
            used += 1
        for one in findings:
            if isinstance(one, FrequencyResponse):
                assert np.isfinite(one.values).all(), seed
                assert (np.diff(one.frequency_hz) > 0.0).all(), seed
            if isinstance(one, Spectrum):
                assert np.isfinite(one.density).all(), seed
            assert all(words.say(remark) for remark in one.remarks), seed
    assert used > 0.1 * COUNT  # else nothing beyond the readers was tried
    assert refused > 0.2 * COUNT


def test_broken_files_end_the_command_with_0_1_or_2(tmp_path: Path) -> None:
    """The same through the whole command, fit and profile included, on some of them."""
    path, good, codes = tmp_path / "broken.dat", files(), set()
    for seed in range(COUNT // 15):
        rng = np.random.default_rng([77, seed])
        data, given = good[seed % len(good)]
        path.write_bytes(made.mutated(data, rng))
        options = [f"--sensor={given.sensor}"] if given.sensor else []
        options += [f"--input={given.input}"] if given.input else []
        options += [f"--output={given.output}"] if given.output else []
        options += [f"--columns={name}={column}" for name, column in given.columns.items()]
        code, said = call("identify", str(path), *options, "-o", str(tmp_path / "new.toml"))
        assert code in (0, 1, 2), (seed, said)
        assert "Traceback" not in said, seed
        assert code in (0, 1) or "broken.dat" in said or "--columns" in said, (seed, said)
        codes.add(code)
    assert {0, 2} <= codes


def test_broken_traces_are_judged_or_refused_by_name(tmp_path: Path) -> None:
    """What ``verify`` makes of them; whoever records a move sends such files, too."""
    rebuilt, record = rebuilt_of(GANTRY), record_of(GANTRY)
    columns = record_moves(rebuilt, limits_of(record), Spoilt(step=1e-3, noise=1e-7))
    good = write_csv(tmp_path / "good.csv", columns).read_bytes()
    path, judged, refused = tmp_path / "broken.csv", 0, list[InputError]()
    for seed in range(COUNT // 10):
        path.write_bytes(made.mutated(good, np.random.default_rng([55, seed])))
        try:
            found = verify(record, [read_trace(str(path), axis_of(rebuilt))])
        except InputError as error:
            refused.append(error)
            continue
        judged += 1
        dump_json(verification_entry(report(found)))
    assert all(fault.where for error in refused for fault in error.faults)
    assert all("None" not in str(error) for error in refused)
    assert judged
    assert refused


def test_a_digit_too_many_in_a_setpoint_that_rests_is_no_end_of_verify(tmp_path: Path) -> None:
    """What looks like a move there has no sample on its way: once a division by zero."""
    rebuilt, record = rebuilt_of(GANTRY), record_of(GANTRY)
    columns = record_moves(rebuilt, limits_of(record), Spoilt(step=1e-3, noise=1e-7))
    lines = write_csv(tmp_path / "good.csv", columns).read_text().splitlines()
    rests = lines[796].split(",")
    rests[1] = f"{float(rests[1]) * 1.01:.9g}"
    path = tmp_path / "digit.csv"
    path.write_text("\n".join([*lines[:795], ",".join(rests), *lines[798:]]) + "\n")
    assert verify(record, [read_trace(str(path), axis_of(rebuilt))]).checks
