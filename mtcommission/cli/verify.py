"""The command that compares recorded moves with the record of a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.base.process import now
from mtcommission.cli.arguments import COLUMNS, CONSTANT, JSON, LANGUAGE, RECORD, argument, option
from mtcommission.cli.language import speak_of, words
from mtcommission.cli.measured import PER_AMPERE, read_columns, read_number
from mtcommission.cli.terminal import Line, print_written, show, show_stage

if TYPE_CHECKING:
    from mtcommission.identify.measurement import Given

EXIT_BY_VERDICT = {"holds": 0, "does not hold": 1, "cannot tell": 1}


def verify(
    record: Path = RECORD,
    traces: list[str] = argument("TRACE...", "Recorded moves, or circles."),
    columns: list[str] | None = COLUMNS,
    constant: str = CONSTANT,
    renewed: str = option("--refine", "NEW.toml", "Profile as the traces show it."),
    output: Path | None = option("-o --output", "DIR", "Folder for the page.", None),
    language: str = LANGUAGE,
    json_file: str = JSON,
) -> None:
    """Recorded moves beside the prediction: does it hold, and why not.

    Says first whether the control sent what was entered. Reads what identify reads.
    """
    from mtcommission.base.files import require_folder, require_writable, write_files, write_text
    from mtcommission.identify.measurement import Given

    inputs = [record, *(Path(name) for name in traces if name != "-")]
    require_writable(json_file, renewed, inputs=inputs)
    if output:
        require_folder(output, "verification.html", "verdict.json", inputs=inputs)
    said = read_columns(columns or [])
    force = read_number("--constant", constant, units=PER_AMPERE) if constant else None

    from mtcommission.record.shape import dump_json, names_group

    is_group = names_group(record)
    for name, given in (("--constant", constant), ("--refine", renewed)):
        if is_group and given:
            raise InputError([Fault(where=name, message=Message("group-verify-one-axis"))])
    with show_stage() as progress:
        if is_group:
            told = _verify_circles(record, traces, said, language, progress)
        else:
            about = Given(columns=said, constant=force)
            told = _verify_moves(record, traces, about, renewed, language, progress)
    entry, files = dump_json(told.entry), dict[str, bytes]()
    if output:
        page = told.page(now())
        files = {"verification.html": page.encode(), "verdict.json": entry.encode()}
        write_files(output, files)
    if json_file:
        write_text(json_file, entry)
    if "-" not in (json_file, renewed):
        show(told.lines())
        if output:
            print_written(output, files)
        if renewed:
            print_written(Path(), [renewed])
    raise typer.Exit(EXIT_BY_VERDICT[told.verdict])


@dataclass(frozen=True, slots=True, kw_only=True)
class _Told:
    """What traces say: verdict and entry of the JSON, page by its date, terminal."""

    verdict: str
    entry: dict[str, object]
    page: Callable[[str], str]
    lines: Callable[[], list[Line]]


def _verify_moves(
    record: Path,
    names: Sequence[str],
    about: Given,
    renewed: str,
    language: str,
    progress: Callable[[Message], None],
) -> _Told:
    """Recorded moves beside the record of a run."""
    from mtcommission.base.files import write_text
    from mtcommission.cli.verified_view import describe_verification
    from mtcommission.machine.profile.read import parse_profile
    from mtcommission.record.record import load_record
    from mtcommission.verify.renew import find_new_limits, renew_profile
    from mtcommission.verify.report import report, verification_entry
    from mtcommission.verify.trace import read_trace
    from mtcommission.verify.verify import verify as compare

    loaded = load_record(record)
    machine = parse_profile(loaded.profile.text, where=loaded.profile.name)
    speak_of(machine)
    recorded = [read_trace(name, about.on(machine)) for name in names]
    progress(Message("verify-stage"))
    told = report(compare(loaded, recorded))
    if renewed:
        progress(Message("limits-name"))
        text = loaded.profile.text
        text = renew_profile(text, told.refined, words=words(), date=now()[:10])
        told = replace(told, limits=find_new_limits(loaded, text))
        write_text(renewed, text)

    def page(created: str) -> str:
        from mtcommission.verify.page import print_verification

        return print_verification(told, created=created, language=language)

    return _Told(
        verdict=told.found.verdict.value,
        entry=verification_entry(told),
        page=page,
        lines=lambda: describe_verification(told),
    )


def _verify_circles(
    record: Path,
    names: Sequence[str],
    said: Mapping[str, str],
    language: str,
    progress: Callable[[Message], None],
) -> _Told:
    """Recorded circles beside the record of a group."""
    from mtcommission.cli.group_view import describe_circles
    from mtcommission.group.record import load_group
    from mtcommission.group.recorded import read_circular
    from mtcommission.group.verify import circles_entry, print_circles, verify_circles

    loaded = load_group(record)
    traces = [read_circular(name, said, loaded.plane) for name in names]
    progress(Message("verify-stage"))
    found = verify_circles(loaded, traces)
    return _Told(
        verdict=found.verdict.value,
        entry=circles_entry(found),
        page=lambda created: print_circles(found, created=created, language=language),
        lines=lambda: describe_circles(found, words()),
    )
