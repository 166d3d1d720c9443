"""Recorded moves against a record: right verdicts, and never a wrong "holds"."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.loop.model.assembly import as_state_space
from mtcommission.machine.moves import Positioning
from mtcommission.machine.profile.read import parse_profile
from mtcommission.measured.measurement import Given
from mtcommission.record.read_back import read_limits
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.verify.checks import Check, Verdict, judge_all
from mtcommission.verify.feedforward import suggest_feedforward
from mtcommission.verify.prediction import Rebuilt, rebuild
from mtcommission.verify.promises import check_recorded
from mtcommission.verify.refine import refine, renew_profile
from mtcommission.verify.trace import read_trace
from mtcommission.verify.verify import Verification, verify
from tests.recorded_traces import ROTARY, UNITS, Spoilt, record_moves, write_csv
from tests.sheet_record import shipped_record


@cache
def record_of(name: str) -> Record:
    return to_entry(shipped_record(name), Record)


@cache
def rebuilt_of(name: str) -> Rebuilt:
    return rebuild(record_of(name))


def limits_of(record: Record) -> MotionLimits:
    return read_limits(record.limits.recommended)


def axis_of(rebuilt: Rebuilt) -> Given:
    return Given().on(rebuilt.machine)


def shown(name: str, file: Path, columns: dict[str, np.ndarray], **units: str) -> Verification:
    """What ``verify`` finds in a file of these columns."""
    own = ROTARY if rebuilt_of(name).machine.motion.value == "rotary" else UNITS
    write_csv(file, columns, units=own | units)
    return verify(record_of(name), [read_trace(str(file), axis_of(rebuilt_of(name)))])


def columns_of(name: str, how: Spoilt) -> dict[str, np.ndarray]:
    return record_moves(rebuilt_of(name), limits_of(record_of(name)), how)


def verified(name: str, path: Path, how: Spoilt, *, only: tuple[str, ...] = ()) -> Verification:
    columns = columns_of(name, how)
    if only:
        columns = {key: values for key, values in columns.items() if key in ("t", "x_ref", *only)}
    return shown(name, path / "trace.csv", columns)


def find(found: Verification, name: str) -> Check:
    return next(check for check in found.checks if check.name == name)


MILLING, GANTRY = "milling-manipulator", "modal-two-modes"


def test_the_loop_of_a_record_is_rebuilt_to_the_last_digit():
    record, rebuilt = record_of(MILLING), as_state_space(rebuilt_of(MILLING).loops[0])
    written = record.loop.closed_loop
    for name in "ABCD":
        assert np.array_equal(getattr(rebuilt, name), getattr(written, name))


@pytest.mark.parametrize("name", [MILLING, GANTRY])
@pytest.mark.parametrize(
    "how",
    [
        Spoilt(lag=1e-3, noise=3e-7, offset=3e-3),
        Spoilt(step=1e-3, setpoint_grain=1e-7, grain=1e-7),
    ],
    ids=["lag, noise and offset", "coarse"],
)
def test_what_the_record_promises_holds_where_the_machine_is_the_record_s(name, how, tmp_path):
    found = verified(name, tmp_path, how)
    best = found.record.limits.recommended
    # A ramp of one cycle is too short for a trace to tell its jerk.
    assert found.obeyed is (True if best.jerk_time > 2e-3 else None)
    assert found.verdict is Verdict.HOLDS, [c.name for c in found.checks]
    residual = find(found, "move 1: residual deviation")
    share = (
        0.03 if how.step < 1e-3 else 0.05
    )  # a millisecond apart, samples miss the top of a swing
    assert residual.measured == pytest.approx(
        residual.predicted, abs=residual.uncertainty + share * residual.predicted
    )
    assert found.shift == pytest.approx(how.lag, abs=2e-5)


@pytest.mark.parametrize(("name", "grain"), [(GANTRY, 1e-9), (GANTRY, 1e-6), ("honing-z", 1e-7)])
def test_a_slow_start_below_the_resolution_counts_as_settling_time(name, grain, tmp_path):
    """Ten milliseconds that no digit showed were left out: a move that is too slow "held"."""
    how = Spoilt(step=1e-3, setpoint_grain=grain, grain=min(grain, 1e-7))
    found = verified(name, tmp_path, how)
    settling = find(found, "move 1: settling time")
    true = record_of(name).moves[0].response.settling_time
    assert settling.measured == pytest.approx(true, abs=2e-4)
    assert settling.predicted == pytest.approx(true, abs=2e-4)
    assert settling.uncertainty < 2e-3
    # Steps of the record are no vibrations.
    assert not [check.name for check in found.checks if check.fails]


@pytest.mark.parametrize("share", [0.45, 0.75, 1.0])
def test_a_trace_that_ends_too_soon_neither_holds_nor_blames_anybody(share, tmp_path):
    """Whoever stops the recorder too soon would be told of a fault of the program."""
    whole = columns_of("rotary-table", Spoilt(dwell=0.0, before=0.1))
    rows = int(share * len(whole["t"]))
    found = shown("rotary-table", tmp_path / "cut.csv", {k: v[:rows] for k, v in whole.items()})
    assert found.verdict is Verdict.UNKNOWN
    assert not [check.key for check in found.checks if check.verdict is Verdict.FAILS]


def test_the_feed_forward_is_what_the_machine_would_need(tmp_path):
    """A heavier machine asks for its mass, a late encoder for its delay; both are tested apart."""
    name, mass = "ball-screw", rebuilt_of("ball-screw").plant.moving_mass
    fed = suggest_feedforward(verified(name, tmp_path, Spoilt(payload=0.2 * mass, repeats=2)))
    new = {one.key: one.new.value for one in fed.values}
    assert new["feedforward_mass"] == pytest.approx(1.2 * mass, rel=0.03)
    assert fed.tested == 1
    assert fed.after < 0.4 * fed.before
    fed = suggest_feedforward(verified(name, tmp_path, Spoilt(lag=1e-3)))
    (delay,) = [one for one in fed.values if one.key == "reference_delay"]
    assert delay.new.value - delay.old == pytest.approx(1e-3, rel=0.02)
    assert fed.after < 0.1 * fed.before


def test_friction_shows_in_the_following_error_while_the_axis_moves(tmp_path):
    """At standstill the axis sticks and answers no force: those samples took it for half."""
    found = verified("honing-z", tmp_path, Spoilt(coulomb=240.0, repeats=4, step=2.5e-4, dwell=0.5))
    fed = suggest_feedforward(found)
    new = {one.key: one.new.value for one in fed.values}
    assert 0.6 * 240.0 < new["friction_feedforward"] < 1.1 * 240.0
    assert fed.after < 0.6 * fed.before


@pytest.mark.parametrize("factor", [0.92, 1.15])
def test_a_frequency_outside_the_spread_is_found(factor, tmp_path):
    found = verified(GANTRY, tmp_path, Spoilt(frequency=factor, noise=1e-7))
    assert found.verdict is Verdict.FAILS
    beam = find(found, "beam: frequency")
    assert beam.verdict is Verdict.FAILS
    refined = {one.name: one for one in refine(found).parameters}
    assert refined["beam.frequency"].new.value == pytest.approx(38.0 * factor, rel=0.01)


def test_a_planner_that_ignores_the_jerk_is_said_first_and_the_mechanics_not_blamed(tmp_path):
    found = verified(MILLING, tmp_path, Spoilt(ignores_jerk=True, noise=1e-7))
    assert found.obeyed is False
    assert found.verdict is Verdict.FAILS
    assert found.warnings[0].kind == "verify-planner-exceeds"
    jerk = find(found, "setpoint jerk")
    assert jerk.verdict is Verdict.FAILS
    assert find(found, "setpoint acceleration").verdict is Verdict.HOLDS
    assert find(found, "move 1: residual deviation").verdict is Verdict.UNKNOWN


RESIDUAL, FAILS, UNKNOWN = "move 1: residual deviation", Verdict.FAILS, Verdict.UNKNOWN


@pytest.mark.parametrize(
    ("how", "name", "verdict", "reason"),
    [
        (Spoilt(lag=8e-3), "reference delay", FAILS, ""),
        (Spoilt(behind=11.2e-3), "reference delay", FAILS, ""),  # not the delay, nor none
        (Spoilt(slower=0.7), RESIDUAL, UNKNOWN, "verify-other-setpoint"),
        (Spoilt(dwell=0.1), RESIDUAL, UNKNOWN, "verify-too-short"),
        (Spoilt(noise=4e-6, step=1e-3), RESIDUAL, UNKNOWN, "verify-noise-above-band"),
    ],
)
def test_what_differs_is_told_and_what_cannot_be_told_is_not_said(
    how, name, verdict, reason, tmp_path
):
    check = find(verified(MILLING, tmp_path, how), name)
    assert check.verdict is verdict
    assert not reason or check.reason.kind == reason


@pytest.mark.parametrize("step", [7e-4, 1e-3])
def test_a_ramp_that_falls_between_the_samples_does_not_blame_the_planner(step, tmp_path):
    """Steps of the acceleration within a cycle: what a mean shows of them hangs on the phase."""
    found = verified("printer-belt", tmp_path, Spoilt(step=step, dwell=0.3))
    assert find(found, "setpoint jerk").verdict is not Verdict.FAILS


def test_the_encoder_alone_tells_nothing_of_a_mode_that_it_does_not_show(tmp_path):
    found = verified(MILLING, tmp_path, Spoilt(), only=("encoder",))
    assert found.verdict is Verdict.UNKNOWN
    residual = find(found, "move 1: residual deviation")
    assert residual.reason.kind == "verify-encoder-only"


def test_an_rms_force_over_a_shorter_time_than_its_limit_never_simply_holds(tmp_path):
    """A dwell that ends early: above the limit in any case, or it cannot be told."""
    rebuilt = rebuilt_of(GANTRY)
    whole = verified(GANTRY, tmp_path, Spoilt(dwell=0.19))
    measured = find(whole, "move 1: RMS force").measured
    for share, verdict in ((0.9, Verdict.FAILS), (0.99, Verdict.UNKNOWN)):
        drive = replace(rebuilt.machine.drive, continuous_force=share * measured)
        limited = replace(rebuilt, machine=replace(rebuilt.machine, drive=drive))
        rows = check_recorded(limited, whole.record, limits_of(whole.record), whole.recorded[0])
        rms = next(row for row in rows if row.key == "RMS force")
        assert rms.verdict is judge_all(rows) is verdict
    assert rms.reason.kind == "verify-dwell-not-recorded"
    assert rms.reason.values["got"] < rms.reason.values["needed"]


def test_a_setpoint_recorded_behind_the_delay_is_recognised(tmp_path):
    """What the loop compares already is the delayed setpoint: no deviation of the machine."""
    tau = rebuilt_of(GANTRY).controller.reference_delay
    how = Spoilt(step=2.5e-4, noise=1e-7, payload=20.0)
    before = verified(GANTRY, tmp_path, how)
    behind = verified(GANTRY, tmp_path, replace(how, behind=tau))
    assert before.warnings == ()
    assert behind.warnings[0].kind == "verify-behind-delay"
    assert behind.warnings[0].values["delay"] == tau
    assert behind.verdict is before.verdict is Verdict.HOLDS
    for key in ("settling time", "residual deviation", "peak deviation", "max force"):
        one, other = (find(found, f"move 1: {key}") for found in (before, behind))
        apart = one.uncertainty + other.uncertainty
        assert other.measured == pytest.approx(one.measured, abs=apart), key
    assert "delay" not in {one.name for one in refine(behind).parameters}


@pytest.mark.parametrize(("name", "share"), [(MILLING, 0.0), (GANTRY, 1.0)])
def test_a_following_error_alone_tells_it_too(name, share, tmp_path):
    tau = rebuilt_of(name).controller.reference_delay
    columns = columns_of(name, Spoilt(step=5e-4, behind=share * tau))
    t, x = columns["t"], columns["x_ref"]
    late = np.interp(t - (1.0 - share) * tau, t, x)
    own = {"t": t, "x_ref": x, "following_error": late - columns["encoder"]}
    found = shown(name, tmp_path / "e.csv", own, following_error="m")
    said = [warning.kind for warning in found.warnings]
    assert said == ["verify-behind-delay"] * (share == 1.0)
    residual = find(found, "move 1: residual deviation")
    assert residual.measured == pytest.approx(
        residual.predicted, abs=residual.uncertainty + 0.05 * residual.predicted
    )


def test_never_a_wrong_holds(tmp_path):
    """Machines whose true residual misses the band, recorded with all kinds of blemish."""
    rng = np.random.default_rng(7)
    rebuilt, band = rebuilt_of(GANTRY), record_of(GANTRY)
    limit = find(verified(GANTRY, tmp_path, Spoilt()), "move 1: residual deviation").limit
    wrong = missed = 0
    for seed in range(10):
        how = Spoilt(
            frequency=float(rng.uniform(0.7, 1.1)),
            damping=float(rng.uniform(0.2, 1.5)),
            payload=float(rng.uniform(0.0, 120.0)),
            noise=float(10 ** rng.uniform(-7.5, -5.5)),
            step=float(rng.choice([125e-6, 5e-4, 1e-3, 2e-3])),
            grain=float(rng.choice([1e-8, 1e-7, 1e-6])),
            setpoint_grain=float(rng.choice([1e-9, 1e-7])),
            lag=float(rng.uniform(0.0, 5e-4)),
            dwell=float(rng.choice([0.3, 1.0])),
            seed=seed,
        )
        exact = replace(how, noise=0.0, grain=1e-9, step=125e-6, lag=0.0, dwell=1.5)
        true = find(verified(GANTRY, tmp_path, exact), "move 1: residual deviation").measured
        check = find(verified(GANTRY, tmp_path, how), "move 1: residual deviation")
        missed += true > limit
        wrong += check.verdict is Verdict.HOLDS and true > 1.001 * limit
        wrong += check.verdict is Verdict.FAILS and true < 0.999 * limit
    assert rebuilt.machine.requirements.tcp_deviation == limit
    assert band.assessment.met
    assert missed > 2
    assert wrong == 0


def there_and_back(name: str, how: Spoilt, count: int) -> dict[str, np.ndarray]:
    """A longer move than the record's, to and fro."""
    record, rebuilt = record_of(name), rebuilt_of(name)
    move = Positioning(distance=0.1, max_velocity=0.2)
    pieces: dict[str, list[np.ndarray]] = {}
    for number in range(count):
        own = record_moves(rebuilt, limits_of(record), replace(how, seed=number), move)
        end = own["x_ref"][-1]
        for key, values in own.items():
            if key == "t":
                values = values + number * (own["t"][-1] + how.step)
            elif number % 2:
                values = -values if key == "force" else end - values
            pieces.setdefault(key, []).append(values)
    return {key: np.concatenate(parts) for key, parts in pieces.items()}


