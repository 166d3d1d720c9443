"""What a trace says, as the terminal shows it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.language import words
from mtcommission.cli.terminal import Line, describe_table, heading, table, warn
from mtcommission.sheet.document import Paragraph, Table, Tone
from mtcommission.verify.checks import Check, Verdict
from mtcommission.verify.report import (
    Report,
    check_row,
    known_first,
    list_differences,
    say_detail,
    say_reasons,
)

if TYPE_CHECKING:
    from mtcommission.group.verify import CircleVerification

STYLES = {Verdict.HOLDS: "green", Verdict.FAILS: "red", Verdict.UNKNOWN: "yellow"}


def describe_verification(told: Report) -> list[Line]:
    """Return the verdict, what was measured, each reason once, and what is different."""
    found = told.found
    spoken = words()
    say = spoken.text
    checks = [check for check in known_first(found.checks) if check.measured is not None]
    machine = found.record.machine
    lines: list[Line] = [
        heading(say("terminal-machine", name=machine.name, axis_name=machine.axis)),
        (spoken.say(found.headline), f"bold {STYLES[found.verdict]}"),
        say_detail(found, spoken),
        *warn(spoken, found.warnings),
        *_checks(checks, "permitted", found.checks, spoken),
    ]
    for block in list_differences(told, spoken):
        if isinstance(block, Table):
            lines += ["", *describe_table(block)]
        elif isinstance(block, Paragraph):
            lines.append((block.text, "yellow" if block.tone is Tone.WARNING else ""))
    return lines


def describe_circles(found: CircleVerification) -> list[Line]:
    """Return the verdict on recorded circles, what was measured, and what was found."""
    spoken, axes = words(), found.record.axes
    names = ", ".join(axis.name for axis in axes)
    return [
        heading(spoken.text("group-axes", name=axes[0].machine.name, axes=names)),
        (spoken.say(found.headline), f"bold {STYLES[found.verdict]}"),
        *warn(spoken, found.warnings),
        *_checks(found.checks, "verify-head-predicted", found.checks, spoken),
        *map(spoken.say, found.sentences),
    ]


def _checks(
    shown: Sequence[Check], head: str, every: Sequence[Check], spoken: Catalogue
) -> list[Line]:
    """Each promise beside what was measured, and the reasons of those that do not hold."""
    rows = []
    for check in shown:
        what, predicted, allowed, measured, verdict = check_row(check, spoken)
        rows.append((what, predicted if check.limit is None else allowed, measured, verdict))
    heads = [*(spoken.text(name) for name in ("verify-head-what", head, "measured")), ""]
    styles = [STYLES[check.verdict] for check in shown]
    return ["", *table(heads, rows, styles), "", *say_reasons(every, spoken)]
