"""Arguments and options of commands: how they are declared, those that several share, the machine.

They stand as defaults of a command's parameters, so who calls a command in Python gives them all.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from mtcommission.base.messages import LANGUAGES
from mtcommission.cli.language import SPOKEN, choose

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.machine.profile.read import ProfileSource


def option(names: str, value: str, meaning: str, default: Any = "", **more: Any) -> Any:
    """Return an option with a value; ``names`` with blanks between, ``...``: it must be given."""
    return typer.Option(default, *names.split(), metavar=value, help=meaning, **more)


def flag(name: str, meaning: str, **more: Any) -> Any:
    """Return an option that is set or not."""
    return typer.Option(False, name, help=meaning, **more)


def argument(value: str, meaning: str, default: Any = ...) -> Any:
    """Return an argument, required where it has no default."""
    return typer.Argument(default, metavar=value, help=meaning)


PROFILE = argument("PROFILE", "Machine profile (TOML).")
RECORD = argument("RECORD", "record.json of a run; export and verify take group.json, too.")
FOLDER = option("-o --output", "DIR", "Folder.", ...)
F_MAX = option("--f-max", "F", "Force limit for this call, e.g. 2kN.")
SIZES = option("--for", "every|listed", "Sizes of move that the limits serve.")
JSON = option("--json", "FILE", "Write the result as JSON; - for the screen.")
CSV = option("--csv", "FILE", "Write the motion as CSV; - for the screen.")
NO_PDF = flag("--no-pdf", "Leave the PDF out.")
APPENDIX = flag("--appendix", "Print the evidence, too; the HTML always has it.")
CONSTANT = option("--constant", "K", "Force or torque per ampere [N/A, N m/A].")
COLUMNS = option("--columns", "NAME=COLUMN", "Our name to one of the file.", None)
LANGUAGE = option(
    "--language",
    "|".join(LANGUAGES),
    "Language of what is printed; default: the environment's LANG, else en.",
    SPOKEN,
    callback=choose,
    is_eager=True,
)


def read_machine(
    profile: Path, *, f_max: str = "", sizes: str = ""
) -> tuple[Machine, ProfileSource]:
    """Return the machine of a profile, with what ``--f-max`` and ``--for`` say, and its text."""
    from mtcommission.cli.language import speak_of
    from mtcommission.machine.profile.read import parse_profile, read_source

    source = read_source(profile)
    machine = parse_profile(source.text, where=str(profile))
    speak_of(machine)
    if not f_max and not sizes:
        return machine, source
    from mtcommission.commission.options import with_options

    return with_options(machine, f_max=f_max, sizes=sizes), source