def test_a_move_that_the_record_does_not_hold_is_told(tmp_path):
    """The trace of another axis: what it shows was called "entered"."""
    found = shown(GANTRY, tmp_path / "other.csv", there_and_back(GANTRY, Spoilt(), 1))
    assert found.warnings[0].kind == "verify-moves-unknown"
    assert found.warnings[0].values["size"] == pytest.approx(0.1, rel=1e-3)


def test_mass_and_friction_come_back_and_are_tested_on_what_was_held_back(tmp_path):
    how = Spoilt(coulomb=80.0, viscous=400.0, payload=30.0, noise=3e-7, step=5e-4, dwell=0.6)
    found = shown(GANTRY, tmp_path / "fro.csv", there_and_back(GANTRY, how, 6))
    refined = refine(found)
    new = {one.name: one.new for one in refined.parameters}
    assert new["mass"].value == pytest.approx(350.0, rel=0.01)
    assert new["coulomb_friction"].value == pytest.approx(
        80.0, abs=3 * new["coulomb_friction"].sigma
    )
    assert new["viscous_friction"].value == pytest.approx(
        400.0, abs=3 * new["viscous_friction"].sigma
    )
    assert refined.tested == 3
    assert refined.unexplained_after < 0.5 * refined.unexplained_before
    assert refined.force_unexplained < 0.05
    text = renew_profile(
        found.record.profile.text, refined, words=words_of(found), date="2026-01-01"
    )
    drive = parse_profile(text, where="new").drive
    assert drive.coulomb_friction == pytest.approx(new["coulomb_friction"].value, rel=1e-4)


