"""A record of another form is wrong input; a fault of ours is none of the file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.fuzz import call
from benchmarks.mutations import dice_of, mutated_text
from mtcommission.base.errors import InputError
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.machine import Datum, Profile
from mtcommission.record.read_back import read_machine
from mtcommission.record.record import SCHEMA, Record, load_record
from mtcommission.record.shape import find_checksum, to_entry
from tests.sheet_record import example_record


def sealed(record, path: Path) -> Path:
    path.write_text(json.dumps(record | {"checksum": find_checksum(record)}), "utf-8")
    return path


@pytest.mark.parametrize(
    "break_it",
    [
        lambda r: r["limits"]["rule"]["steps"][0].update(formula=[1]),
        lambda r: r["moves"][0]["response"].update(max_force=None),
        lambda r: r["plant"].update(A=1),
        lambda r: r["loop"].pop("Kv"),
        lambda r: r["loop"]["force_filters"][0].update(kind="x"),
    ],
)
def test_another_form_is_refused(break_it, tmp_path):
    """Another version wrote it; without its sum it was edited."""
    record = example_record()
    load_record(sealed(record, tmp_path / "good.json"))
    break_it(record)
    with pytest.raises(InputError, match=r"record.json: another version of mtcommission wrote it"):
        load_record(sealed(record, tmp_path / "record.json"))
    (tmp_path / "edited.json").write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match="it was edited or damaged"):
        load_record(tmp_path / "edited.json")


def test_a_number_beyond_all_floats_is_no_number(tmp_path):
    """The checksum of such a record could not even be computed."""
    path, mark = sealed(example_record(), tmp_path / "record.json"), f'"schema": {SCHEMA}'
    path.write_text(path.read_text("utf-8").replace(mark, f'"x": 1e999, {mark}'))
    with pytest.raises(InputError, match="1e999 is no number of JSON"):
        load_record(path)


def test_a_fault_of_ours_is_no_fault_of_the_record(monkeypatch, tmp_path):
    """It was told as "the record contradicts itself", and nobody would have reported it."""
    monkeypatch.setattr("mtcommission.sheet.content.print_html", lambda *_, **__: [][0])
    path = sealed(example_record(), tmp_path / "record.json")
    code, said = call("sheet", str(path), "-o", str(tmp_path), "--no-pdf")
    assert code == 3
    assert "internal error, please report it" in said


def test_damaged_records_are_refused(tmp_path):
    """Bytes lost, doubled or changed, as disks, editors and mail leave a file."""
    path, whole = tmp_path / "record.json", sealed(example_record(), tmp_path / "whole.json")
    good = whole.read_text("utf-8")
    refused = list[str]()
    for seed in range(16):
        path.write_text(mutated_text(good, dice_of(31, seed)), "utf-8", newline="")
        try:
            assert load_record(path) == load_record(whole)  # blanks say nothing
        except InputError as error:
            refused.append(str(error))
    assert len(refused) > 8
    assert all("record.json" in said for said in refused)


# What a record says, as machine and filters again.


def with_profile(name: str, data: list[Datum]) -> Record:
    text = read_shipped(name).text
    profile = Profile(name=f"{name}.toml", sha256="", text=text)
    return replace(to_entry(example_record(), Record), profile=profile, data=data)


@pytest.mark.parametrize(
    ("name", "key"),
    [("rotary-table", "drive.max_force"), ("printer-belt", "drive.max_acceleration")],
)
def test_the_force_limit_is_that_of_the_run(name, key):
    """If it failed, a run with --f-max would be exported and verified with the profile's force."""
    datum = Datum(key=key, value=12.5, unit="", source="")
    assert read_machine(with_profile(name, [datum])).drive.max_force == 12.5
