"""README's first command, run as it stands: what README shows as printed is what is printed.

`python -m pytest -n 0 tests/test_readme.py --snapshot-update` renews what README shows.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mtcommission import cli
from mtcommission.record.read_back import read_limits, read_machine
from mtcommission.record.record import load_record
from mtcommission.setpoint.setpoint import plan_setpoint, sample_setpoint
from tests.measured_example import PAYLOAD, SOFTER

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"


def blocks() -> list[str]:
    """Code blocks of README, in their order."""
    return re.findall(r"^```\n(.*?)^```", README.read_text("utf-8"), re.DOTALL | re.MULTILINE)


def call(line: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.chdir(folder)
    monkeypatch.setattr(sys, "argv", line.split())
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return int(ended.value.code or 0)


def test_the_first_command_prints_what_readme_shows(tmp_path, monkeypatch, capsys, request):
    """It writes all files; the sheet printed again from the record alone equals that of the run."""
    commands, shown = blocks()[:2]
    line = commands.splitlines()[0].split(" && ")[1]
    (profile,) = re.findall(r"profiles/\S+", line)
    (tmp_path / "profiles").mkdir()
    shutil.copy(ROOT / profile, tmp_path / profile)
    assert call(line, tmp_path, monkeypatch) == 0
    printed = capsys.readouterr().out
    lines = re.sub("[\u00a0\u202f]", " ", printed).splitlines()
    renewed = "".join(f"{line.rstrip()}\n" for line in lines)
    if request.config.option.update_snapshots:
        README.write_text(README.read_text("utf-8").replace(shown, renewed), "utf-8")
        shown = renewed
    assert shown == renewed
    assert max(map(len, printed.split("written into")[0].splitlines())) <= 80
    assert "next: mtcommission export out/record.json --control sinumerik" in printed
    out = tmp_path / "out"
    assert {file.name for file in out.iterdir()} == {
        "record.json", "sheet.html", "sheet.pdf", "setpoint.csv"
    }  # fmt: skip
    assert call("mtcommission sheet out/record.json -o again", tmp_path, monkeypatch) == 0
    for name in ("sheet.html", "sheet.pdf"):
        assert (out / name).read_bytes() == (tmp_path / "again" / name).read_bytes()
    # More acceleration than any move reaches would be up to the last digit of a sum: 5.72 on one
    # processor and 5.07 on another, with the same motion.
    record = load_record(out / "record.json")
    limits = replace(read_limits(record.limits.recommended), setpoint_filter=None)
    planned = [plan_setpoint(move, limits) for move in read_machine(record).moves]
    reached = [sample_setpoint(one, np.linspace(0.0, one.duration, 4001))[:, 2] for one in planned]
    assert max(a.max() for a in reached) == pytest.approx(limits.acceleration, rel=2e-3)


def test_the_way_of_an_axis_can_be_typed_as_it_stands(tmp_path, monkeypatch, capsys):
    """From the measured response to a move that holds.

    Where other limits are recommended, ``python -m tests.measured_example`` makes the move anew.
    """
    (lines,) = [block for block in blocks() if block.startswith("mtcommission identify")]
    (tmp_path / "profiles").mkdir()
    for name in re.findall(r"profiles/\S+", lines):
        shutil.copy(ROOT / name, tmp_path / name)
    printed = []
    for line in lines.splitlines():
        assert call(line, tmp_path, monkeypatch) == 0, line
        printed.append(" ".join(capsys.readouterr().out.split()))
    assert "Then: mtcommission check identified.toml" in printed[0]
    assert "The control sent what was entered" in printed[-1]
    # The deviation that is told to be there is found.
    refined = json.loads((tmp_path / "verified" / "verdict.json").read_text())["refined"]
    mass, beam = refined["mass"], refined["beam.frequency"]
    assert mass["new"] - mass["old"] == pytest.approx(PAYLOAD, abs=2.0 * mass["sigma"])
    assert beam["new"] / beam["old"] == pytest.approx(SOFTER, abs=2.0 * beam["sigma"] / beam["old"])
