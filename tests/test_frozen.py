"""Frozen answers: what was written is found again, and what moved is said."""

from __future__ import annotations

import json
from pathlib import Path

from benchmarks.frozen_compare import compare

Files = dict[str, str]


def state(folder: Path, files: Files) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, "utf-8")
    return folder


def limits(settling_time: float, **more: object) -> str:
    return json.dumps({"recommended": {"settling_time": settling_time, **more}, "solve_time": 1.0})


BEFORE = {
    "inventory/options.txt": "run --appendix\nrun --no-pdf\n",
    "machines/07-isg/limits_en.txt": "exit 0\nSettling time 80 ms\nBound by: force\n",
    "machines/07-isg/limits_en/limits.json": limits(0.08, jerk=[1.0, 200.0], map=1),
    "times/machines 07-isg limits_en.json": json.dumps({"ratio": 500.0}),
}
AFTER = {
    "inventory/options.txt": "run --no-pdf\n",
    "machines/07-isg/limits_en.txt": "exit 1\nSettling time 84 ms\nBound by: jerk\n",
    "machines/07-isg/limits_en/limits.json": limits(0.084, jerk=[1.0, 200.00001]),
    "times/machines 07-isg limits_en.json": json.dumps({"ratio": 20.0}),
}


def test_what_moved_between_two_states_is_said_with_its_size(tmp_path: Path) -> None:
    """If it failed, the rebuild could lose an option or slow a machine and nobody would see it."""
    before, after = state(tmp_path / "a", BEFORE), state(tmp_path / "b", AFTER)
    said = compare(before, after, least=1e-6, rows=0)
    for expected in (
        "settling times of 1 machines: 1 longer by more than 0.3 % (most +5.000 %), 1 verdicts",
        "machines/07-isg/limits_en.txt: exit 0 -> exit 1",
        "inventory/options.txt: run --appendix",
        "machines/*/limits_*/limits.json recommended.map",
        "80 ms        84 ms    +5.000 %  met -> not met",
        "-Bound by: force\n  +Bound by: jerk",
        "500.0 ->     20.0  x 0.040",
    ):
        assert expected in said
    assert "-Settling time" not in said  # the words are the same: a number that moved
    assert "1 other" not in said
    assert "solve_time" not in said
    assert "recommended.jerk" not in said  # 5e-8 of the array's largest
    assert "recommended.jerk" in compare(before, after, least=1e-8, rows=0)
