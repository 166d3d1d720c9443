"""Arguments and options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

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
