"""Measured responses -> profile, as ``mtcommission identify`` does."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path

from mtcommission.errors import Fault, InputError
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.profile.read import parse_profile
from mtcommission.units.quantities import LENGTH, RATIO
from mtcommission.wizard.axis_units import is_rotary
from mtcommission.wizard.question import Answers, si_value


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """A profile from measurements.

    Parameters
    ----------
    text
        TOML; lacks what no response tells.
    motion
        "linear" or "rotary".
    found
        What was found, in a sentence.
    doubts
        What to mind about it.
    evidence_file, evidence
        File with points and advice that the profile names, and its text.
    """

    text: str
    motion: str
    found: Message
    doubts: tuple[Message, ...]
    evidence_file: str
    evidence: str


def identify_files(
    typed: str,
    *,
    before: str,
    answers: Answers,
    output: Path,
    date: str,
    words: Callable[[Answers], Catalogue],
) -> Measured:
    """Identify an axis from files.

    Parameters
    ----------
    typed
        Names, with ; or , between them, each possibly with ``@encoder`` or ``@tcp``.
    before
        Profile that takes the modes in; "" for a new one.
    answers
        What is known: kind of the axis and the motor's way to it.
    output
        Where the profile will stand, for hints.
    date
        ISO 8601, day.
    words
        Language of the comments, for the axis that answers describe.

    Raises
    ------
    InputError
        A file cannot be read, or leaves open what its columns are; or the profile is not valid.
    """
    from mtcommission.identify.axes import by_axis
    from mtcommission.identify.check import check_records
    from mtcommission.identify.document import Writing, kind_replaced, merge_profile, write_profile
    from mtcommission.identify.entry import identified_json, identified_part
    from mtcommission.identify.gather import gather
    from mtcommission.identify.given import Given
    from mtcommission.identify.statement import evidence_file
    from mtcommission.identify.states import identify
    from mtcommission.record.files import dump_json
    from mtcommission.sheet.identified import doubts_and_notes

    if before:
        parse_profile(before, where=str(output))
    names = [name.strip().strip("'\"") for name in re.split("[;,]", typed) if name.strip()]
    axes = list(by_axis([name.partition("@")[0] for name in names]))
    if len(axes) > 1:
        message = Message("wizard-several-axes", axes=", ".join(axes))
        raise InputError([Fault(where=typed, message=message)])
    lead = si_value(answers, "drive.lead", LENGTH)
    gear = si_value(answers, "drive.gear", RATIO) or 1.0
    given = Given(
        rotary=is_rotary(answers) if before else None,
        motor_turn=2.0 * pi * gear / lead if lead and not is_rotary(answers) else 0.0,
    )
    found = identify(gather(names, given))
    if found.doubt:
        raise InputError([Fault(where=typed, message=found.doubt)])
    motion = "rotary" if found.rotary else "linear"
    checks = check_records(found, force_per_unit=None, band_hz=None, count=None)
    part = identified_part(found, checks=checks, created=date)
    part = replace(part, warnings=[*part.warnings, *kind_replaced(before)])
    evidence = evidence_file(str(output))
    how = Writing(
        date=date,
        file=str(output),
        tool_ratio=None,
        words=words({"machine.motion": motion}),
        part=part,
        evidence=Path(evidence).name,
        axis=(axes and axes[0]) or "X",
    )
    text = merge_profile(before, found, how) if before else write_profile(found, how)
    return Measured(
        text=text,
        motion=motion,
        found=Message("wizard-identified", count=len(found.modes)),
        doubts=doubts_and_notes(part)[0],
        evidence_file=evidence,
        evidence=dump_json(identified_json(part, profile=text)),
    )