def test_an_axis_that_sticks_has_no_mode_of_it(tmp_path):
    """A creep into rest was a mode at half the frequency, blamed, and took mass and friction."""
    how = Spoilt(coulomb=50.0, repeats=3, step=5e-4, noise=1e-7)
    found = verified(GANTRY, tmp_path, how)
    assert not [check.name for check in found.checks if check.verdict is Verdict.FAILS]
    new = {one.name: one.new for one in refine(found).parameters}
    assert "beam.frequency" not in new
    assert new["mass"].value == pytest.approx(320.0, rel=0.01)
    assert new["coulomb_friction"].value == pytest.approx(50.0, abs=5.0)


def test_the_command_and_the_sheet_say_the_same(tmp_path, monkeypatch, run):
    (tmp_path / "record.json").write_text(json.dumps(shipped_record(GANTRY)), encoding="utf-8")
    how = Spoilt(frequency=1.12, noise=2e-7, step=5e-4)
    write_csv(tmp_path / "move.csv", columns_of(GANTRY, how))
    monkeypatch.chdir(tmp_path)
    code, said, _ = run("verify", "record.json", "move.csv", "--json", "-")
    entry = json.loads(said)
    assert (code, entry["verdict"]) == (1, "does not hold")
    _, said, _ = run("verify", "record.json", "move.csv", "-o", "out", "--language", "de")
    assert "Nicht eingehalten" in said
    assert "does not hold" in (tmp_path / "out" / "verdict.json").read_text(encoding="utf-8")
    run("sheet", "record.json", "--verified", "out/verdict.json", "-o", "sheet", "--no-pdf")
    sheet = (tmp_path / "sheet" / "sheet.html").read_text(encoding="utf-8")
    beam = next(one for one in entry["checks"] if one["name"] == "beam: frequency")
    assert beam["verdict"] == "does not hold"
    new = entry["refined"]["beam.frequency"]["new"]
    measurements = sheet.split('id="measurements"')[1]
    assert f"{new:.4g}" in measurements
    assert "Recorded moves, verify: Does not hold." in measurements
    other = {**entry, "record": "0" * 64}
    (tmp_path / "other.json").write_text(json.dumps(other), encoding="utf-8")
    code, _, errors = run("sheet", "record.json", "--verified", "other.json", "-o", "sheet")
    assert code == 2
    assert "about another record" in errors


