"""Commands that only need the record of a run: sheet and export."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import typer

from mtcommission.base.errors import InputError
from mtcommission.base.files import require_folder, require_writable, write_files, write_text
from mtcommission.base.messages.message import Message
from mtcommission.cli.arguments import (
    APPENDIX,
    FOLDER,
    LANGUAGE,
    NO_PDF,
    RECORD,
    argument,
    flag,
    option,
)
from mtcommission.cli.language import speak_of, words
from mtcommission.cli.terminal import print_note, print_written, show, show_stage

if TYPE_CHECKING:
    from mtcommission.record.read_back import AxisRecord


def sheet(
    record: Path = RECORD,
    output: Path = FOLDER,
    compare: Path | None = option(
        "--compare", "BEFORE", "Earlier record.json: say what changed.", None
    ),
    verified: Path | None = option(
        "--verified", "VERDICT.json", "Of verify: fills what it measured.", None
    ),
    language: str = LANGUAGE,
    no_pdf: bool = NO_PDF,
    appendix: bool = APPENDIX,
) -> None:
    """Print the sheet again from the record alone."""
    from mtcommission.export.write import type_in
    from mtcommission.record.read_back import load_verdict
    from mtcommission.record.record import load_record
    from mtcommission.record.shape import names_group
    from mtcommission.sheet.content import print_html, print_pdf, remark_on_print
    from mtcommission.sheet.measurements import remark_on_comparison

    inputs = [record, *(one for one in (compare, verified) if one)]
    require_folder(output, "sheet.html", "sheet.pdf", inputs=inputs)
    if names_group(record):
        for name, given in (("--compare", compare), ("--verified", verified)):
            if given:
                raise InputError.at(name, Message("group-verify-one-axis"))
        _print_group(record, output, language, with_pdf=not no_pdf)
    loaded = load_record(record)
    before = load_record(compare) if compare else None
    found = load_verdict(verified, loaded) if verified else None
    with show_stage() as progress:
        progress(Message("stage-sheet"))
        typed = type_in(loaded)
        page = print_html(loaded, typed, language=language, before=before, verified=found)
        files = {"sheet.html": page.encode()}
        if not no_pdf:
            files["sheet.pdf"] = print_pdf(
                loaded,
                typed,
                language=language,
                before=before,
                verified=found,
                appendix=appendix,
            )
    write_files(output, files)
    notes = remark_on_comparison(before, loaded) if before else ()
    for note in (*notes, *(() if no_pdf else remark_on_print(loaded))):
        print_note(note)
    print_written(output, files)
    raise typer.Exit(0 if loaded.assessment.met else 1)


def _print_group(record: Path, output: Path, language: str, *, with_pdf: bool) -> NoReturn:
    from mtcommission.group.record import load_group, read_pair
    from mtcommission.group.sheet import print_group

    loaded = load_group(record)
    with show_stage() as progress:
        progress(Message("stage-sheet"))
        files = print_group(loaded, read_pair(loaded), language=language, with_pdf=with_pdf)
    write_files(output, files)
    print_written(output, files)
    raise typer.Exit(0 if loaded.assessment.met else 1)


def export(
    control: str = option("--control", "NAME", "E.g. sinumerik; ? lists all.", ...),
    record: Path | None = argument("RECORD", "record.json of a run, or group.json.", None),
    output: str = option("-o --output", "FILE", "- for the screen.", "-"),
    as_csv: bool = flag("--csv", "Parameter list to tick off instead."),
    language: str = LANGUAGE,
) -> None:
    """Write the limits in a control's own words and units.

    Text for entry by hand, to be verified; nothing is sent to a control.
    """
    from mtcommission.export.catalogue import describe_controls, find_control_key

    if control.strip() == "?":
        sys.stdout.write(describe_controls(words()))
        return
    if record is None:
        raise InputError.at("export", Message("cli-no-record"))
    key = find_control_key(control)
    require_writable(output, inputs=[record])

    from mtcommission.record.read_back import read_machine
    from mtcommission.record.shape import names_group

    with show_stage() as progress:
        progress(Message("stage-responses"))
        if names_group(record):
            from mtcommission.group.export import export_group
            from mtcommission.group.record import load_group

            group = load_group(record)
            together = export_group(group, control=key, language=language, as_list=as_csv)
            text, is_met, missed = together.text, together.meets_requirements, together.missed
            axis: AxisRecord = group.axes[0]
        else:
            from mtcommission.export.write import export_record
            from mtcommission.record.record import load_record

            loaded = load_record(record)
            alone = export_record(loaded, control=key, language=language, as_list=as_csv)
            text, is_met, axis = alone.text, alone.meets_requirements, loaded
            missed = () if is_met else (alone.judgement,)
    write_text(output, text)
    speak_of(read_machine(axis))
    if output == "-":
        for sentence in missed:
            print_note(sentence)
    else:
        print_written(Path(output))
        show((words().say(sentence), "yellow" if is_met else "red") for sentence in missed)
    raise typer.Exit(0 if is_met else 1)
