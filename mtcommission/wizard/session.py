"""The wizard's session: ask, keep, convert, check, write."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from enum import Enum
from functools import cache
from pathlib import Path

from mtcommission.errors import INTERRUPTED, Fault, InputError, Refused
from mtcommission.files import write_text
from mtcommission.machine.machine import Machine
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.machine.readers import read_path
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.profile.describe import may_be_left_out
from mtcommission.profile.lines import read_key, show_key
from mtcommission.profile.read import parse_profile
from mtcommission.wizard.axis_units import MEASURED, NO, YES, is_rotary
from mtcommission.wizard.console import (
    BACK,
    HELP,
    QUIT,
    Console,
    explain,
    introduce,
)
from mtcommission.wizard.convert import to_profile
from mtcommission.wizard.document import update_document, write_document
from mtcommission.wizard.gather import KEPT, Source, gather, keep
from mtcommission.wizard.insight import Insight, find_insights
from mtcommission.wizard.measured import identify_files
from mtcommission.wizard.question import (
    Answers,
    Question,
    note_accepted,
    note_stated,
    read_reply,
    title,
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

    def __init__(self, answers: Answers, how: Message, where: str) -> None:
        super().__init__(how)
        self.answers, self.how, self.where = answers, how, where


USER_LEFT = Message("wizard-left-by-user")
INTERRUPTED_BY_USER = Message("wizard-interrupted")


@dataclass(frozen=True, slots=True)
class _Speaker:
    """A console that speaks a language, for the axis that the answers describe."""

    console: Console
    language: str

    def words(self, answers: Answers) -> Catalogue:
        return _catalogue(self.language, is_rotary(answers))

    def tell(self, answers: Answers, message: Message, *, indent: str = "  ") -> None:
        self.console.tell(f"{indent}{self.words(answers).say(message)}")


@cache
def _catalogue(language: str, is_rotary: bool) -> Catalogue:
    return Catalogue(language, rotary=is_rotary)


def run_wizard(
    output: Path,
    *,
    console: Console,
    answers_file: Path | None,
    take_defaults: bool,
    offers_run: bool,
    language: str = "en",
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
    language
        Of questions, messages and the comments of the profile.

    Raises
    ------
    InputError
        If answers are missing or wrong where nobody can be asked, or input ends; the answers
        so far are kept beside the output.
    """
    source, speaker = gather(output, answers_file), _Speaker(console, language)
    if source.measured:
        source = _take_measured(source, speaker, output, source.measured, answers_file)
    if take_defaults:
        answers = _fill(source)
        text = _compose(source, answers, speaker)
        try:
            machine = parse_profile(text, where=str(output))
        except InputError as error:
            raise InputError([source.locate(fault) for fault in error.faults]) from error
    else:
        try:
            answers, text, machine = _interview(source, speaker, output)
        except _Left as left:
            keep(output, left.answers, place=left.where)
            message = Message("wizard-kept", how=left.how, where=left.where, file=f"{output}{KEPT}")
            if left.how == USER_LEFT:
                speaker.tell(left.answers, message, indent="")
                return Session(ending=Ending.QUIT, wants_run=False)
            ending = InputError([Fault(where="wizard", message=message)])
            if left.how == INTERRUPTED_BY_USER:
                ending.exit_code = INTERRUPTED
            raise ending from left
    write_text(str(output), text)
    Path(f"{output}{KEPT}").unlink(missing_ok=True)
    _summarise(speaker, answers, machine, output)
    may_ask = offers_run and not take_defaults and console.is_interactive
    wants_run = may_ask and _offer_run(speaker, answers)
    if offers_run and not wants_run:
        speaker.tell(answers, Message("wizard-compute-with", file=str(output)), indent="")
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
        except Refused as error:
            fault = Fault(where="", key=_shown(question.key), message=error.message)
            faults.append(source.locate(fault))
        filled[question.key] = text
        if text and not typed and question.decides:
            filled = note_accepted(filled, question.key)
        place += 1
    if faults:
        raise InputError(faults)
    return filled


