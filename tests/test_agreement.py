"""Records that were changed and sealed again: wrong input with its place, never a traceback."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import pytest

from benchmarks.fuzz import call, fault_of, in_place
from benchmarks.mutations import dice_of, resealed
from mtcommission.errors import InputError
from mtcommission.messages.message import Message
from mtcommission.record.files import find_checksum
from mtcommission.record.record import load_record
from mtcommission.sheet import remark_on_print
from tests.sheet_record import example_record, on_json


def sealed(record, path: Path) -> Path:
    path.write_text(json.dumps(record | {"checksum": find_checksum(record)}), "utf-8")
    return path


@pytest.mark.parametrize(
    ("break_it", "place"),
    [
        (lambda r: r["plant"]["A"][0].pop(), "plant.A: has lengths"),
        (lambda r: r["moves"][0]["series"]["t"].pop(), "moves[1].series.signals: has lengths"),
        (lambda r: r["moves"][0]["series"]["t"].reverse(), "moves[1].series.t: must rise"),
        (lambda r: r["limits"]["landscape"]["usage"].pop(), "limits.landscape.usage: has lengths"),
        (lambda r: r["moves"].clear(), "moves: must not be empty"),
        (lambda r: r["plant"].update(moving_mass=1e200), "plant.moving_mass: got 1e+200"),
        (
            lambda r: r["limits"]["rule"]["steps"][0].update(formula=[1]),
            "expected a message",
        ),
        (lambda r: r["moves"][0]["response"].update(max_force=None), "max_force: got null, exp"),
        (lambda r: r["moves"][0].update(move={}), "moves[1].move: must have either velocity_step"),
        (lambda r: r["moves"][0]["series"]["signals"].pop("deviation"), "signals: deviation miss"),
        (lambda r: r["plant"]["modes"][0].update(name="x"), "mode_damping: x missing"),
        (lambda r: r["loop"].update(position_loop="x"), "loop.position_loop: got x, must be one"),
        (
            lambda r: r["optima"][0]["time"].update(t_f=0),
            "optima[1].time.t_f: got 0, must be at least",
        ),
        (
            lambda r: r["limits"]["alternatives"][0].update(residual_deviation=-1e-6),
            "alternatives[1].residual_deviation: got -1e-06, must be at least 0",
        ),
        (
            lambda r: r["loop"]["disturbance"]["signals"].update(x=[0.0]),
            "loop.disturbance.signals: got x, must be one of",
        ),
        (lambda r: r["assessment"]["checks"][0].update(name="x"), "must be one of x"),
        (
            lambda r: r["plant"].update(units=r["plant"]["units"] | {"tcp": "m" * 50}),
            "plant.units: has a text of more than",
        ),
        (lambda r: r["data"].clear(), "data: must not be empty"),
        (lambda r: r["data"].__delitem__(slice(1, None)), "data: drive.max_force / drive.max_acc"),
    ],
)
def test_entries_that_do_not_belong_together_are_named(break_it, place, tmp_path: Path) -> None:
    record = example_record()
    load_record(sealed(record, tmp_path / "good.json"))
    break_it(record)
    with pytest.raises(InputError) as refused:
        load_record(sealed(record, tmp_path / "record.json"))
    assert place in str(refused.value)
    assert "record.json" in str(refused.value)


def test_a_number_beyond_all_floats_is_no_number(tmp_path: Path) -> None:
    """The checksum of such a record could not even be computed."""
    path = sealed(example_record(), tmp_path / "record.json")
    path.write_text(path.read_text("utf-8").replace('"schema": 7', '"x": 1e999, "schema": 7'))
    with pytest.raises(InputError, match="1e999 is no number of JSON"):
        load_record(path)


def test_a_fault_of_ours_is_no_fault_of_the_record(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """It was told as "the record contradicts itself", and nobody would have reported it."""
    monkeypatch.setattr("mtcommission.sheet.print_html", lambda *_, **__: [][0])
    path = sealed(example_record(), tmp_path / "record.json")
    code, said = call("sheet", str(path), "-o", str(tmp_path), "--no-pdf")
    assert code == 3
    assert "internal error, please report it" in said


def test_resealed_records_end_in_a_message(tmp_path: Path) -> None:
    """Thousands of them: python -m benchmarks.fuzz --command sheet --record record.json."""
    path, codes, good = tmp_path / "record.json", Counter[int](), example_record()
    for seed in range(16):
        path.write_text(resealed(good, dice_of(31, seed)), "utf-8")
        ending = in_place(lambda: call("sheet", str(path), "-o", str(tmp_path), "--no-pdf"))
        assert not fault_of("sheet", ending, longest=60.0), (seed, ending)
        codes[ending.code] += 1
    assert codes[2] > 1  # else nothing was broken
    assert codes[0] + codes[1] > 1  # else nothing beyond the reader was tried


def test_letters_that_the_font_lacks_are_named() -> None:
    """A Chinese name came out as boxes without a word."""
    record = example_record()
    record["machine"] |= {"name": "Fräse Φ 机床 机", "source": "≤ µ ± Ж"}
    assert on_json(remark_on_print)(record) == (Message("print-boxes", characters="机床"),)
    record["machine"]["name"] = "Fräse Φ"
    assert on_json(remark_on_print)(record) == ()


def test_the_loop_in_use_alone_may_be_disturbed(tmp_path: Path) -> None:
    """An axis whose loop has no variants writes its answer under that name: export refused it."""
    record = json.loads(json.dumps(example_record()))
    signals = record["loop"]["disturbance"]["signals"]
    record["loop"]["disturbance"]["signals"] = {"loop-in-use": next(iter(signals.values()))}
    load_record(sealed(record, tmp_path / "record.json"))
