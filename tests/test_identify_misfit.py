"""Where no model describes what was measured, nobody gets a profile without being told.

If one of these fails, limits are chosen for a machine that was never seen.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests import identify_files as made
from tests.conftest import Run

LINES = np.geomspace(2.0, 500.0, 400)


def _plant(f: made.Array) -> made.ComplexArray:
    s, omega = 2j * np.pi * f, 2 * np.pi * 62.0
    return 1.0 / (0.12 * s) + 6.0 * s / (s * s + 0.05 * omega * s + omega**2)


def closed_loop(f: made.Array) -> made.ComplexArray:
    """From the setpoint of a speed loop to the speed: 1 at low frequency."""
    s = 2j * np.pi * f
    open_loop = 40.0 * (1.0 + 1.0 / (0.01 * s)) * np.exp(-0.5e-3 * s) * _plant(f)
    return open_loop / (1.0 + open_loop)


def sticking(f: made.Array) -> made.ComplexArray:
    """Below 40 Hz the axis sticks in some lines and slides in others, each time alike."""
    rng = np.random.default_rng(6)
    stuck = np.where(f < 40.0, rng.uniform(0.05, 1.0, f.size), 1.0)
    return _plant(f) * stuck * np.exp(1j * np.where(f < 40.0, rng.uniform(-1.0, 1.0, f.size), 0.0))


def changing(f: made.Array) -> made.ComplexArray:
    """From 30 to 80 Hz other lines than beside belong to another machine."""
    rng = np.random.default_rng(7)
    other = (f > 15.0) & (f < 80.0) & (rng.uniform(size=f.size) < 0.5)
    return np.where(other, 3.0 * _plant(0.8 * f) * np.exp(1j), _plant(f))


def _table(path: Path, values: made.ComplexArray) -> str:
    how = {"noise": 2e-3, "averages": 20, "unit": "rad/s/(N m)", "seed": 8}
    return made.save_response(path, LINES, values, **how)


WRONG = {
    "closed loop": (closed_loop, "probably the wrong response"),
    "sticking": (sticking, "friction that sticks"),
    "changing": (changing, "feedback in the measurement"),
}


@pytest.mark.parametrize("name", list(WRONG))
def test_a_misfit_is_no_answer(run: Run, tmp_path: Path, name: str) -> None:
    values, cause = WRONG[name]
    file, new, out = _table(tmp_path / "x.csv", values(LINES)), tmp_path / "x.toml", "found.json"
    code, printed, _ = run("identify", file, "-o", str(new), "--json", str(tmp_path / out))
    assert code == 1
    first = " ".join(printed.split("x.csv")[0].split())
    assert first.startswith("No profile: the model does not describe what was measured: ")
    shown = " ".join(printed.split())
    assert cause in shown
    assert "easure" in shown  # what to measure instead
    both = ("within the band the axis is a rigid mass", "No rigid body shows in the band")
    assert not all(doubt in shown for doubt in both)
    assert not new.exists()
    found = json.loads((tmp_path / out).read_text())
    assert found["profile"] == ""
    assert "identify-not-described" in {one["message"] for one in found["warnings"]}


def test_force_writes_the_reason_on_the_first_line_and_check_repeats_it(
    run: Run, tmp_path: Path
) -> None:
    """Such a profile is never taken without a word."""
    file, new = _table(tmp_path / "x.csv", sticking(LINES)), tmp_path / "x.toml"
    code, printed, _ = run("identify", file, "--band", "2:500", "-o", str(new), "--force")
    assert code == 0
    assert printed.startswith("Forced: the model does not describe what was measured")
    text = new.read_text(encoding="utf-8")
    first = text.splitlines()[0]
    assert first.startswith("# Forced: the model does not describe what was measured: misfit ")
    needs = '[requirements]\ntcp_deviation = "1 mrad"\n'
    more = '[drive]\nmax_force = "100 N m"\nforce_lag = "1 ms"\n[[moves]]\nvelocity_step = 0.5\n'
    text = re.sub(r"^misfit = .*$", "misfit = 60.0", text, flags=re.MULTILINE)
    new.write_text(text.replace("[requirements]\n", needs) + more, encoding="utf-8")
    code, printed, said = run("check", str(new))
    assert code == 0, said
    assert "misfit 60, at most 10" in " ".join(printed.split())
