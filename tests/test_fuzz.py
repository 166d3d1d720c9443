"""Broken and half-broken profiles: an exit code and a message, never a traceback.

MTCOMMISSION_FUZZ sets how many mutated profiles are tried (default: a few hundred).
"""

from __future__ import annotations

import io
import os
import re
import time
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pint
import pytest

from mtcommission import cli
from mtcommission.choose import SearchSettings
from mtcommission.commission import commission
from mtcommission.errors import ComputationError, InputError
from mtcommission.loop_choice import Settings
from mtcommission.machine import Machine, Manipulator, flexible_modes, frequency_hz
from mtcommission.profile import parse_profile
from mtcommission.shipped import read_shipped, shipped_names

COUNT = int(os.environ.get("MTCOMMISSION_FUZZ", "200"))

TEXTS = [read_shipped(name).text for name in shipped_names()]

LONGEST = 20.0
"""CPU time of one check that counts as a hang [s]; a good profile takes some 10 ms."""

JUNK = "\"'#[]{}=,.\n\\\t \0é€µΩ\ufeff\u202e😀-+eE0123456789abcxyz_%/^*()"
NUMBERS = (
    "0", "-1", "1e308", "1e-308", "1e999", "nan", "inf", "-inf", "0x10", "1_000", "9" * 5000,
    "true",
    "1979-05-27", '"1e9999 kg"', '"-0 kg"', '"1 kg kg kg"', '"٣ kg"', '"1/0 m"', '"m"', '""',
    "[]", "{}", '"1' + "(" * 60 + '"',
)  # fmt: skip
UNITS = ("kg", "t", "N", "kN", "um", "mm", "m", "rad", "deg", "rev/min", "s", "ms", "Hz", "N m",
         "%",
         "furlong", "N/um", "kg m^2", "m/s")  # fmt: skip


def _mutate(text: str, dice: np.random.Generator) -> str:
    """Break a profile in one of the ways in which editors, people and disks break files."""
    lines = text.split("\n")
    at, line = int(dice.integers(len(text))), int(dice.integers(len(lines)))
    other = int(dice.integers(len(lines)))
    match int(dice.integers(11)):
        case 0:
            return text[:at]
        case 1:
            return text[:at] + text[at + int(dice.integers(1, 30)) :]
        case 2:
            return text[:at] + JUNK[int(dice.integers(len(JUNK)))] + text[at:]
        case 3:
            noise = "".join(JUNK[i] for i in dice.integers(0, len(JUNK), 40))
            return text[:at] + noise + text[at:]
        case 4:
            return "\n".join([*lines[:line], *lines[line + 1 :]])
        case 5:
            return "\n".join([*lines[: line + 1], lines[other], *lines[line + 1 :]])
        case 6:
            lines[line], lines[other] = lines[other], lines[line]
            return "\n".join(lines)
        case 7:
            number = NUMBERS[int(dice.integers(len(NUMBERS)))]
            return _replace_some(r"(?<== )[^#\n]+", number + " ", text, dice)
        case 8:
            unit = UNITS[int(dice.integers(len(UNITS)))]
            return _replace_some(r'(?<=\d )[A-Za-z][^"]*(?=")', unit, text, dice)
        case 9:
            scale = f"{10.0 ** float(dice.integers(-12, 13)):g}"
            return _replace_some(r'(?<=")[-+0-9.e]+(?= )', scale, text, dice)
        case _:
            return _replace_some(r"^[a-z_]+(?= =)", "zzz", text, dice)


def _replace_some(pattern: str, new: str, text: str, dice: np.random.Generator) -> str:
    places = list(re.finditer(pattern, text, re.MULTILINE))
    for place in reversed(places):
        if dice.random() < 2.0 / len(places):
            text = text[: place.start()] + new + text[place.end() :]
    return text


def _run(*arguments: str) -> tuple[int, str]:
    """One command in this process: exit code and all that was said."""
    out, err = io.StringIO(), io.StringIO()
    code: object = 0
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(err):
        patch.setattr("sys.argv", ["mtcommission", *arguments])
        try:
            cli.main()
        except SystemExit as stopped:
            code = stopped.code
    assert isinstance(code, int)
    return code, out.getvalue() + err.getvalue()


def test_mutated_profiles_never_crash_check(tmp_path: Path) -> None:
    path = tmp_path / "mutated.toml"
    codes: dict[int, int] = {}
    for seed in range(COUNT):
        dice = np.random.default_rng([17, seed])
        text = TEXTS[seed % len(TEXTS)]
        for _ in range(int(dice.integers(1, 4))):
            text = _mutate(text, dice) or text
        path.write_text(text, "utf-8", newline="")
        begun = time.process_time()
        code, said = _run("check", str(path))
        took = time.process_time() - begun
        assert code in (0, 2, 3), (seed, code, said)
        assert "Traceback" not in said, (seed, said)
        assert "internal error" not in said, (seed, said)
        assert took < LONGEST, (seed, took)
        if code:
            assert "mutated.toml" in said or code == 3, (seed, said)
        else:
            assert not re.search(r"\b(nan|inf)\b", said.split("Source of the data", 1)[1]), seed
        codes[code] = codes.get(code, 0) + 1
    assert codes[0] > 0.1 * COUNT  # else nothing beyond the reader was tried
    assert codes[2] > 0.2 * COUNT


