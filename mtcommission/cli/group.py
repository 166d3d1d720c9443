"""The command ``group``: axes that move together."""

from __future__ import annotations

import shlex
from pathlib import Path

import typer

from mtcommission.base.messages.message import Message
from mtcommission.base.process import now
from mtcommission.cli.arguments import JSON, LANGUAGE, argument, option, read_machine
from mtcommission.cli.language import say, words
from mtcommission.cli.terminal import print_said, show, show_stage


def group(
    profiles_of_axes: list[Path] = argument("PROFILE...", "Profile of each axis, two or three."),
    output: Path | None = option("-o --output", "DIR", "Folder.", None),
    tolerance: str = option(
        "--tolerance", "T", "Largest contour deviation, e.g. 10um; default: least of the profiles."
    ),
    plane: str = option("--plane", "XY", "The axes of circles and corners."),
    feed: str = option("--feed", "V", "Fastest feed of contours, e.g. 6m/min."),
    radius: str = option("--radius", "R", "Of a circle that keeps the tolerance then, e.g. 10mm."),
    language: str = LANGUAGE,
    json_file: str = JSON,
) -> None:
    """Axes that move together: one filter, one delay, limits; circle and corner.

    DIR gets group.json, sheet.html and sheet.pdf.
    """
    from mtcommission.base.files import require_folder, require_writable, write_files, write_text

    if output:
        require_folder(output, "group.json", "sheet.html", "sheet.pdf", inputs=profiles_of_axes)
    require_writable(json_file, inputs=profiles_of_axes)
    read = [read_machine(profile) for profile in profiles_of_axes]

    from mtcommission.cli.group_view import describe_group
    from mtcommission.group.group import join
    from mtcommission.group.record import build_group_record
    from mtcommission.group.sheet import print_group
    from mtcommission.group.task import read_task
    from mtcommission.record.shape import dump_json

    task = read_task(
        [machine for machine, _ in read],
        [source for _, source in read],
        tolerance=tolerance,
        plane=plane,
        feed=feed,
        radius=radius,
    )
    files: dict[str, bytes] = {}
    with show_stage() as progress:
        joined = join(task, progress=progress)
        record = build_group_record(joined, created=now())
        if output:
            progress(Message("stage-sheet"))
            printed = print_group(record, joined.pair, language=words().language)
            files = {"group.json": dump_json(record).encode(), **printed}
    if json_file:
        write_text(json_file, dump_json(record))
    if output:
        write_files(output, files)
    if json_file != "-":
        show(describe_group(record, words()))
    if output:
        show([say("cli-written-into", folder=str(output), files=tuple(files))])
        file = shlex.quote(str(output / "group.json"))
        print_said("cli-next-export", record=file, control=record.axes[0].loop.kind)
    raise typer.Exit(0 if record.assessment.met else 1)
