"""The doors hold: an import that is not allowed breaks a contract, wherever it is put.

If one of these fails, a library can creep into every package and nobody is told.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import mtcommission

SOURCE = Path(mtcommission.__file__).parent
PROJECT = SOURCE.parent / "pyproject.toml"
SETTINGS = tomllib.loads(PROJECT.read_text(encoding="utf-8"))
EVERYWHERE = {"numpy", "scipy"}

[DOORS] = [
    contract
    for contract in SETTINGS["tool"]["importlinter"]["contracts"]
    if contract.get("source_modules") == ["mtcommission"]
]


def test_every_library_is_forbidden_but_at_its_door():
    """A dependency that no contract names could be used anywhere."""
    extra: dict[str, Any] = SETTINGS["project"]["optional-dependencies"]
    wanted = [*SETTINGS["project"]["dependencies"], *extra["cluster"]]
    names = {re.split(r"[ >=<\[.]", line)[0].lower() for line in wanted}
    assert names - EVERYWHERE <= {module.lower() for module in DOORS["forbidden_modules"]}


def test_what_is_not_allowed_is_seen(tmp_path):
    """Every library behind another door, a circle, and an arrow from the lowest package to the top,
    put into a copy of the project."""
    kept = shutil.ignore_patterns("__pycache__", "*.ftl", "profiles")
    shutil.copytree(SOURCE, tmp_path / "mtcommission", ignore=kept)
    shutil.copy(PROJECT, tmp_path)
    lowest, libraries = tmp_path / "mtcommission" / "base", set(DOORS["forbidden_modules"])
    put = "".join(f"import {one}\n" for one in (*sorted(libraries), "mtcommission.cli"))
    (lowest / "errors.py").write_text((lowest / "errors.py").read_text("utf-8") + put, "utf-8")
    (lowest / "chicken.py").write_text("import mtcommission.base.egg\n")
    (lowest / "egg.py").write_text("import mtcommission.base.chicken\n")
    program = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    said = subprocess.run(
        [sys.executable, "-c", program, "--no-cache"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    ).stdout
    for contract in (DOORS["name"], "no circle inside any package", "data flows one way"):
        assert f"{contract} BROKEN" in said
    assert set(re.findall(r"mtcommission.base.errors -> (\w+) \(l", said)) >= libraries
