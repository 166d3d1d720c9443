"""An export: what is typed into the control, for its file and for page 1 of the sheet."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.base.messages.message import Message
from mtcommission.controls.syntax import Entry
from mtcommission.limits.judge import Candidate
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class Export:
    """Limits and loop in a control's own words."""

    header: tuple[str, ...]  # sentences above the parameters
    entries: tuple[Entry, ...]  # every row, those that are only remarks last
    limits: MotionLimits  # what the control makes of the typed numbers
    verdict: Candidate  # of the simulation of what the text holds
    is_met: bool  # whether it keeps all requirements in every corner, and the record's margins
    meets_requirements: bool  # whether, moreover, no machining mode had to be left out
    judgement: Message  # what the header says of that
    doubts: tuple[Message, ...]  # what it says of modes left out, a ceiling, and neutral words
    text: str  # the file
