"""``--help`` and usage errors in the language that is spoken.

English stands where a command is declared; each other language says it in texts of its own, by the
name of the command and of the parameter: ``help-run``, ``help-run-no-pdf``, or ``help-no-pdf``
where several commands share it. Without another language no catalogue is loaded: that takes longer
than all the rest of ``--help``.
"""

from __future__ import annotations

from collections.abc import Iterator
from inspect import cleandoc
from pathlib import Path
from textwrap import wrap
from typing import Any

from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption

from mtcommission.base.messages.languages import ENGLISH
from mtcommission.cli.language import has_text, say, spoken

WIDTH, LONGEST_NAME = 79, 30
"""Columns of a help, and of the names before their explanations."""

FRAME = {
    "usage": "Usage",
    "options": "Options",
    "options-placeholder": "[OPTIONS]",
    "arguments": "Arguments",
    "commands": "Commands",
    "commands-placeholder": "COMMAND ...",
    "required": "[required]",
    "default": "[default: ",
    "help": "Show this and exit.",
}
"""Words around the explanations."""


def explain(key: str, english: str) -> str:
    """Return a text of a help in the language that is spoken."""
    return english if spoken() == ENGLISH else say(f"help-{key}")


def keys_of(command: str, parameter: str) -> tuple[str, str]:
    """Return the names of the text about a parameter: of this command, or of all that have it."""
    name = parameter.replace("_", "-").strip("-")
    return f"{command}-{name}", name


class SpokenCommand(TyperCommand):
    """A command that explains itself in the language that is spoken."""

    def get_help(self, ctx: Any) -> str:
        """Return the whole help."""
        return "\n".join(_lines(self, ctx))


class SpokenGroup(TyperGroup):
    """Commands that explain themselves likewise."""

    def get_help(self, ctx: Any) -> str:
        """Return the whole help."""
        return "\n".join(_lines(self, ctx))


def _lines(command: TyperCommand | TyperGroup, ctx: Any) -> Iterator[str]:
    key = "-".join(ctx.command_path.split()[1:])
    arguments = [item for item in command.params if isinstance(item, TyperArgument)]
    options = [item for item in command.params if isinstance(item, TyperOption)]
    inner = command.commands if isinstance(command, TyperGroup) else {}
    words = {name: explain(name, english) for name, english in FRAME.items()}
    tail = [words["options-placeholder"], *(_name(item) for item in arguments)]
    tail += [words["commands-placeholder"]] if inner else []
    yield f"{words['usage']}: {ctx.command_path} {' '.join(tail)}"
    for place, paragraph in enumerate(cleandoc(command.help or "").split("\n\n")):
        yield ""
        name = f"{key or 'program'}{'-more' if place else ''}"
        yield from _wrapped(explain(name, " ".join(paragraph.split())), indent=2)
    rows = [(_name(item), _explain_parameter(key, item, words)) for item in arguments]
    yield from _section(words["arguments"], rows)
    rows = [(_name(item), _explain_parameter(key, item, words)) for item in options]
    yield from _section(words["options"], [*rows, ("--help", words["help"])])
    own = [(name, _first_sentence(key, name, item)) for name, item in inner.items()]
    yield from _section(words["commands"], own)
    if command.epilog:
        yield ""
        yield from _wrapped(explain("exit-codes", command.epilog), indent=2)


def _name(item: Any) -> str:
    """How a parameter is written, e.g. ``--f-max F``."""
    shown = item.metavar or (item.name or "").upper()
    if isinstance(item, TyperArgument):
        return shown if item.required else f"[{shown}]"
    names = ", ".join(item.opts)
    return names if _is_flag(item) else f"{names} {shown}"


def _is_flag(item: Any) -> bool:
    return isinstance(item, TyperOption) and item.is_flag


def _explain_parameter(command: str, item: Any, words: dict[str, str]) -> str:
    text = item.help or ""
    if spoken() != ENGLISH:
        own, shared = (f"help-{key}" for key in keys_of(command, item.name or ""))
        text = say(own if has_text(own) else shared)
    if item.required:
        return f"{text} {words['required']}"
    is_shown = isinstance(item.default, str | int | Path) and not _is_flag(item)
    return f"{text} {words['default']}{item.default}]" if is_shown and item.default != "" else text


def _first_sentence(group: str, name: str, command: Any) -> str:
    english = " ".join(cleandoc(command.help or "").split("\n\n")[0].split())
    return explain(f"{group}-{name}" if group else name, english)


def _section(title: str, rows: list[tuple[str, str]]) -> Iterator[str]:
    if not rows:
        return
    yield ""
    yield f"{title}:"
    width = min(max(len(name) for name, _ in rows), LONGEST_NAME)
    for name, text in rows:
        first, *more = wrap(text, WIDTH - width - 4, break_on_hyphens=False) or [""]
        if len(name) > width:
            yield f"  {name}"
            name = ""
        yield f"  {name:<{width}}  {first}".rstrip()
        yield from (" " * (width + 4) + line for line in more)


def _wrapped(text: str, *, indent: int) -> list[str]:
    margin = " " * indent
    return wrap(text, WIDTH, initial_indent=margin, subsequent_indent=margin)
