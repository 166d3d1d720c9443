"""A call that does not fit the commands, in the language that is spoken."""

from __future__ import annotations

from typing import Any

import typer

from mtcommission.base.messages.message import Message

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
