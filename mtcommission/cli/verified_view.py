"""What a trace says, as the terminal shows it."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from mtcommission.cli.language import words
from mtcommission.cli.terminal import heading, warn
from mtcommission.verify.checks import Verdict
from mtcommission.verify.new_limits import NewLimits
from mtcommission.verify.refine import Refined
from mtcommission.verify.verify import Verification
from mtcommission.verify.wording import (
    check_row,
    limit_rows,
    parameter_row,
    say_check,
    say_test,
    say_verdict,
)

STYLES = {Verdict.HOLDS: "bold green", Verdict.FAILS: "bold red", Verdict.UNKNOWN: "bold yellow"}


def describe_verification(found: Verification, refined: Refined, limits: NewLimits | None) -> Group:
    """Return the verdict, the planner's first, every check, and what is different.

    Parameters
    ----------
    found
        From ``verify``.
    refined, limits
        Parameters as the traces show them, and what they lead to if that was asked for.
    """
    spoken = words()
    say = spoken.text
    obeyed = {True: "yes", False: "no", None: "unknown"}[found.obeyed]
    parts: list[RenderableType] = [
        heading(f"{found.record.machine.name}, {say('axis')} {found.record.machine.axis}"),
        Text(spoken.say(found.headline), style=STYLES[found.verdict]),
        Text(say("verify-detail", moves=len(found.recorded), obeyed=obeyed)),
        *warn(spoken, found.warnings),
        Text(),
    ]
    table = _table(*(say(f"verify-head-{head}") for head in ("what", "allowed", "measured")), "")
    reasons = []
    for check in found.checks:
        what, predicted, allowed, measured, why = check_row(check, spoken)
        verdict = say_verdict(check.verdict, spoken)
        if check.measured is not None or check.decides:
            bound = allowed if check.limit is not None else predicted
            table.add_row(what, bound, measured, Text(verdict, style=STYLES[check.verdict][5:]))
        if check.verdict is not Verdict.HOLDS:
            reasons.append(Text(f"{say_check(check, spoken)}: {why}"))
    parts += [table, Text(), *reasons]
    if refined.parameters:
        table = _table(*(say(f"verify-head-{head}") for head in ("parameter", "old", "new")), "")
        for one in refined.parameters:
            table.add_row(*parameter_row(one, spoken))
        parts += [Text(), table]
    if found.unexplained is not None:
        parts.append(Text(say("verify-unexplained", share=found.unexplained)))
    if note := say_test(refined, spoken):
        parts.append(Text(note))
    if limits is not None:
        table = _table("", say("verify-head-old"), say("verify-head-new"))
        for row in limit_rows(limits, spoken):
            table.add_row(*row)
        parts += [Text(), table]
        if limits.failure:
            parts += warn(spoken, [limits.failure])
    return Group(*parts)


def _table(*heads: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for head in heads:
        table.add_column(head, overflow="fold")
    return table
