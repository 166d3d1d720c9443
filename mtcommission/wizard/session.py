"""The wizard's session: ask, keep, convert, check, write."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

from mtcommission.errors import Fault, InputError
from mtcommission.files import write_text
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.profile.faults import may_be_left_out
from mtcommission.profile.lines import read_key, read_path, show_key
from mtcommission.profile.read import parse_profile
from mtcommission.wizard.axis_units import NO, YES
from mtcommission.wizard.console import (
    BACK,
    COMMANDS,
    HELP,
    QUIT,
    Console,
    explain,
    introduce,
)
from mtcommission.wizard.convert import list_unmeasured, to_profile
from mtcommission.wizard.document import update_document, write_document
from mtcommission.wizard.gather import KEPT, Source, gather, keep
from mtcommission.wizard.insight import find_insights
from mtcommission.wizard.question import (
    Answers,
    Question,
    note_accepted,
    note_stated,
    read_reply,
)
from mtcommission.wizard.script import list_questions


class Ending(Enum):
    """How a session ended."""

    WRITTEN = "written"
    QUIT = "left by the user; answers kept"


@dataclass(frozen=True, slots=True, kw_only=True)
class Session:
    """What a session left behind.

    Parameters
    ----------
    ending
        Whether there is a profile.
    wants_run
        Whether the user asked for the computation.
    """

    ending: Ending
    wants_run: bool


class _Left(Exception):
    """The user left; carries the answers and how."""

    def __init__(self, answers: Answers, how: str, where: str) -> None:
        super().__init__(how)
        self.answers, self.how, self.where = answers, how, where


def run_wizard(
    output: Path,
    *,
    console: Console,
    answers_file: Path | None,
    take_defaults: bool,
    offers_run: bool,
) -> Session:
    """Ask for a machine and write its profile.

    Parameters
    ----------
    output
        Profile to write; one that exists is changed and keeps its comments.
    console
        Where to ask.
    answers_file
        TOML with answers by the profile's own keys.
    take_defaults
        Whether to take defaults instead of asking.
    offers_run
        Whether to ask at the end if the limits shall be computed.

    Returns
    -------
    Session

    Raises
    ------
    InputError
        If answers are missing or wrong where nobody can be asked, or input ends; the answers
        so far are kept beside the output.
    """
    source = gather(output, answers_file)
    if take_defaults:
        answers = _fill(source)
        text = _compose(source, answers)
        try:
            machine = parse_profile(text, where=str(output))
        except InputError as error:
            raise InputError([source.locate(fault) for fault in error.faults]) from error
    else:
        try:
            answers, text, machine = _interview(source, console, output)
        except _Left as left:
            keep(output, left.answers, place=left.where)
            message = (
                f"{left.how} at {left.where}; answers kept in {output}{KEPT}, the same command "
                "goes on from there"
            )
            if left.how == Ending.QUIT.name.lower():
                console.tell(message)
                return Session(ending=Ending.QUIT, wants_run=False)
            raise InputError(
                [Fault(where="wizard", message=Message("verbatim", text=message))]
            ) from left
    write_text(str(output), text)
    Path(f"{output}{KEPT}").unlink(missing_ok=True)
    _summarise(console, answers, machine, output)
    may_ask = offers_run and not take_defaults and console.is_interactive
    wants_run = may_ask and _offer_run(console)
    if offers_run and not wants_run:
        console.tell(f"Compute the limits with: mtcommission run {output}")
    return Session(ending=Ending.WRITTEN, wants_run=wants_run)


def _fill(source: Source) -> dict[str, str]:
    """Take defaults for all that is open; every fault at once."""
    filled, faults = dict(source.answers), []
    place = 0
    while place < len(questions := list_questions(filled)):
        question = questions[place]
        typed, text = filled.get(question.key, ""), ""
        try:
            text = read_reply(question, typed).text
        except ValueError as error:
            fault = Fault(
                where="", key=_shown(question.key), message=Message("verbatim", text=str(error))
            )
            faults.append(source.locate(fault))
        filled[question.key] = text
        if text and not typed and question.dimension is not None:
            filled = note_accepted(filled, question.key)
        place += 1
    if faults:
        raise InputError(faults)
    return filled


def _shown(key: str) -> str:
    """A dotted key as messages spell it."""
    return show_key(read_path(key))


def _interview(
    source: Source, console: Console, output: Path
) -> tuple[dict[str, str], str, Machine]:
    """Ask until the profile is valid."""
    answers = dict(source.answers)
    console.tell(
        f"Profile {output}. Enter takes the value in [brackets].\nAt every question: {COMMANDS}."
    )
    place = _first_place(source)
    if source.is_resumed and place:
        console.tell("Going on with the answers that are known; < goes back to them.")
    while True:
        answers = _ask_from(place, answers, console)
        text = _compose(source, answers)
        try:
            return answers, text, parse_profile(text, where=str(output))
        except InputError as error:
            if not console.is_interactive:
                keep(output, answers, place="")
                raise
            console.tell("\n".join(fault_line(fault) for fault in error.faults))
            place = _place_of(read_key(error.faults[0].key), answers)


def fault_line(fault: Fault) -> str:
    """Return a fault without file and line: the profile is not written yet."""
    return f"Not possible: {replace(fault, where='', line=0)}"


def _ask_from(place: int, answers: dict[str, str], console: Console) -> dict[str, str]:
    """Ask every question from a place on; back, help and quit move about."""
    known, shown = dict(answers), -1
    while place < len(questions := list_questions(known)):
        question = questions[place]
        try:
            typed = _ask(question, known, console, is_new=place != shown)
            shown = place
            if typed.lower() in QUIT:
                raise _Left(known, Ending.QUIT.name.lower(), question.key)
            if typed.lower() in BACK and place:
                place -= 1
            elif typed.lower() in BACK:
                console.tell("  This is the first question.")
            elif typed.lower() in HELP:
                console.tell(explain(question))
            else:
                known, is_taken = _take(question, typed, known, console)
                place += is_taken
        except EOFError as error:
            raise _Left(known, "input ended", question.key) from error
        except KeyboardInterrupt as error:
            raise _Left(known, "interrupted", question.key) from error
    return known


def _ask(question: Question, known: Answers, console: Console, *, is_new: bool) -> str:
    """Show a question, with where to look above it the first time, and return what was typed."""
    if is_new:
        console.tell("")
        console.tell(introduce(question))
    return console.ask(question, default=known.get(question.key, "") or question.default).strip()


def _take(
    question: Question, typed: str, known: dict[str, str], console: Console
) -> tuple[dict[str, str], bool]:
    """Read a reply, keep it, and say what follows from it."""
    before = known.get(question.key, "")
    if typed == "-" and question.is_optional:
        return note_stated({**known, question.key: ""}, question.key), True
    try:
        reply = read_reply(question, typed or before)
    except ValueError as error:
        console.tell(f"  {error}")
        return known, False
    # A value that was only confirmed stays as it is written in the file.
    text = before if before and typed in ("", before) else reply.text
    found = {**known, question.key: text}
    if typed:
        found = note_stated(found, question.key)
    elif not before and text and question.dimension is not None:
        found = note_accepted(found, question.key)
    if reply.warning:
        console.tell(f"  Warning: {reply.warning}")
    elif typed and reply.taken_as:
        console.tell(f"  taken as {reply.taken_as}")
    said = set(find_insights(known))
    for insight in find_insights(found):
        if insight not in said:
            console.tell(f"  {'Warning: ' if insight.is_warning else '= '}{insight.text}")
    return found, True


def _first_place(source: Source) -> int:
    """Where the user left, or the first open question; the first of all in a new session."""
    if not source.is_resumed:
        return 0
    keys = [question.key for question in list_questions(source.answers)]
    if source.place in keys:
        return keys.index(source.place)
    return next((i for i, key in enumerate(keys) if key not in source.answers), len(keys))


def _place_of(key: str, answers: Answers) -> int:
    """The question that a fault belongs to; derived keys belong to where they come from."""
    keys = [question.key for question in list_questions(answers)]
    if key in keys:
        return keys.index(key)
    for start in (key, key.rpartition(".")[0], "wizard.way" if key.startswith("plant") else key):
        for place, asked in enumerate(keys):
            if start and asked.startswith(start):
                return place
    return 0


def _compose(source: Source, answers: Answers) -> str:
    if not source.text:
        return write_document(to_profile(answers), answers)
    # What the user never wrote and only confirmed need not appear in his file.
    defaults = {question.key: question.default for question in list_questions(answers)}
    kept = {
        key: text
        for key, text in answers.items()
        if key in source.in_profile
        or text != defaults.get(key)
        or not may_be_left_out(key.split("."))
    }
    return update_document(source.text, to_profile(kept))


def _summarise(console: Console, answers: Answers, machine: Machine, output: Path) -> None:
    console.tell(f"Written: {output}: {machine.name}, axis {machine.axis}")
    for insight in find_insights(answers):
        console.tell(f"  {'Warning: ' if insight.is_warning else '= '}{insight.text}")
    unmeasured = list_unmeasured(answers)
    if unmeasured:
        console.tell(f"  Default accepted, not measured: {', '.join(unmeasured)}")
    catalogue = Catalogue("en", rotary=machine.motion is Motion.ROTARY)
    for remark in check_plausibility(machine):
        console.tell(f"  Warning: {catalogue.say(remark.with_key())}")


def _offer_run(console: Console) -> bool:
    question = Question(
        key="wizard.run",
        text="Compute the limits now",
        where="The same as mtcommission run with this profile; some seconds to a minute.",
        choices=(YES, NO),
        default=YES,
    )
    while True:
        try:
            typed = console.ask(question, default=YES).strip().lower()
        except (EOFError, KeyboardInterrupt):
            return False  # the profile is written, nothing is lost
        if typed in (*QUIT, *BACK):
            return False
        if typed in HELP:
            console.tell(explain(question))
            continue
        try:
            return read_reply(question, typed).text == YES
        except ValueError as error:
            console.tell(f"  {error}")
