"""The wizard's session: ask what is open, show what is settled, check, write."""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from pathlib import Path

from mtcommission.base.errors import INTERRUPTED, Fault, InputError, Refused
from mtcommission.base.files import write_text
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine
from mtcommission.machine.plausibility import check_plausibility
from mtcommission.machine.profile.lines import read_key, show_key
from mtcommission.machine.profile.read import parse_profile
from mtcommission.machine.readers import read_path
from mtcommission.wizard.answers import (
    FILES,
    MEASURED,
    MODAL,
    SERVO,
    Answers,
    is_rotary,
    note_accepted,
    note_stated,
    to_profile,
)
from mtcommission.wizard.console import BACK, HELP, QUIT, Console, explain, means
from mtcommission.wizard.document import update_document, write_document
from mtcommission.wizard.insight import find_insights
from mtcommission.wizard.question import Question, Reply, read_reply, title
from mtcommission.wizard.script import (
    find_question,
    list_defaults,
    list_questions,
    list_settled,
)
from mtcommission.wizard.source import KEPT, Source, gather, keep, measure


class Ending(Enum):
    """How a session ended."""

    WRITTEN = "written"
    TO_RUN = "written; the user asks for the computation"
    QUIT = "left by the user; answers kept"


class _Left(Exception):
    """The user left; carries how, and the key of the question."""

    def __init__(self, how: Message, where: str) -> None:
        super().__init__(how)
        self.how, self.where = how, where


USER_LEFT = Message("wizard-left-by-user")
INTERRUPTED_BY_USER = Message("wizard-interrupted")
INPUT_ENDED = Message("wizard-input-ended")

CHANGE = Question(key="wizard.change", is_optional=True)
"""Asked below what is settled: the number or key of what is to be changed."""

RUN = Question(key="wizard.run", choices=("yes", "no"), default="yes")


def run_wizard(
    output: Path,
    *,
    console: Console,
    answers_file: Path | None,
    take_defaults: bool,
    offers_run: bool,
    language: str = "en",
) -> Ending:
    """Ask for a machine and write its profile; one that exists is changed and keeps its comments.

    ``answers_file``: TOML with answers by the profile's own keys; ``take_defaults``: instead of
    asking; ``offers_run``: ask at the end if the limits shall be computed.

    Raises
    ------
    InputError
        If answers are missing or wrong where nobody can be asked, or input ends; the answers
        so far are kept beside the output.
    """
    talk = _Interview(console, language, output, gather(output, answers_file))
    try:
        if talk.answers.get(MEASURED):
            talk.take_measured()
        if take_defaults:
            talk.take_defaults()
            text = talk.compose()
            try:
                machine = parse_profile(text, where=str(output))
            except InputError as error:
                faults = map(talk.source.locate, error.faults)
                raise InputError(list(faults)) from error
        else:
            text, machine = talk.hold()
    except _Left as left:
        keep(output, talk.answers)
        message = Message("wizard-kept", how=left.how, where=left.where, file=f"{output}{KEPT}")
        if left.how == USER_LEFT:
            talk.tell(message, indent="")
            return Ending.QUIT
        ending = InputError([Fault(where="wizard", message=message)])
        if left.how == INTERRUPTED_BY_USER:
            ending.exit_code = INTERRUPTED
        raise ending from left
    write_text(str(output), text)
    Path(f"{output}{KEPT}").unlink(missing_ok=True)
    talk.summarise(machine)
    if not offers_run:
        return Ending.WRITTEN
    if not take_defaults and console.is_interactive and talk.offer_run():
        return Ending.TO_RUN
    talk.tell(Message("wizard-compute-with", file=str(output)), indent="")
    return Ending.WRITTEN