def test_mutated_profiles_never_crash_the_wizard(tmp_path: Path) -> None:
    """Opened as the profile to be changed, and taken as a file of answers: what it writes is a
    profile, or it says what is wrong."""
    profile, new = tmp_path / "mutated.toml", tmp_path / "new.toml"
    codes: dict[int, int] = {}
    for seed in range(COUNT // 5):
        dice = np.random.default_rng([21, seed])
        text = TEXTS[seed % len(TEXTS)]
        for _ in range(int(dice.integers(1, 3))):
            text = _mutate(text, dice) or text
        for arguments in (("-o", profile), ("-o", new, "--answers", profile)):
            profile.write_text(text, "utf-8", newline="")
            new.unlink(missing_ok=True)
            code, said = _run("wizard", "--yes", *map(str, arguments))
            assert code in (0, 2), (seed, arguments, code, said)
            assert "Traceback" not in said, (seed, said)
            assert code == 2 or _run("check", str(arguments[1]))[0] == 0, (seed, arguments)
            codes[code] = codes.get(code, 0) + 1
    assert codes[0] > 0.05 * COUNT / 5
    assert codes[2] > 0.05 * COUNT / 5


@pytest.mark.parametrize("seed", range(4))
def test_random_bytes_are_refused(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "bytes.toml"
    path.write_bytes(np.random.default_rng([18, seed]).bytes(4096))
    code, said = _run("check", str(path))
    assert code == 2
    assert "bytes.toml" in said


UREG = pint.UnitRegistry()

KEYS = {
    "base_mass": ("kg", ("kg", "t", "g")),
    "slider_mass": ("kg", ("kg", "t")),
    "lever_arm": ("m", ("m", "mm", "cm")),
    "base_stiffness": ("N/m", ("N/um", "kN/mm", "N/mm", "MN/m")),
    "rotary_stiffness": ("N m/rad", ("N m/rad", "kN m/rad")),
    "max_force": ("N", ("N", "kN")),
    "force_lag": ("s", ("ms", "us", "s")),
    "velocity_step": ("m/s", ("m/s", "mm/s", "m/min")),
    "tcp_deviation": ("m", ("um", "mm", "nm")),
}


def _field(machine: Machine, key: str) -> float:
    mechanics = machine.mechanics
    assert isinstance(mechanics, Manipulator)
    for part in (mechanics, machine.drive, machine.moves[0], machine.requirements):
        if hasattr(part, key):
            return float(getattr(part, key))
    raise KeyError(key)


def test_mutated_values_are_read_right_or_refused() -> None:
    """Against pint: a wrong number that passes silently is the worst that can happen."""
    text = read_shipped("milling-manipulator").text
    accepted = 0
    for seed in range(COUNT):
        dice = np.random.default_rng([19, seed])
        key = list(KEYS)[int(dice.integers(len(KEYS)))]
        si, units = KEYS[key]
        unit = units[int(dice.integers(len(units)))]
        number = f"{10.0 ** dice.uniform(-7, 7):.{int(dice.integers(1, 6))}g}"
        changed, found = re.subn(
            rf'^{key} = "[^"]*"', f'{key} = "{number} {unit}"', text, flags=re.MULTILINE
        )
        assert found == 1
        expected = float(UREG.Quantity(float(number), unit.replace(" m/rad", "*m/rad")).to(si).m)
        try:
            machine = parse_profile(changed, where="a.toml")
        except InputError as error:
            refusals = str(error)
        else:
            accepted += 1
            assert _field(machine, key) == pytest.approx(expected, rel=1e-14), (seed, key)
            continue
        assert number in refusals or "ratio" in refusals, (seed, refusals)
    assert accepted > 0.3 * COUNT


COARSE = SearchSettings(grid=16, coarse_grid=6, seeds=4, refinements=2)


@pytest.mark.parametrize("seed", range(max(3, COUNT // 200)))
def test_machines_far_from_the_examples_end_in_limits_or_a_named_outcome(seed: int) -> None:
    """The whole chain: what it answers is finite, within the force, and judged by itself."""
    dice = np.random.default_rng([20, seed])
    machine = read_shipped("milling-manipulator").machine
    mechanics = machine.mechanics
    assert isinstance(mechanics, Manipulator)
    factors = 10.0 ** (np.array([1.0, 1.0, 1.0, 0.4, 0.4]) * dice.uniform(-1.0, 1.0, 5))
    strange = replace(
        machine,
        mechanics=replace(
            mechanics,
            base_mass=mechanics.base_mass * factors[0],
            slider_mass=mechanics.slider_mass * factors[1],
            base_stiffness=mechanics.base_stiffness * factors[2],
        ),
        drive=replace(machine.drive, max_force=machine.drive.max_force * factors[3]),
        moves=(replace(machine.moves[0], velocity_step=0.1 * factors[4]),),
    )
    try:
        found = commission(strange, settings=Settings(search=COARSE, comparison=COARSE))
    except ComputationError:
        return  # a named outcome, with its remedy in the message
    limits = found.recommended.limits
    assert 0.0 < limits.acceleration < np.inf
    assert 0.0 < limits.jerk < np.inf
    m = strange.mechanics.slider_mass  # type: ignore[union-attr]
    assert limits.acceleration <= 1.01 * strange.drive.motion_force / m
    slowest = min(frequency_hz(mode) for mode in flexible_modes(strange))
    assert limits.jerk_time <= 3.1 / slowest
    if found.assessment.is_met:
        assert found.recommended.residual_deviation <= strange.requirements.tcp_deviation
