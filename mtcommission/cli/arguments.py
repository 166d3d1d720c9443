"""Arguments and options that several commands share, and the machine that they name."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from mtcommission.machine.machine import Machine
    from mtcommission.profile.read import ProfileSource

ProfileArgument = Annotated[Path, typer.Argument(metavar="PROFILE", help="Machine profile (TOML).")]
ForceOption = Annotated[
    str,
    typer.Option("--f-max", metavar="F", help="Force limit for this call, e.g. 2kN."),
]
JsonOption = Annotated[
    str, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for the screen.")
]
CsvOption = Annotated[
    str, typer.Option("--csv", metavar="FILE", help="Write the motion as CSV; - for the screen.")
]
RecordArgument = Annotated[Path, typer.Argument(metavar="RECORD", help="record.json of a run.")]
FolderOption = Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder.")]
SizesOption = Annotated[
    str,
    typer.Option("--for", metavar="every|listed", help="Sizes of move that the limits serve."),
]
NoPdfOption = Annotated[bool, typer.Option("--no-pdf", help="Leave the PDF out.")]
AppendixOption = Annotated[
    bool,
    typer.Option("--appendix", help="Print the evidence, too; the HTML always has it."),
]
ConstantOption = Annotated[
    str, typer.Option("--constant", metavar="K", help="Force or torque per ampere [N/A, N m/A].")
]
ColumnsOption = Annotated[
    list[str] | None,
    typer.Option("--columns", metavar="NAME=COLUMN", help="Our name to one of the file."),
]


def read_machine(
    profile: Path, *, f_max: str = "", sizes: str = ""
) -> tuple[Machine, ProfileSource]:
    """Return the machine of a profile, with what ``--f-max`` and ``--for`` say, and its text."""
    from mtcommission.cli.language import speak_of
    from mtcommission.profile.read import parse_profile, read_source

    source = read_source(profile)
    machine = parse_profile(source.text, where=str(profile))
    speak_of(machine)
    if not f_max and not sizes:
        return machine, source
    from mtcommission.options import with_options

    return with_options(machine, f_max=f_max, sizes=sizes), source