def words_of(found: Verification) -> Catalogue:
    return Catalogue(rotary=found.record.machine.motion == "rotary")


def test_an_accelerometer_at_the_tool_shows_the_modes(tmp_path):
    columns = columns_of(GANTRY, Spoilt(frequency=1.08))
    t, tool = columns["t"], columns["tcp"]
    own = {"t": t, "x_ref": columns["x_ref"], "encoder": columns["encoder"],
           "acceleration": np.gradient(np.gradient(tool, t), t)}  # fmt: skip
    found = shown(GANTRY, tmp_path / "acc.csv", own, acceleration="m/s^2")
    beam = find(found, "beam: frequency")
    assert beam.verdict is Verdict.FAILS
    assert beam.measured == pytest.approx(1.08 * beam.predicted, rel=0.01)
    assert find(found, "move 1: residual deviation").verdict is Verdict.UNKNOWN


def test_on_a_rotary_axis_torque_stands_for_force(tmp_path):
    found = verified("rotary-table", tmp_path, Spoilt(before=0.3, dwell=0.6))
    assert find(found, "move 1: max force").unit == "N m"
    assert find(found, "move 1: residual deviation").verdict is Verdict.HOLDS
    assert found.verdict is Verdict.UNKNOWN  # the second move of the record was not recorded