def _shown(key: str) -> str:
    """A dotted key as messages spell it."""
    return show_key(read_path(key))


def _interview(
    source: Source, speaker: _Speaker, output: Path
) -> tuple[dict[str, str], str, Machine]:
    """Ask until the profile is valid."""
    answers, console = dict(source.answers), speaker.console
    words = speaker.words(answers)
    begin, commands = words.text("wizard-begin", file=str(output)), words.text("wizard-commands")
    console.tell(f"{begin}\n{commands}")
    place = _first_place(source)
    if source.is_resumed and place:
        speaker.tell(answers, Message("wizard-going-on"), indent="")
    while True:
        answers = _ask_from(place, answers, speaker, passed=source.passed)
        files = answers.get(MEASURED, "")
        if files != source.answers.get(MEASURED, ""):
            if files:
                source, answers = _measure(source, answers, speaker, output)
            else:
                source = replace(source, answers=answers, passed=frozenset())
            place = _first_place(source)
            continue
        text = _compose(source, answers, speaker)
        try:
            return answers, text, parse_profile(text, where=str(output))
        except InputError as error:
            if not console.is_interactive:
                keep(output, answers, place="")
                raise
            faults = [not_possible(fault) for fault in error.faults]
            console.tell("\n".join(map(speaker.words(answers).say, faults)))
            place = _place_of(read_key(error.faults[0].key), answers)


def not_possible(fault: Fault) -> Message:
    """Return a fault without file and line: the profile is not written yet."""
    return Message("wizard-not-possible", key=fault.key, message=fault.message)


def _take_measured(
    source: Source, speaker: _Speaker, output: Path, typed: str, answers_file: Path | None
) -> Source:
    """Identify the axis from files; what is known afterwards."""
    measured = identify_files(
        typed,
        before=source.text,
        answers=source.answers,
        output=output,
        date=datetime.now(UTC).date().isoformat(),
        words=speaker.words,
    )
    write_text(measured.evidence_file, measured.evidence)
    found = gather(output, answers_file, identified=measured.text)
    known = {"machine.motion": measured.motion, **found.answers, MEASURED: typed}
    speaker.tell(known, measured.found)
    for doubt in measured.doubts:
        speaker.tell(known, Message("wizard-warning", what=doubt))
    passed = found.passed | {"machine.motion", MEASURED}
    return replace(found, answers=known, passed=passed)


def _measure(
    source: Source, answers: dict[str, str], speaker: _Speaker, output: Path
) -> tuple[Source, dict[str, str]]:
    """Identify the files that were just named; where that fails, they are asked for again."""
    before = replace(source, answers=answers)
    try:
        found = _take_measured(before, speaker, output, answers[MEASURED], None)
    except InputError as error:
        left = {key: text for key, text in answers.items() if key != MEASURED}
        if not speaker.console.is_interactive:
            keep(output, left, place=MEASURED)
            raise
        speaker.console.tell(error.text(speaker.words(answers)))
        speaker.tell(answers, Message("wizard-not-identified", file=str(output)))
        return source, left
    write_text(str(output), found.text)  # who leaves now keeps it with its intervals
    typed = {key: text for key, text in answers.items() if key not in found.passed}
    return found, {**found.answers, **typed}


def _ask_from(
    place: int, answers: dict[str, str], speaker: _Speaker, *, passed: frozenset[str]
) -> dict[str, str]:
    """Ask every question from a place on but those that are passed; return early with files.

    Back, help and quit move about.
    """
    known, shown, asks_passed = dict(answers), -1, False
    while place < len(questions := list_questions(known)):
        question = questions[place]
        if question.key in passed and not asks_passed:
            place += 1
            continue
        try:
            typed = _ask(question, known, speaker, is_new=place != shown)
            shown = place
            if typed.lower() in QUIT:
                raise _Left(known, USER_LEFT, question.key)
            if typed.lower() in BACK and place:
                place, asks_passed = place - 1, True
            elif typed.lower() in BACK:
                speaker.tell(known, Message("wizard-first-question"))
            elif typed.lower() in HELP:
                speaker.console.tell(explain(question, speaker.words(known)))
            else:
                files = known.get(MEASURED, "")
                known, is_taken = _take(question, typed, known, speaker)
                place, asks_passed = place + is_taken, asks_passed and not is_taken
                if known.get(MEASURED, "") != files:
                    return known
        except EOFError as error:
            raise _Left(known, Message("wizard-input-ended"), question.key) from error
        except KeyboardInterrupt as error:
            raise _Left(known, INTERRUPTED_BY_USER, question.key) from error
    return known


