"""Broken and half-broken profiles: an exit code and a message, never a traceback.

``python -m benchmarks.fuzz`` does so for every command, ten thousand times if need be.
MTCOMMISSION_FUZZ sets how many mutated profiles are tried (default: some hundred).
"""

from __future__ import annotations

import os
import re
from dataclasses import replace
from functools import partial
from importlib import import_module

import pytest

from benchmarks.fuzz import WARM, Ending, arguments_of, call, fault_of, in_place
from benchmarks.mutations import dice_of, mutated, mutated_text, mutated_values, shipped_texts
from mtcommission.commission.commission import commission
from mtcommission.machine.profile.shipped import read_shipped

COUNT = int(os.environ.get("MTCOMMISSION_FUZZ", "90"))

TEXTS = shipped_texts()

LONGEST = 60.0
"""CPU time of one check that counts as a hang [s]; a good profile takes some 10 ms."""


def test_mutated_profiles_never_crash_check(tmp_path):
    path = tmp_path / "mutated.toml"
    codes: dict[int, int] = {}
    for seed in range(COUNT):
        text = mutated(TEXTS[seed % len(TEXTS)], dice_of(17, seed))
        path.write_text(text, "utf-8", newline="")
        ending = in_place(partial(call, "check", str(path)))
        assert not fault_of("check", ending, longest=LONGEST), (seed, ending)
        assert ending.code in (0, 2, 3), (seed, ending)
        if ending.code == 2:
            assert "mutated.toml" in ending.said, (seed, ending)
            lines = re.findall(r"mutated\.toml:(\d+)", ending.said)
            assert all(1 <= int(line) <= len(text.split("\n")) for line in lines), (seed, ending)
            assert ending.said.replace("\n", "").isprintable(), (seed, ending)
        codes[ending.code] = codes.get(ending.code, 0) + 1
    assert codes[0] > 0.1 * COUNT  # else nothing beyond the reader was tried
    assert codes[2] > 0.2 * COUNT


@pytest.mark.parametrize(("command", "count"), [("simulate", 1), ("optimal", 2)])
def test_machines_with_slips_of_units_are_computed_or_refused(command, count, tmp_path):
    """Numbers off by powers of ten get through the reader; the computation must cope."""
    path, tried, seed = tmp_path / "slip.toml", 0, 0
    while tried < count:
        seed += 1
        dice = dice_of(29, seed)
        path.write_text(mutated_values(TEXTS[seed % len(TEXTS)], dice), "utf-8", newline="")
        if call("check", str(path))[0] == 0:
            tried += 1
            ending = in_place(partial(call, *arguments_of(command, path, dice)))
            assert not fault_of(command, ending, longest=LONGEST), (seed, ending)


def test_the_fuzzer_finds_what_it_loads_before_its_cases():
    """If it failed, no command could be fuzzed: that went unnoticed after a module had moved."""
    for name in WARM:
        assert import_module(name)


@pytest.mark.parametrize(
    ("command", "code", "said", "how", "fault"),
    [
        ("check", 2, "p.toml:3: plant.base_mass: got nan", {}, ""),
        ("check", 0, "Mass nan kg", {}, "prints nan"),
        ("check", 0, "Axis nan. Source of the data: x. Mass 3 kg", {}, ""),  # the user's own words
        ("limits", -1, "ended by the system, status 24", {}, "exit code -1"),
        ("limits", 3, "internal error, please report it", {}, "internal error"),
        ("limits", 0, "met. RuntimeWarning: overflow", {}, "RuntimeWarning"),
        ("limits", 2, "p.toml: got \x1b[31m", {}, repr("\x1b")),
        ("run", 1, " ", {}, "silent"),
        ("run", 0, "met", {"memory": 2000.0}, "2000 MB"),
        ("run", 0, "met", {"processor": 61.0}, "61.0 s of CPU, more than 60.0 s"),
    ],
)
def test_the_fuzzer_sees_what_is_bad(command, code, said, how, fault):
    """What it does not see, ten thousand profiles do not find."""
    ending = Ending(code=code, said=said, **{"processor": 1.0} | how)
    assert fault_of(command, ending, longest=LONGEST) == fault


def test_mutated_profiles_never_crash_the_wizard(tmp_path):
    """Opened as the profile to be changed, and taken as a file of answers: what it writes is a
    profile, or it says what is wrong."""
    profile, new = tmp_path / "mutated.toml", tmp_path / "new.toml"
    codes: dict[int, int] = {}
    for seed in range(COUNT // 4):
        text = mutated_text(TEXTS[seed % len(TEXTS)], dice_of(21, seed))
        for arguments in (("-o", profile), ("-o", new, "--answers", profile)):
            profile.write_text(text, "utf-8", newline="")
            new.unlink(missing_ok=True)
            code, said = call("wizard", "--yes", *map(str, arguments))
            assert code in (0, 2), (seed, arguments, code, said)
            assert "Traceback" not in said, (seed, said)
            # 3: a move that is valid, but too long to be followed.
            assert code == 2 or call("check", str(arguments[1]))[0] in (0, 3), (seed, arguments)
            codes[code] = codes.get(code, 0) + 1
    assert codes[0] > 0.05 * COUNT / 4
    assert codes[2] > 0.05 * COUNT / 4


def test_a_crawl_to_a_tiny_velocity_gets_limits():
    """Its grid of limits to look at is empty, which once was an internal error."""
    machine = read_shipped("milling-manipulator").machine
    slow = replace(machine, moves=(replace(machine.moves[0], velocity_step=6e-4),))
    found = commission(slow)
    assert found.recommended.residual_deviation <= slow.requirements.tcp_deviation
