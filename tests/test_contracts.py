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

import pytest

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


@pytest.fixture
def copy(tmp_path):
    """The project again, where imports may be put in."""
    kept = shutil.ignore_patterns("__pycache__", "*.ftl", "profiles")
    shutil.copytree(SOURCE, tmp_path / "mtcommission", ignore=kept)
    shutil.copy(PROJECT, tmp_path)
    return tmp_path


def lint(project: Path) -> str:
    """What import-linter says about a project."""
    program = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    return subprocess.run(
        [sys.executable, "-c", program, "--no-cache"],
        cwd=project,
        env={**os.environ, "PYTHONPATH": str(project), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    ).stdout


def packages(project: Path) -> list[Path]:
    """Every folder with modules, at any depth."""
    return sorted({path.parent for path in (project / "mtcommission").rglob("*.py")})


def module_of(project: Path, path: Path) -> str:
    return ".".join(path.relative_to(project).with_suffix("").parts)


def test_every_library_is_forbidden_but_at_its_door():
    """A dependency that no contract names could be used anywhere."""
    extra: dict[str, Any] = SETTINGS["project"]["optional-dependencies"]
    wanted = [*SETTINGS["project"]["dependencies"], *extra["cluster"]]
    names = {re.split(r"[ >=<\[.]", line)[0].lower() for line in wanted}
    assert names - EVERYWHERE <= {module.lower() for module in DOORS["forbidden_modules"]}


def test_what_is_not_allowed_is_seen_in_every_package(copy):
    """A library behind another door, a circle, and an arrow from the lowest package to the top."""
    put: set[tuple[str, str]] = set()
    names = set()
    for folder in packages(copy):
        path = next(path for path in sorted(folder.glob("*.py")) if path.name != "__main__.py")
        module = module_of(copy, path).removesuffix(".__init__")
        lines = []
        for library in DOORS["forbidden_modules"]:
            doors = (re.fullmatch(r"(.*) -> (.*)", line) for line in DOORS["ignore_imports"])
            inner = [door[1] for door in doors if door and door[2] == library]
            if not any(re.fullmatch(door.replace("*", r"\w+"), module) for door in inner):
                lines.append(f"import {library}\n")
                put.add((module, library))
        path.write_text(path.read_text(encoding="utf-8") + "".join(lines), encoding="utf-8")
        package = ".".join(folder.relative_to(copy).parts)
        (folder / "chicken.py").write_text(f"import {package}.egg\n")
        (folder / "egg.py").write_text(f"import {package}.chicken\n")
        names.add(package)
    path = copy / "mtcommission" / "base" / "messages" / "message.py"
    path.write_text(path.read_text(encoding="utf-8") + "import mtcommission.cli\n")
    said = lint(copy)
    assert f"{DOORS['name']} BROKEN" in said
    assert put <= set(re.findall(r"([\w.]+) -> ([\w]+) \(l", said))
    assert "no circle inside any package BROKEN" in said
    assert all(re.search(rf"{re.escape(name)}\b", said) for name in names)
    assert "data flows one way BROKEN" in said
