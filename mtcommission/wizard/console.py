"""Where questions are shown and replies come from: a terminal, or a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.units.quantities import wrap_whole
from mtcommission.wizard.question import Question, title

WIDTH = 78
BACK, HELP, QUIT = ("<", "back"), ("?", "help"), ("q", "quit")


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
        reply = self._read(f"{question.say(words)}{hint(question, default, words)}: ")
        if not self.is_interactive:
            self._write(f"{reply}\n")
        return reply

    def tell(self, text: str) -> None:
        """Show a paragraph."""
        self._write(fold(text) + "\n")


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
