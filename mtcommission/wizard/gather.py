"""What is known before the first question: the profile, kept answers, a file of answers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomlkit

from mtcommission.errors import Fault, InputError
from mtcommission.files import write_text
from mtcommission.machine.readers import one_of, propose
from mtcommission.messages.message import Message
from mtcommission.plant.kinds import KINDS
from mtcommission.profile.describe import find_unknown
from mtcommission.profile.lines import find_key_lines, read_key
from mtcommission.profile.read import load_toml, read_profile_text
from mtcommission.units.quantities import TIME
from mtcommission.wizard.axis_units import MEASURED, WAYS, YES
from mtcommission.wizard.convert import ASKED, OWN, to_answers
from mtcommission.wizard.question import ACCEPTED, Answers, list_accepted, note_accepted, si_value
from mtcommission.wizard.script import list_questions

KEPT = ".answers"
"""Ending of the file beside the profile that keeps answers of an unfinished session."""

DATE, DELAY, MEASURED_LAG = "identified.date", "identified.delay.0", "identified.lag.0"
"""Keys of a profile that was identified."""

PLACE = "wizard.place"
"""Key of that file: the question at which the user left."""


LAG, LEAST_LAG = "drive.force_lag", 5e-5
"""A shorter delay [s] is that of a sensor: the response comes from the actual force."""

OPEN = re.compile(r"\n\n# [^\n]*\n(#   [\w.\[\]]+\n)+\Z")
"""The list of open questions at the end of an identified profile: the wizard asks them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """What was known before the first question.

    Parameters
    ----------
    answers
        From all sources; later ones win.
    text
        Of the profile that is changed; "" for a new one.
    in_profile
        Keys that stand in it.
    is_resumed
        Whether only open questions shall be asked.
    place
        Key of the question at which the user left last time; "" for the first open one.
    passed
        Keys that a measurement answered: they are not asked, but < goes back to them.
    measured
        Files that the file of answers names and that are not identified yet; "" for none.
    where
        Name of the file of answers; "" without one.
    lines
        Line of each key in that file.
    """

    answers: dict[str, str]
    text: str
    in_profile: frozenset[str]
    is_resumed: bool
    place: str
    passed: frozenset[str]
    measured: str
    where: str
    lines: Mapping[str, int]

    def locate(self, fault: Fault) -> Fault:
        """Return a fault with its place in the file of answers; the profile is not written."""
        key = read_key(fault.key)
        return replace(fault, where=self.where or "answers", line=self.lines.get(key, 0))


def gather(output: Path, answers_file: Path | None, *, identified: str = "") -> Source:
    """Return what is known: existing profile, then kept answers, then the file of answers.

    Parameters
    ----------
    output
        Profile to be written or changed.
    answers_file
        TOML with answers by the profile's own keys; None without one.
    identified
        Profile from a measurement that takes the place of the existing one; "" without one.

    Raises
    ------
    InputError
        If a file cannot be read, or the file of answers has a key that nobody knows.
    """
    text, answers = "", {}
    if identified or output.exists():
        text = OPEN.sub("\n", identified or read_profile_text(output))
        data = load_toml(text, where=str(output))
        _require_asked(data, where=str(output))
        answers = to_answers(data)
    in_profile = frozenset(answers)
    answers = _with_lag(answers)
    kept = Path(f"{output}{KEPT}")
    if kept.exists():
        answers |= to_answers(load_toml(read_profile_text(kept), where=str(kept)))
    place = answers.pop(PLACE, "")
    lines: dict[str, int] = {}
    measured = ""
    if answers_file is not None:
        given = read_profile_text(answers_file)
        data = load_toml(given, where=str(answers_file))
        found = find_key_lines(given).lines
        lines = {".".join(map(str, path)): line for path, line in found.items()}
        answers |= _known(to_answers(data), where=str(answers_file), lines=lines)
        place, measured = "", "" if identified else answers.get(MEASURED, "")
    return Source(
        answers=answers,
        text=text,
        in_profile=in_profile,
        is_resumed=kept.exists() or answers_file is not None,
        place=place,
        passed=_passed(answers) if DATE in answers or answers.get(MEASURED) else frozenset(),
        measured=measured,
        where=str(answers_file or ""),
        lines=lines,
    )


def _require_asked(data: Mapping[str, Any], *, where: str) -> None:
    """Refuse a kind of plant that there are no questions for."""
    plant = data.get("plant")
    kind = plant.get("kind") if isinstance(plant, dict) else None
    if isinstance(kind, str) and kind in KINDS and kind not in ASKED:
        message = Message("wizard-kind-not-asked", kind=kind, kinds=one_of(tuple(ASKED)))
        raise InputError([Fault(where=where, key="plant.kind", message=message)])


def _with_lag(answers: dict[str, str]) -> dict[str, str]:
    """Take measured delay and lag for the lag of the force until somebody states it."""
    lag = sum(max(si_value(answers, key, TIME) or 0.0, 0.0) for key in (DELAY, MEASURED_LAG))
    if LAG in answers or lag < LEAST_LAG:
        return answers
    return note_accepted({**answers, LAG: f"{1e3 * lag:.3g} ms"}, LAG)


def _passed(answers: Answers) -> frozenset[str]:
    """What a measurement answers; what it had to assume is asked with that as default."""
    beginnings = (MEASURED, "wizard.way", "machine.motion", "machine.source", "plant.")
    spreads = ("requirements.frequency_spread", "requirements.damping_spread")
    assumed = list_accepted(answers)
    return frozenset(
        key for key in answers if key.startswith((*beginnings, *spreads)) and key not in assumed
    )


def keep(output: Path, answers: Answers, *, place: str) -> None:
    """Write the answers of an unfinished session beside the profile."""
    write_text(f"{output}{KEPT}", tomlkit.dumps({**answers, PLACE: place}))


def _known(answers: dict[str, str], *, where: str, lines: Mapping[str, int]) -> dict[str, str]:
    """The answers, if each has a key of the profile or of the wizard."""
    own = _own_keys()
    faults = []
    for key in answers:
        if _generic(key) in own or key == ACCEPTED:  # of a profile: machine.assumed
            continue
        wrong = propose(key, own) if key.startswith(OWN) else find_unknown(tuple(key.split(".")))
        if wrong:
            message = Message("key-unknown", hint=wrong)
            faults.append(Fault(where=where, line=lines.get(key, 0), key=key, message=message))
    if faults:
        raise InputError(sorted(faults, key=lambda fault: fault.line))
    return answers


def _own_keys() -> tuple[str, ...]:
    """Every key that is asked for in some way, elements of arrays as the first one."""
    keys: dict[str, None] = {}
    for way in WAYS:
        more = ("plant.modes.0.more", "pair.further", "moves.0.more")
        asked = {"wizard.way": way, "drive.lead": "10 mm", **dict.fromkeys(more, YES)}
        keys |= dict.fromkeys(_generic(question.key) for question in list_questions(asked))
    return tuple(keys)


def _generic(key: str) -> str:
    return re.sub(r"\.\d+(?=\.)", ".0", key)