class _Interview:
    """The answers so far, and how they are asked for."""

    def __init__(self, console: Console, language: str, output: Path, source: Source) -> None:
        self.console, self.language, self.output, self.source = console, language, output, source
        self.answers: dict[str, str] = dict(source.answers)
        self.said: set[Message] = set()

    @property
    def words(self) -> Catalogue:
        return Catalogue(self.language, rotary=is_rotary(self.answers))

    def tell(self, message: Message, *, indent: str = "  ") -> None:
        self.console.tell(f"{indent}{self.words.say(message)}")

    def take_defaults(self) -> None:
        """Take defaults for all that is open; every fault at once."""
        faults = []
        place = 0
        while place < len(questions := list_questions(self.answers)):
            question, place = questions[place], place + 1
            typed = self.answers.get(question.key, "")
            try:
                self.put(question, read_reply(question, typed), is_stated=bool(typed))
            except Refused as error:
                key = show_key(read_path(question.key))
                faults.append(self.source.locate(Fault(where="", key=key, message=error.message)))
                self.answers[question.key] = ""
        if faults:
            raise InputError(faults)

    def put(self, question: Question, reply: Reply, *, is_stated: bool) -> None:
        """Keep a reply; a word that a profile means anyway need not stand in it."""
        text = reply.text
        if not is_stated and question.choices and text in (question.meant, SERVO):
            text = ""
        if not is_stated and text and question.key == "control.kind":
            self.answers = note_accepted(self.answers, question.key)
        self.answers.setdefault(question.key, "")
        self.answers[reply.key] = text

    def hold(self) -> tuple[str, Machine]:
        """Ask until the profile is valid."""
        begin = self.words.text("wizard-begin", file=str(self.output))
        self.console.tell(f"{begin}\n{self.words.text('wizard-commands')}")
        wanted: str | None = None  # a question that is asked again
        while True:
            questions = list_questions(self.answers)
            keys = [question.key for question in questions]
            open_ones = [key for key in keys if key not in self.answers]
            key = wanted or next(iter(open_ones), None)
            if key is not None:
                place = keys.index(key) if key in keys else len(keys)
                question = find_question(key, self.answers)
                wanted = self.ask(question, before=keys[place - 1] if place else None)
                continue
            wanted = self.ask_for_changes(before=keys[-1])
            if wanted:
                continue
            text = self.compose()
            try:
                return text, parse_profile(text, where=str(self.output))
            except InputError as error:
                if not self.console.is_interactive:
                    keep(self.output, self.answers)
                    raise
                faults = [not_possible(fault) for fault in error.faults]
                self.console.tell("\n".join(map(self.words.say, faults)))
                wanted = _asked_for(read_key(error.faults[0].key), self.answers)

    def ask(self, question: Question, *, before: str | None) -> str | None:
        """Ask one question; return the one that is asked next, None for the first open one."""
        self.console.tell("")
        if where := question.where(self.words):
            self.console.tell(where)
        while True:
            typed = self._typed(question)
            if means(typed, BACK, self.words):
                if before is None:
                    self.tell(Message("wizard-first-question"))
                return before or question.key
            if self.take(question, typed):
                return None

    def take(self, question: Question, typed: str) -> bool:
        """Read a reply, keep it, and say what follows from it; False: it must be asked again."""
        known = self.answers.get(question.key, "")
        if typed == "-" and question.is_optional:
            self.put(question, Reply(key=question.key, text=""), is_stated=True)
            self.answers = note_stated(self.answers, question.key)
            return True
        titles = [title(choice, self.words) for choice in question.choices]
        try:
            reply = read_reply(question, typed or known, titles=titles)
        except Refused as error:
            self.tell(error.message)
            return False
        if known and typed in ("", known):
            return True  # a value that was only confirmed stays as it is written in the file
        self.put(question, reply, is_stated=bool(typed))
        if typed:
            self.answers = note_stated(self.answers, reply.key)
        if typed and reply.taken_as:
            taken = question.as_shown(reply.taken_as, self.words)
            self.tell(Message("wizard-taken-as", what=taken))
        if question.key == MEASURED:
            return self._measure()
        self._tell_insights()
        return True

    def ask_for_changes(self, *, before: str) -> str | None:
        """Show what is settled; return the key of what is to be changed, None: nothing."""
        settled, words = list_settled(self.answers), self.words
        defaults = list_defaults(self.answers)
        self.console.tell("")
        self.console.tell(words.text("wizard-settled"))
        for number, question in enumerate(settled, start=1):
            stated = self.answers.get(question.key, "")
            mark = words.text("wizard-assumed-mark") if question.key in defaults else ""
            name = replace(question, is_optional=False).say(words)
            value = question.as_shown(stated or question.shown_default(words), words)
            self.console.tell(f"{number:>3}  {name}: {value}{mark}")
        while True:
            typed = self._typed(CHANGE)
            if not typed or means(typed, BACK, self.words):
                return before if typed else None
            numbers = {str(n): question.key for n, question in enumerate(settled, start=1)}
            key = numbers.get(typed) or read_key(typed)
            if _exists(key, self.answers):
                return key
            self.tell(Message("wizard-no-such-key", got=typed))

    def _typed(self, question: Question) -> str:
        """What was typed, help apart."""
        default = self.answers.get(question.key, "") or question.default
        while True:
            try:
                typed = self.console.ask(question, default=default, words=self.words).strip()
            except EOFError as error:
                raise _Left(INPUT_ENDED, question.key) from error
            except KeyboardInterrupt as error:
                raise _Left(INTERRUPTED_BY_USER, question.key) from error
            if means(typed, QUIT, self.words):
                raise _Left(USER_LEFT, question.key)
            if not means(typed, HELP, self.words):
                return typed
            self.console.tell(explain(question, self.words))

    def _tell_insights(self) -> None:
        for insight in find_insights(self.answers, list_defaults(self.answers)):
            if insight not in self.said:
                self.said.add(insight)
                self.tell(Message("wizard-follows", what=insight))

    def take_measured(self) -> None:
        """Identify the axis from the files that were named."""
        from mtcommission.sheet.identified import doubts_and_notes  # its libraries load slowly

        axis = measure(
            self.answers,
            before=self.source.text,
            output=self.output,
            words=lambda rotary: Catalogue(self.language, rotary=rotary),
        )
        found = gather(self.output, None, identified=axis.profile)
        replaced = (MEASURED, "plant.", "pair.")
        kept = {key: text for key, text in self.answers.items() if not key.startswith(replaced)}
        motion = "rotary" if axis.part.rotary else "linear"
        self.source = replace(found, where=self.source.where, lines=self.source.lines)
        self.answers = {**found.answers, **kept, "machine.motion": motion}
        if self.answers.get("wizard.way") == FILES:
            self.answers["wizard.way"] = MODAL
        self.tell(Message("wizard-identified", count=len(axis.part.modes)))
        for doubt in doubts_and_notes(axis.part)[0]:
            self.tell(Message("warning", warning=doubt))

    def _measure(self) -> bool:
        """Identify the files that were just named; where that fails, they are asked for again."""
        try:
            self.take_measured()
        except InputError as error:
            self.answers.pop(MEASURED, None)
            if not self.console.is_interactive:
                keep(self.output, self.answers)
                raise
            self.console.tell(error.text(self.words))
            self.tell(Message("wizard-not-identified", file=str(self.output)))
            return False
        write_text(str(self.output), self.source.text)  # who leaves now keeps it with its intervals
        return True

    def compose(self) -> str:
        defaults = list_defaults(self.answers)
        data = to_profile(self.answers, defaults)
        if not self.source.text:
            return write_document(data, self.answers, defaults, self.words)
        return update_document(self.source.text, data)

    def summarise(self, machine: Machine) -> None:
        written = {"file": str(self.output), "name": machine.name, "letter": machine.axis}
        self.tell(Message("wizard-written", **written), indent="")
        self.said.clear()
        self._tell_insights()
        if machine.assumed:
            named = (self.words.name(key) for key in machine.assumed)
            self.tell(Message("wizard-assumed", keys=", ".join(dict.fromkeys(named))))
        for remark in check_plausibility(machine):
            self.tell(Message("warning", warning=remark))

    def offer_run(self) -> bool:
        titles = [title(choice, self.words) for choice in RUN.choices]
        while True:
            try:
                typed = self._typed(RUN)
                if means(typed, BACK, self.words):
                    return False
                return read_reply(RUN, typed, titles=titles).text == RUN.default
            except _Left:
                return False  # the profile is written, nothing is lost
            except Refused as error:
                self.tell(error.message)


def not_possible(fault: Fault) -> Message:
    """Return a fault without file and line: the profile is not written yet."""
    return Message("wizard-not-possible", key=fault.key, message=fault.message)


def _asked_for(key: str, answers: Answers) -> str:
    """The question that a fault belongs to; derived keys belong to where they come from."""
    keys = [question.key for question in list_questions(answers)]
    if key in keys or not key.startswith(("plant", "moves")):
        return key if key in keys or _exists(key, answers) else keys[0]
    for start in (
        key,
        key.rpartition(".")[0],
        "wizard.way" if key.startswith("plant") else "moves",
    ):
        for asked in keys:
            if start and asked.startswith(start):
                return asked
    return keys[0]


def _exists(key: str, answers: Answers) -> bool:
    try:
        find_question(key, answers)
    except KeyError:
        return False
    return True
