"""Where questions are shown and replies come from: a real console, a plain terminal, or a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from mtcommission.messages.catalogue import Catalogue
from mtcommission.units.quantities import wrap_whole
from mtcommission.wizard.question import Question, title

if TYPE_CHECKING:
    from prompt_toolkit.application import Application

WIDTH = 78
BACK, HELP, QUIT = ("<", "back"), ("?", "help"), ("q", "quit")


class Console(Protocol):
    """What the interview needs of a console."""

    @property
    def is_interactive(self) -> bool:
        """Whether somebody sits in front of it."""

    def ask(self, question: Question, *, default: str, words: Catalogue) -> str:
        """Return what was typed; raise EOFError or KeyboardInterrupt if the user leaves."""

    def tell(self, text: str) -> None:
        """Show a paragraph."""


class LineConsole:
    """Prompts and replies line by line: works in a pipe and in any terminal.

    ``read`` returns a line with its end, "" at the end of input; ``write`` shows a text;
    ``is_interactive``: whether somebody sits in front of it.
    """

    def __init__(
        self, *, read: Callable[[], str], write: Callable[[str], object], is_interactive: bool
    ) -> None:
        self._read, self._write, self._interactive = read, write, is_interactive

    @property
    def is_interactive(self) -> bool:
        """Whether somebody sits in front of it."""
        return self._interactive

    def ask(self, question: Question, *, default: str, words: Catalogue) -> str:
        """Return the next line of input."""
        for number, choice in enumerate(question.choices, start=1):
            self._write(f"    {number}  {title(choice, words)}\n")
        self._write(f"{question.say(words)}{hint(question, default, words)}: ")
        line = self._read()
        if not line:
            raise EOFError
        if not self._interactive:
            self._write(line if line.endswith("\n") else f"{line}\n")
        return line.rstrip("\r\n")

    def tell(self, text: str) -> None:
        """Show a paragraph."""
        self._write(fold(text) + "\n")


class RichConsole:
    """Prompts with line editing and choices by arrow keys.

    ``fallback`` is used once questionary finds no console that it can drive.
    """

    def __init__(self, fallback: LineConsole) -> None:
        self._fallback = fallback
        self._is_driven = True

    @property
    def is_interactive(self) -> bool:
        """Whether somebody sits in front of it: always."""
        return True

    def ask(self, question: Question, *, default: str, words: Catalogue) -> str:
        """Return what was typed or chosen."""
        if self._is_driven:
            try:
                return self._ask(question, default, words)
            except (EOFError, KeyboardInterrupt):
                raise
            except Exception:
                # prompt_toolkit's "no console" error is a class that exists on Windows only.
                self._is_driven = False
        return self._fallback.ask(question, default=default, words=words)

    def tell(self, text: str) -> None:
        """Show a paragraph."""
        self._fallback.tell(text)

    def _ask(self, question: Question, default: str, words: Catalogue) -> str:
        import questionary

        if not question.choices:
            prompt = f"{question.say(words)}{hint(question, default, words)}:"
            return str(questionary.text(prompt).unsafe_ask())
        choices = [
            questionary.Choice(title=title(choice, words), value=choice)
            for choice in question.choices
        ]
        commands = [
            questionary.Choice(title=f"{sign}  {words.text(f'wizard-{name}')}", value=sign)
            for sign, name in (BACK, HELP, QUIT)
        ]
        asked = questionary.select(
            question.say(words),
            choices=[*choices, *commands],
            default=default if default in question.choices else None,
        )
        _take_signs(asked.application)
        return str(asked.unsafe_ask())


def means(typed: str, command: tuple[str, str], words: Catalogue) -> bool:
    """Return whether a command was typed: its sign, or its name in English or the language."""
    return typed.lower() in (*command, words.text(f"wizard-{command[1]}").lower())


def _take_signs(application: Application[Any]) -> None:
    """< ? q and the end of input act in a list, too: on its own it takes no letters."""
    from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent, merge_key_bindings

    own = KeyBindings()

    @own.add("c-d")
    def _(event: KeyPressEvent) -> None:
        event.app.exit(exception=EOFError())

    for sign, _name in (BACK, HELP, QUIT):

        @own.add(sign)
        def _(event: KeyPressEvent, sign: str = sign) -> None:
            event.app.exit(result=sign)

    present = application.key_bindings
    application.key_bindings = merge_key_bindings([present, own]) if present else own


def open_console() -> Console:
    """Return the console of this process: questionary on a terminal, plain lines elsewhere."""
    is_terminal = sys.stdin.isatty() and sys.stdout.isatty()

    def write(text: str) -> None:
        sys.stdout.write(text)
        sys.stdout.flush()

    plain = LineConsole(read=sys.stdin.readline, write=write, is_interactive=is_terminal)
    return RichConsole(plain) if is_terminal else plain


def hint(question: Question, default: str, words: Catalogue) -> str:
    """Return the default, or an example, in brackets."""
    if default in question.choices:
        return f" [{title(default, words)}]"
    if default:
        return f" [{question.as_shown(default, words)}]"
    example = words.text("wizard-example-behind", example=question.shown_example(words))
    return f" ({example})" if question.example else ""


def explain(question: Question, words: Catalogue) -> str:
    """Return all that is known about a question, for ``?``."""
    allowed = question.allowed
    lines = [
        question.where(words),
        words.text("wizard-expected", what=allowed.dimension.described) if allowed else "",
        words.text("wizard-example", example=question.shown_example(words))
        if question.example
        else "",
        words.text("wizard-leave-out") if question.is_optional else "",
    ]
    return " ".join(line for line in lines if line)


def fold(text: str) -> str:
    """Return a text in lines for 80 columns, no number without its unit; its own breaks stay."""
    return "\n".join("\n".join(wrap_whole(line, WIDTH, indent="  ")) for line in text.splitlines())