def test_a_sensor_that_counts_backwards_in_another_unit_is_turned(tmp_path):
    columns = columns_of(GANTRY, Spoilt(step=2.5e-4))
    columns["tcp"] = -1e6 * columns["tcp"]
    found = shown(GANTRY, tmp_path / "turned.csv", columns, tcp="um")
    assert "verify-reversed" in {one.kind for one in found.recorded[0].trace.remarks}
    assert find(found, "move 1: residual deviation").verdict is Verdict.HOLDS


@pytest.mark.parametrize(
    ("head", "kind"),
    [
        ("t [s],x_ref [m],force [N],tcp [N]", "identify-column-contradicts"),
        ("t [s],a,encoder [m],b", "verify-missing-setpoint"),
        ("t [s],x_ref [m],force [N],current [A]", "verify-constant-missing"),
        ("t [s],x_ref [m],encoder [mm],b", "verify-other-travel"),
        ("t [s],x_ref [m],force [N],b", "verify-missing-measured"),
        ("t [s],x_ref [m],encoder [m],b", "identify-series-not-finite"),
    ],
)
def test_what_a_file_lacks_is_said_with_the_remedy(head, kind, tmp_path):
    t = 1e-3 * np.arange(400)
    x = np.clip(t - 0.1, 0.0, 0.1)
    torn = x.copy()
    torn[200] = 1e300 if "not-finite" in kind else torn[200]  # its square ended in a traceback
    file = tmp_path / "bad.csv"
    np.savetxt(file, np.column_stack([t, x, torn, x]), delimiter=",", header=head, comments="")
    with pytest.raises(InputError) as caught:
        read_trace(str(file), axis_of(rebuilt_of(GANTRY)))
    assert caught.value.faults[0].message.kind == kind
