"""What a trace says, as the terminal shows it."""

from __future__ import annotations

from mtcommission.cli.language import words
from mtcommission.cli.terminal import Line, heading, table, warn
from mtcommission.sheet.document import Paragraph, Table, Tone
from mtcommission.verify.checks import Verdict
from mtcommission.verify.report import (
    Report,
    check_row,
    known_first,
    list_differences,
    say_detail,
    say_reasons,
)

STYLES = {Verdict.HOLDS: "green", Verdict.FAILS: "red", Verdict.UNKNOWN: "yellow"}


def describe_table(found: Table) -> list[Line]:
    """Return the rows of a table of the sheet."""
    rows = [[str(cell) for cell in row] for row in found.rows]
    return table([column.head for column in found.columns], rows)


def describe_verification(told: Report) -> list[Line]:
    """Return the verdict, what was measured, each reason once, and what is different."""
    found = told.found
    spoken = words()
    say = spoken.text
    checks = [check for check in known_first(found.checks) if check.measured is not None]
    rows = []
    for check in checks:
        what, predicted, allowed, measured, verdict = check_row(check, spoken)
        rows.append((what, predicted if check.limit is None else allowed, measured, verdict))
    heads = [*(say(f"verify-head-{name}") for name in ("what", "allowed", "measured")), ""]
    machine = found.record.machine
    lines: list[Line] = [
        heading(say("terminal-machine", name=machine.name, axis_name=machine.axis)),
        (spoken.say(found.headline), f"bold {STYLES[found.verdict]}"),
        say_detail(found, spoken),
        *warn(spoken, found.warnings),
        "",
        *table(heads, rows, [STYLES[check.verdict] for check in checks]),
        "",
        *say_reasons(found.checks, spoken),
    ]
    for block in list_differences(told, spoken):
        if isinstance(block, Table):
            lines += ["", *describe_table(block)]
        elif isinstance(block, Paragraph):
            lines.append((block.text, "yellow" if block.tone is Tone.WARNING else ""))
    return lines
