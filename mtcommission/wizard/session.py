"""The wizard's session: ask what is open, show what is settled, check, write."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from enum import Enum
from pathlib import Path

from mtcommission.base.errors import INTERRUPTED, Fault, InputError, Refused
from mtcommission.base.files import write_text
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import wrap_whole
from mtcommission.machine.checks import check_plausibility
from mtcommission.machine.machine import Machine
from mtcommission.machine.mechanics import PLANTS, Mechanics
from mtcommission.machine.profile.read import parse_profile, read_key
from mtcommission.machine.readers import Reading, read_path, show_key
from mtcommission.wizard.answers import (
    MODAL,
    SERVO,
    Answers,
    axis_units,
    follows,
    is_rotary,
    note_accepted,
    note_stated,
    si_value,
    to_profile,
)
from mtcommission.wizard.files import (
    KEPT,
    Source,
    gather,
    keep,
    update_document,
    write_document,
)
from mtcommission.wizard.question import Question, Reply, read_reply, title
from mtcommission.wizard.script import (
    find_question,
    list_defaults,
    list_questions,
    list_settled,
    motor_turn,
)

WIDTH = 78

BACK, HELP, QUIT = ("<", "back"), ("?", "help"), ("q", "quit")

USER_LEFT = Message("wizard-left-by-user")
INTERRUPTED_BY_USER = Message("wizard-interrupted")
INPUT_ENDED = Message("wizard-input-ended")

CHANGE = Question(key="wizard.change", is_optional=True)
"""Asked below what is settled: the number or key of what is to be changed."""

RUN = Question(key="wizard.run", choices=("yes", "no"), default="yes")


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


class Console:
    """Prompts and replies line by line.

    ``read`` shows a prompt and returns the reply, or raises EOFError or KeyboardInterrupt if the
    user leaves; ``write`` shows a text; ``is_interactive``: whether somebody sits in front of it.
    """

    def __init__(
        self, *, read: Callable[[str], str], write: Callable[[str], object], is_interactive: bool
    ) -> None:
        self._read, self._write, self.is_interactive = read, write, is_interactive

    def ask(self, question: Question, *, default: str, words: Catalogue) -> str:
        """Return the reply to a question; choices are shown with their numbers."""
        for number, choice in enumerate(question.choices, start=1):
            self._write(f"    {number}  {title(choice, words)}\n")
        reply = self._read(f"{question.say(words)}{question.hint(default, words)}: ")
        if not self.is_interactive:
            self._write(f"{reply}\n")
        return reply

    def tell(self, text: str) -> None:
        """Show paragraphs in lines for 80 columns, no number without its unit."""
        for line in text.splitlines() or [""]:
            self._write("\n".join(wrap_whole(line, WIDTH, indent="  ")) + "\n")


def open_console() -> Console:
    """Return the console of this process."""
    is_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    if is_terminal:
        _edit_lines()

    def write(text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()

    return Console(read=input, write=write, is_interactive=is_terminal)


def _edit_lines() -> None:
    """Let arrow keys move in a reply where Python has that; a reply is no line of its history."""
    try:
        import readline
    except ImportError:  # Windows, whose console edits lines itself
        return
    readline.set_auto_history(False)


def means(typed: str, command: tuple[str, str], words: Catalogue) -> bool:
    """Return whether a command was typed: its sign, or its name in English or the language."""
    return typed.lower() in (*command, words.text(f"wizard-{command[1]}").lower())


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
    source = gather(output, answers_file)
    talk = _Interview(console, language, output, source)
    if source.replaced:
        talk.tell(Message("wizard-replaced", file=source.where, values=source.replaced), indent="")
    try:
        text, machine = talk.take_defaults() if take_defaults else talk.hold()
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
    talk.tell(Message("cli-next-run", profile=str(output)), indent="")
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

    # Without asking

    def take_defaults(self) -> tuple[str, Machine]:
        """Take defaults for all that is open; every fault at once, located in the answers."""
        faults = []
        place = 0
        while place < len(questions := list_questions(self.answers)):
            question, place = questions[place], place + 1
            typed = self.answers.get(question.key, "")
            try:
                reply = read_reply(question, typed, self.words)
                self.put(question, reply, is_stated=bool(typed))
            except Refused as error:
                key = show_key(read_path(question.key))
                faults.append(self.source.locate(Fault(where="", key=key, message=error.message)))
                self.answers[question.key] = ""
        if faults:
            raise InputError(faults)
        text = self.compose()
        try:
            return text, parse_profile(text, where=str(self.output))
        except InputError as error:
            raise InputError(list(map(self.source.locate, error.faults))) from error

    def put(self, question: Question, reply: Reply, *, is_stated: bool) -> None:
        """Keep a reply; a word that a profile means anyway need not stand in it."""
        text = reply.text
        if not is_stated and question.choices and text in (question.meant, SERVO):
            text = ""
        if not is_stated and text and question.key == "control.kind":
            self.answers = note_accepted(self.answers, question.key)
        self.answers.setdefault(question.key, "")
        self.answers[reply.key] = text

    # Asking

    def hold(self) -> tuple[str, Machine]:
        """Ask until the profile is valid."""
        begin = self.words.text("wizard-begin", file=str(self.output))
        self.console.tell(f"{begin}\n{self.words.text('wizard-commands')}")
        wanted: str | None = None  # a question that is asked again
        while True:
            keys = [question.key for question in list_questions(self.answers)]
            key = wanted or next((key for key in keys if key not in self.answers), None)
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
                # Without file and line: the profile is not written yet.
                for fault in error.faults:
                    said = Message("wizard-not-possible", key=fault.key, message=fault.message)
                    self.tell(said, indent="")
                wanted = _asked_for(read_key(error.faults[0].key), self.answers)

    def ask(self, question: Question, *, before: str | None) -> str | None:
        """Ask one question; return the one that is asked next, None for the first open one."""
        self.console.tell("")
        if where := question.where(self.words):
            self.console.tell(where)
        while True:
            typed = self._typed(question)
            if means(typed, BACK, self.words):
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
        try:
            reply = read_reply(question, typed or known, self.words)
        except Refused as error:
            self.tell(error.message)
            return False
        if known and typed in ("", known):
            return True  # a value that was only confirmed stays as it is written in the file
        self.put(question, reply, is_stated=bool(typed))
        if typed:
            self.answers = note_stated(self.answers, reply.key)
            if reply.taken_as:
                taken = question.as_shown(reply.taken_as, self.words)
                self.tell(Message("wizard-taken-as", what=taken))
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
            name = replace(question, is_optional=False).say(words)
            value = question.as_shown(stated or question.shown_default(words), words)
            value = words.text("assumed", value=value) if question.key in defaults else value
            self.console.tell(f"{number:>3}  {name}: {value}")
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
            self.console.tell(question.explain(self.words))

    def _tell_insights(self) -> None:
        for insight in find_insights(self.answers):
            if insight not in self.said:
                self.said.add(insight)
                self.tell(Message("wizard-follows", what=insight))

    # What becomes of it

    def compose(self) -> str:
        defaults = list_defaults(self.answers)
        if "machine.source" in defaults:
            defaults["machine.source"] = self.words.text("wizard-by-hand")
        data = to_profile(self.answers, defaults)
        if not self.source.text:
            return write_document(data, self.answers, defaults, self.words)
        return update_document(self.source.text, data)

    def summarise(self, machine: Machine) -> None:
        self.tell(Message("cli-written", files=str(self.output)), indent="")
        self.said.clear()
        self._tell_insights()
        if machine.assumed:
            named = (self.words.name(key) for key in machine.assumed)
            self.tell(Message("terminal-assumed", what=", ".join(dict.fromkeys(named))))
        for remark in check_plausibility(machine):
            self.tell(Message("warning", warning=remark))

    def offer_run(self) -> bool:
        while True:
            try:
                typed = self._typed(RUN)
                if means(typed, BACK, self.words):
                    return False
                return read_reply(RUN, typed, self.words).text == RUN.default
            except _Left:
                return False  # the profile is written, nothing is lost
            except Refused as error:
                self.tell(error.message)


def _asked_for(key: str, answers: Answers) -> str:
    """The question that a fault belongs to; derived keys belong to where they come from."""
    keys = [question.key for question in list_questions(answers)]
    if key in keys or not key.startswith(("plant", "moves")):
        return key if key in keys or _exists(key, answers) else keys[0]
    origin = "wizard.way" if key.startswith("plant") else "moves"
    for start in filter(None, (key, key.rpartition(".")[0], origin)):
        for asked in keys:
            if asked.startswith(start):
                return asked
    return keys[0]


def _exists(key: str, answers: Answers) -> bool:
    try:
        find_question(key, answers)
    except KeyError:
        return False
    return True


# What follows from the answers


def find_insights(answers: Answers) -> Iterator[Message]:
    """Yield what is known of the machine, in words, as soon as the mechanics can be read.

    Modes, deflections and accelerations.
    """
    mechanics, axis = _read_mechanics(answers), axis_units(answers)
    if mechanics is None:
        return
    if follows(answers):
        force, mass = si_value(answers, "drive.max_acceleration", axis.acceleration), 0.0
    else:
        force, mass = si_value(answers, "drive.max_force", axis.force), mechanics.moving_mass
        load = si_value(answers, "drive.static_load", axis.force)
        force = force and force - abs(load or 0.0)
    for mode in mechanics.modes:
        known = {"frequency": mode.frequency_hz, "damping_ratio": mode.damping_ratio}
        yield Message("insight-mode", mode=mode.name, **known)
        if force is not None and force > 0.0:
            deflection = abs(mode.tcp_gain) * force / mode.natural_frequency**2
            by = "held" if follows(answers) else "free"
            yield Message("insight-deflection", mode=mode.name, deflection=deflection, by=by)
    if force is not None and force <= 0.0:
        yield Message("insight-no-force", force=force)
    elif mass and force is not None:
        yield Message("insight-acceleration", acceleration=force / mass, force=force, mass=mass)
    turn = motor_turn(answers)
    if turn and answers.get("wizard.way") == MODAL:
        yield Message("insight-rotor-unknown", mass=mass, each=1e-4 * turn**2)


def _read_mechanics(answers: Answers) -> Mechanics | None:
    plant = to_profile(answers, list_defaults(answers)).get("plant")
    reading = Reading(axis=axis_units(answers), states={}, outputs={}, follows=follows(answers))
    found = PLANTS.read(plant, ("plant",), reading) if isinstance(plant, dict) else None
    return None if reading.faults else found