def _ask(question: Question, known: Answers, speaker: _Speaker, *, is_new: bool) -> str:
    """Show a question, with where to look above it the first time, and return what was typed."""
    words, console = speaker.words(known), speaker.console
    if is_new:
        console.tell("")
        console.tell(introduce(question, words))
    default = known.get(question.key, "") or question.default
    return console.ask(question, default=default, words=words).strip()


def _take(
    question: Question, typed: str, known: dict[str, str], speaker: _Speaker
) -> tuple[dict[str, str], bool]:
    """Read a reply, keep it, and say what follows from it."""
    before = known.get(question.key, "")
    if typed == "-" and question.is_optional:
        return note_stated({**known, question.key: ""}, question.key), True
    titles = [speaker.words(known).say(title(choice)) for choice in question.choices]
    try:
        reply = read_reply(question, typed or before, titles=titles)
    except Refused as error:
        speaker.tell(known, error.message)
        return known, False
    # A value that was only confirmed stays as it is written in the file.
    text = before if before and typed in ("", before) else reply.text
    found = {**known, question.key: text}
    if typed:
        found = note_stated(found, question.key)
    elif not before and text and question.decides:
        found = note_accepted(found, question.key)
    if reply.warning:
        speaker.tell(found, Message("wizard-warning", what=reply.warning))
    elif typed and reply.taken_as:
        speaker.tell(found, Message("wizard-taken-as", what=reply.taken_as))
    said = set(find_insights(known))
    for insight in find_insights(found):
        if insight not in said:
            _tell_insight(speaker, found, insight)
    return found, True


def _tell_insight(speaker: _Speaker, answers: Answers, insight: Insight) -> None:
    kind = "wizard-warning" if insight.is_warning else "wizard-follows"
    speaker.tell(answers, Message(kind, what=insight.text))


def _first_place(source: Source) -> int:
    """Where the user left, or the first open question; the first of all in a new session."""
    if not source.is_resumed:
        return 0  # what a measurement answered is passed
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


def _compose(source: Source, answers: Answers, speaker: _Speaker) -> str:
    if not source.text:
        return write_document(to_profile(answers), answers, speaker.words(answers))
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


def _summarise(speaker: _Speaker, answers: Answers, machine: Machine, output: Path) -> None:
    written = Message("wizard-written", file=str(output), name=machine.name, letter=machine.axis)
    speaker.tell(answers, written, indent="")
    for insight in find_insights(answers):
        _tell_insight(speaker, answers, insight)
    if machine.assumed:
        speaker.tell(answers, Message("wizard-assumed", keys=", ".join(machine.assumed)))
    for remark in check_plausibility(machine):
        speaker.tell(answers, Message("wizard-warning", what=remark.with_key()))


def _offer_run(speaker: _Speaker, answers: Answers) -> bool:
    question = Question(key="wizard.run", choices=(YES, NO), default=YES)
    words = speaker.words(answers)
    titles = [words.say(title(choice)) for choice in question.choices]
    while True:
        try:
            typed = speaker.console.ask(question, default=YES, words=words).strip().lower()
        except (EOFError, KeyboardInterrupt):
            return False  # the profile is written, nothing is lost
        if typed in (*QUIT, *BACK):
            return False
        if typed in HELP:
            speaker.console.tell(explain(question, words))
            continue
        try:
            return read_reply(question, typed, titles=titles).text == YES
        except Refused as error:
            speaker.tell(answers, error.message)
