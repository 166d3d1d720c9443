"""What a trace says, as the terminal shows it."""

from __future__ import annotations

from mtcommission.cli.language import words
from mtcommission.cli.terminal import Line, heading, table, warn
from mtcommission.verify.checks import Verdict
from mtcommission.verify.feedforward import FeedForward
from mtcommission.verify.new_limits import NewLimits
from mtcommission.verify.refine import Refined
from mtcommission.verify.verify import Verification
from mtcommission.verify.wording import (
    check_row,
    limit_rows,
    parameter_row,
    say_check,
    say_feedforward,
    say_test,
    say_verdict,
)

STYLES = {Verdict.HOLDS: "green", Verdict.FAILS: "red", Verdict.UNKNOWN: "yellow"}


def describe_verification(
    found: Verification, refined: Refined, fed: FeedForward | None, limits: NewLimits | None
) -> list[Line]:
    """Return the verdict, the planner's first, every check, and what is different.

    ``refined``, ``fed``: parameters and feed-forward as the traces show them; ``limits``: what they
    lead to, if asked for.
    """
    spoken = words()
    say = spoken.text

    def heads(*names: str) -> list[str]:
        return [say(f"verify-head-{name}") if name else "" for name in names]

    rows, styles, reasons = list[list[str]](), list[str](), list[str]()
    for check in found.checks:
        what, predicted, allowed, measured, why = check_row(check, spoken)
        if check.measured is not None or check.decides:
            bound = allowed if check.limit is not None else predicted
            rows.append([what, bound, measured, say_verdict(check.verdict, spoken)])
            styles.append(STYLES[check.verdict])
        if check.verdict is not Verdict.HOLDS:
            reasons.append(f"{say_check(check, spoken)}: {why}")
    machine = found.record.machine
    obeyed = {True: "yes", False: "no", None: "unknown"}[found.obeyed]
    lines: list[Line] = [
        heading(say("terminal-machine", name=machine.name, axis_name=machine.axis)),
        (spoken.say(found.headline), f"bold {STYLES[found.verdict]}"),
        say("verify-detail", moves=len(found.recorded), obeyed=obeyed),
        *warn(spoken, found.warnings),
        "",
        *table(heads("what", "allowed", "measured", ""), rows, styles),
        "",
        *reasons,
    ]
    if refined.parameters:
        changed = (parameter_row(one, spoken) for one in refined.parameters)
        lines += ["", *table(heads("parameter", "old", "new", ""), changed)]
    if found.unexplained is not None:
        lines.append(say("verify-unexplained", share=found.unexplained))
    if note := say_test(refined, spoken):
        lines.append(note)
    if fed is not None:
        values = (parameter_row(one, spoken) for one in fed.values)
        lines += ["", *table(heads("feedforward", "old", "new", ""), values)]
        lines.append(say_feedforward(fed, spoken))
    if limits is not None:
        lines += ["", *table(heads("", "old", "new"), limit_rows(limits, spoken))]
        lines += warn(spoken, [limits.failure] if limits.failure else [])
    return lines
