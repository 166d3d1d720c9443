"""The language that the terminal speaks, in which ``--help`` and usage errors come, too.

English help stands where a command is declared; each other language says it in texts of its own, by
the name of the command and of the parameter: ``help-run``, ``help-run-no-pdf``, or ``help-no-pdf``
where several commands share it. Without another language no catalogue is loaded: that takes longer
than all the rest of ``--help``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextvars import ContextVar
from inspect import cleandoc
from itertools import pairwise
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import typer
from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption

from mtcommission.base.errors import InputError
from mtcommission.base.messages import ENGLISH, LANGUAGES
from mtcommission.base.messages.message import Message, Value

if TYPE_CHECKING:
    from mtcommission.base.messages.catalogue import Catalogue
    from mtcommission.machine.machine import Machine

LOCALE = ("LC_ALL", "LC_MESSAGES", "LANG")
"""Variables of the environment that name a language, the first that is set counts (POSIX)."""

_spoken = ContextVar("spoken", default=ENGLISH)
_rotary = ContextVar("rotary", default=False)
_follows = ContextVar("follows", default=False)


def choose(language: str) -> str:
    """Speak a language from now on, or go on with the one that is spoken where "" is asked for.

    Raises InputError: there is no such language.
    """
    if not language:
        return _spoken.get()
    if language not in LANGUAGES:
        message = Message("option-one-of", got=language, allowed=tuple(LANGUAGES))
        raise InputError.at("--language", message)
    _spoken.set(language)
    _rotary.set(False)
    _follows.set(False)
    return language


def find_language(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """Return the language asked for anywhere on the command line, else that of the environment.

    A language that there is not is refused where the option is read.

    Examples
    --------
    >>> find_language(["--language", "de", "run", "--help"], {})
    'de'
    >>> find_language(["--help"], {"LANG": "de_DE.UTF-8"}), find_language([], {"LANG": "C.UTF-8"})
    ('de', 'en')
    """
    asked = [text.removeprefix("--language=") for text in arguments if "--language=" in text]
    asked += [after for text, after in pairwise(arguments) if text == "--language"]
    locale = next((environment[key] for key in LOCALE if environment.get(key)), "")
    return next((one for one in (*asked, locale[:2]) if one in LANGUAGES), ENGLISH)


def spoken() -> str:
    """Return the language that is spoken."""
    return _spoken.get()


def has_text(kind: str) -> bool:
    """Return whether the language that is spoken has a text of a kind."""
    return words().has(kind)


SPOKEN = ""
"""Default of the option: the language that is spoken already."""


def speak_of(machine: Machine) -> None:
    """Speak of torques and angles from now on, if the axis turns; of no force, if it follows."""
    _rotary.set(machine.motion.value == "rotary")
    _follows.set(machine.drive.follows)


def words(*, rotary: bool | None = None) -> Catalogue:
    """Return the catalogue of the chosen language for a kind of axis: that of the machine read."""
    from mtcommission.base.messages.catalogue import Catalogue

    turns = _rotary.get() if rotary is None else rotary
    return Catalogue(_spoken.get(), rotary=turns, follows=_follows.get())


def say(kind: str, /, **values: Value) -> str:
    """Return a text of the command line itself."""
    return words().text(kind, **values)


# Help and usage errors


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
    is_shown = is_shown and item.show_default and item.default != ""
    return f"{text} {words['default']}{item.default}]" if is_shown else text


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


UsageError: type[Exception] = typer.BadParameter.__mro__[1]
"""All that a command line can be wrong about is derived from it."""


def describe_usage(error: Any) -> Message:
    """Return what is wrong with a call, and where its help stands."""
    command = error.ctx.command_path if error.ctx else "mtcommission"
    return Message("usage-see", wrong=_wrong(error), command=command)


def _wrong(error: Any) -> Message:
    match type(error).__name__:
        case "MissingParameter":
            item = error.param
            named = item.opts[0] if item.param_type_name == "option" else item.metavar
            return Message("usage-missing", what=named or item.name)
        case "NoSuchOption":
            near = tuple(error.possibilities or ())
            hint = Message("usage-there-are", names=near) if near else ""
            return Message("usage-no-option", got=error.option_name, hint=hint)
        case "BadOptionUsage":
            return Message("usage-value", option=error.option_name)
        case "BadParameter":
            return Message("usage-number", option=error.param.opts[0] if error.param else "")
    group = getattr(error.ctx.command, "commands", None) if error.ctx else None
    if group:
        return Message("usage-no-command", names=tuple(group))
    return Message("usage-too-many")
