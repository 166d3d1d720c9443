"""The package in a Python prompt and a notebook: light to import, short to look at, documented."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

import mtcommission
from mtcommission.base.errors import InputError
from tests.test_profile import MODAL

DOCS = Path(__file__).parent.parent / "docs" / "python.md"

SMALL = (
    MODAL.replace('name = "m"', 'name = "Small <b>axis</b> $x_1$"').replace("5 um", "50 um")
    + 'frequency_spread = "5 %"\ndamping_spread = "0 %"\nmove_sizes = "listed"\n'
    + '[control]\nsetpoint_filter = "none"\n'
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("python")
    (folder / "axis.toml").write_text(SMALL, "utf-8")
    return folder


@pytest.fixture(scope="module")
def found(folder):
    return mtcommission.run(folder / "axis.toml")


def test_importing_the_package_loads_nothing_heavy():
    """Whoever only asks for the version must not wait for numpy."""
    code = (
        "import sys, mtcommission; print(sorted({'numpy', 'typer', 'control'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_prompt_and_a_notebook_show_the_verdict_and_what_to_type_in(found):
    """250 kB of dataclass bury both; names of the user are no markup."""
    line, html = repr(found), found._repr_html_()
    best = found.recommended.limits
    assert len(line.splitlines()) == 1
    assert len(line) < 300
    for words in ("All requirements met", f"{best.acceleration:g}", f"{best.jerk:g}"):
        assert words in line
    assert len(html) < 200_000
    for words in ("All requirements met", "Recommended", "residual deviation", "data:image/png"):
        assert words in html
    judged = 1 + len(found.alternatives) + len(found.rules) + len(found.assessment.checks)
    assert len(re.findall("<tr>", html)) == judged + 2  # two heads
    assert "Small &lt;b&gt;axis&lt;/b&gt; $x_1$" in html
    assert "Small <b>" not in html


def test_what_misses_its_requirements_says_so(found):
    check = replace(found.assessment.checks[0], value=np.inf, is_met=False)
    missed = replace(found.recommended, assessment=replace(found.assessment, checks=(check,)))
    worse = replace(found, choice=replace(found.choice, candidate=missed))
    assert "Requirements NOT met" in repr(worse)
    assert "Requirements NOT met" in worse._repr_html_()
    assert "not settled" in worse._repr_html_()


def test_the_plot_shows_every_corner_in_its_unit(found):
    upper, lower = found.plot().axes
    response = found.moves[0].responses[0]
    nominal = next(line for line in upper.get_lines() if line.get_label() == "Nominal machine")
    assert np.max(np.abs(nominal.get_ydata())) == pytest.approx(1e6 * response.peak_deviation)
    assert np.max(nominal.get_xdata()) == pytest.approx(1e3 * response.t[-1])
    labels = (upper.get_ylabel(), lower.get_ylabel())
    assert labels == ("tool deviation in µm", "set force in kN")
    curves = [line for line in lower.get_lines() if len(line.get_xdata()) > 2]
    assert len(curves) == len(found.tuned.corners) == 3
    limits = [line.get_ydata()[0] for line in lower.get_lines() if len(line.get_xdata()) == 2]
    assert sorted(limits) == [-2.0, 2.0]  # kN


def test_a_record_holds_the_profile_that_was_run(found, folder):
    record = mtcommission.make_record(found)
    assert record.profile.name == "axis.toml"
    assert record.profile.text == (folder / "axis.toml").read_text("utf-8")
    with pytest.raises(InputError, match="run the profile's file"):
        mtcommission.make_record(replace(found, profile=None))


def test_the_documented_lines_run(found, folder, monkeypatch):
    """Names, shapes and units of the time series are what docs/python.md says."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(mtcommission, "run", lambda _: found)
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", DOCS.read_text("utf-8"), re.DOTALL):
        exec(compile(block, str(DOCS), "exec"), names)
    response, sent, tool = found.moves[0].responses[0], names["sent"], names["tool"]
    n = response.t.size
    assert response.deviation.shape == response.force.shape == tool.shape == (n,)
    assert response.states.shape == (n, len(found.plant.states))
    assert sent.shape == (n, 4)
    tau = found.tuned.controller.reference_delay
    delayed = np.interp(response.t - tau, response.t, sent[:, 0])
    np.testing.assert_allclose(tool - delayed, response.deviation, atol=2e-7)
    assert (folder / "sheet.pdf").read_bytes().startswith(b"%PDF")


def test_a_run_uses_one_thread_whatever_the_process_allows(folder, monkeypatch):
    """The commands set it from outside: in a notebook the digits came from other orders of sums."""
    seen: list[set[int]] = []

    def look(*_, **__):
        seen.append({one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"})

    monkeypatch.setattr("mtcommission.commission.commission.commission", look)
    monkeypatch.setattr("mtcommission.record.record.record_run", look)
    with threadpool_limits(limits=3, user_api="blas"):
        look()
        mtcommission.run(folder / "axis.toml")
        mtcommission.make_record(None)
        look()
    assert seen == [{3}, {1}, {1}, {3}]
