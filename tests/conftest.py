"""Tests repeat: one thread for small matrices, as on the command line, and the same examples.

`HYPOTHESIS_PROFILE=explore python -m pytest` draws new examples at each run instead.
"""

import os
import sys
from collections.abc import Callable

import pytest
from hypothesis import settings

from mtcommission import cli
from mtcommission.base.messages import ENGLISH
from mtcommission.cli.language import LOCALE, choose

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")
for name in LOCALE:  # what is printed must not hang on who runs the tests
    os.environ.pop(name, None)

settings.register_profile("repeatable", derandomize=True, database=None, deadline=None)
settings.register_profile("explore", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


@pytest.fixture(autouse=True)
def _english() -> None:
    """A command that spoke German leaves its language behind in the process."""
    choose(ENGLISH)


Result = tuple[int, str, str]
Run = Callable[..., Result]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run one command in this process; returns exit code, output and error output."""

    def call(*arguments: object) -> Result:
        monkeypatch.setattr(sys, "argv", ["mtcommission", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            cli.main()
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err + captured.out
        return int(stopped.value.code or 0), captured.out, captured.err

    return call
