"""Commands that read measurements: identify and verify."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from mtcommission.base.errors import InputError
from mtcommission.base.files import require_folder, require_writable, write_files, write_text
from mtcommission.base.messages.message import Message
from mtcommission.base.process import now
from mtcommission.base.units.quantities import FREQUENCY, parse_quantity
from mtcommission.cli.arguments import (
    COLUMNS,
    CONSTANT,
    JSON,
    LANGUAGE,
    RECORD,
    argument,
    flag,
    option,
    read_machine,
)
from mtcommission.cli.language import speak_of, words
from mtcommission.cli.terminal import Line, print_said, print_written, show, show_stage

MOST_MODES = 8
"""Of a profile."""

PER_AMPERE = ("N/A", "N m/A", "N*m/A", "Nm/A")
"""Units of a force or torque constant, all of SI."""

if TYPE_CHECKING:
    from mtcommission.measured.measurement import Given


def identify(
    files: list[str] = argument("FILE...", "Measurements; FILE@tcp, FILE@encoder, FILE@RESPONSE."),
    profile: Path | None = option("--profile", "PROFILE", "Profile to take the modes in.", None),
    output: str = option("-o", "NEW.toml", "Profile to write."),
    sensor: str = option("--sensor", "encoder|tcp", "Where the sensor sits."),
    input_: str = option("--input", "force|torque|current|acceleration", "What excites the axis."),
    constant: str = CONSTANT,
    measured: str = option("--output", "position|velocity|acceleration", "What it shows."),
    columns: list[str] | None = COLUMNS,
    band: str = option("--band", "LOW:HIGH", "Lines to fit [Hz]; default chosen."),
    modes: str = option("--modes", "N|auto", "Number of modes.", "auto"),
    tool_ratio: str = option(
        "--tool-ratio", "R", "Peak at the tool by peak at the motor, if known."
    ),
    force: bool = flag("--force", "Write a profile even if no model fits, and say so."),
    page: str = option("--page", "FILE.html", "Measured over fitted, as a page."),
    language: str = LANGUAGE,
    json_file: str = JSON,
) -> None:
    """Measured responses to mass, delay and modes in a profile.

    Reads tables of responses and signals, SINUMERIK, TwinCAT, LinuxCNC, Klipper and UFF files.
    Klipper's resonances_x_... and resonances_y_... at once: NEW-x.toml and NEW-y.toml.
    """
    from mtcommission.identify.gather import by_axis, of_axis, split_name

    limits, count = _read_band(band), _read_count(modes)
    ratio = read_number("--tool-ratio", tool_ratio) if tool_ratio else None
    given = _read_given(sensor, input_, constant, measured, columns or [], profile)
    axes = by_axis([split_name(one).name for one in files])
    is_one = len(axes) == 1
    if not is_one and (profile is not None or "-" in (output, page, json_file)):
        raise InputError.at("FILE", Message("identify-several-axes", axes=", ".join(axes)))
    jobs = []
    for axis, own in axes.items():
        chosen = [one for one in files if split_name(one).name in own]
        new, shown, entry = (
            of_axis(one, "" if is_one else axis) for one in (output, page, json_file)
        )
        jobs.append(_Job(chosen, profile, new, shown, entry, axis))
    for job in jobs:
        inputs = [Path(split_name(one).name) for one in job.files]
        require_writable(job.beside, job.page, job.output, inputs=inputs)
        _keep_others(job.output, job.profile)
    sound = [
        _identify(job, given, language, ratio=ratio, force=force, band_hz=limits, count=count)
        for job in jobs
    ]
    raise typer.Exit(0 if all(sound) else 1)


class _Job(NamedTuple):
    """Files of one axis, and what is written for it."""

    files: list[str]
    profile: Path | None
    output: str
    page: str
    json_file: str
    axis: str

    @property
    def beside(self) -> str:
        """The file with points and advice; "" for none."""
        if self.json_file or self.output in ("", "-"):
            return self.json_file
        from mtcommission.identify.profile import evidence_file

        return evidence_file(self.output)


def _identify(
    job: _Job, given: Given, language: str, *, ratio: float | None, force: bool, **fit: Any
) -> bool:
    """One axis: files to profile, page and terminal; whether a profile may be written."""
    from mtcommission.machine.profile.read import read_profile_text

    before = read_profile_text(job.profile) if job.profile else ""

    from mtcommission.cli.identified_view import describe_identified, refusal
    from mtcommission.identify.gather import gather
    from mtcommission.identify.identified import identify
    from mtcommission.identify.profile import Writing, merge_profile, name_from, write_profile

    output, beside = job.output, job.beside
    how = Writing(
        file=output or str(job.profile or "machine.toml"),
        words=lambda rotary: words(rotary=rotary),
        evidence=name_from(output, beside),
        axis=job.axis or "X",
        tool_ratio=ratio,
    )
    with show_stage() as progress:
        progress(Message("identify-stage"))
        axis = identify(gather(job.files, given), created=now(), **fit)
    is_sound = axis.doubt is None or force
    if is_sound:
        axis = merge_profile(before, axis, how) if before else write_profile(axis, how)
    else:
        beside, output = job.json_file, ""
    if job.page:
        from mtcommission.identify.page import print_identified

        page = print_identified(axis.part, profile=axis.profile, language=language)
        write_text(job.page, page)
    if output:
        write_text(output, axis.profile)
    if beside:
        write_text(beside, axis.json)
    if "-" in (job.json_file, job.output, job.page):
        if axis.doubt:
            sys.stderr.write("\n".join(refusal(axis.part, forced=force)) + "\n")
        return is_sound
    show(describe_identified(axis.part, forced=force))
    if written := [name for name in (output, job.page, beside) if name]:
        print_written(Path(), written)
    if output:
        then = "-run" if axis.part.proposals else "-check" if job.profile else ""
        print_said(f"identify-next{then}", file=output)
    return is_sound


def _keep_others(output: str, profile: Path | None) -> None:
    """Refuse to write over a profile that somebody else has written."""
    file = Path(output)
    if output in ("", "-") or not file.is_file() or (profile and profile.samefile(file)):
        return
    if "[identified]" not in file.read_text(encoding="utf-8", errors="replace"):
        raise InputError.at("-o", Message("identify-profile-there", file=output))


def _read_given(
    sensor: str, input_: str, constant: str, measured: str, columns: list[str], profile: Path | None
) -> Given:
    from mtcommission.commission.options import Options
    from mtcommission.measured.measurement import (
        INPUTS,
        MOTIONS,
        Given,
        Sensor,
        Signal,
    )

    with Options() as options:
        options.word("--sensor", sensor, ("", *(one.value for one in Sensor)))
        options.word("--input", input_, ("", *INPUTS))
        options.word("--output", measured, ("", *(one.value for one in MOTIONS)))
    given = Given(
        sensor=Sensor(sensor) if sensor else None,
        input=input_,
        constant=read_number("--constant", constant, units=PER_AMPERE) if constant else None,
        output=Signal(measured) if measured else None,
        columns=read_columns(columns),
    )
    return given.on(read_machine(profile)[0]) if profile else given


def read_number(option: str, text: str, *, units: tuple[str, ...] = ()) -> float:
    """A number other than 0, with or without one of some units of SI, which say nothing new."""
    number, _, unit = text.strip().replace(",", ".").partition(" ")
    for one in units:  # "12N/A", too
        number = number.removesuffix(one)
    try:
        value = float(number) if unit.strip() in ("", *units) else 0.0
    except ValueError:
        value = 0.0
    if not (isfinite(value) and value != 0.0):
        kind = "identify-option-constant" if units else "identify-option-number"
        raise InputError.at(option, Message(kind, got=text))
    return value


def _read_band(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    try:
        low, high = (parse_quantity(part, FREQUENCY) for part in text.split(":"))
    except ValueError:  # more or fewer parts, or one that is no frequency
        low = high = 0.0
    if not 0.0 < low < high:
        raise InputError.at("--band", Message("identify-option-band", got=text))
    return low, high


def _read_count(text: str) -> int | None:
    if text == "auto":
        return None
    if not (text.isdigit() and 1 <= int(text) <= MOST_MODES):
        raise InputError.at("--modes", Message("identify-option-modes", got=text, most=MOST_MODES))
    return int(text)


def read_columns(pairs: Sequence[str]) -> Mapping[str, str]:
    """Return our names to those of a file, as ``--columns`` gives them."""
    found = {}
    for pair in pairs:
        name, equals, column = pair.partition("=")
        if not (name.strip() and equals and column.strip()):
            raise InputError.at("--columns", Message("option-form", got=pair, form="NAME=COLUMN"))
        found[name.strip()] = column.strip()
    return found


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
    from mtcommission.measured.measurement import Given

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
            raise InputError.at(name, Message("group-verify-one-axis"))
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
    raise typer.Exit(0 if told.verdict == "holds" else 1)


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
    from mtcommission.cli.verified_view import describe_verification
    from mtcommission.machine.profile.read import parse_profile
    from mtcommission.record.record import load_record
    from mtcommission.verify.refine import find_new_limits, renew_profile
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
        from mtcommission.verify.report import print_verification

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
    from mtcommission.cli.verified_view import describe_circles
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
        lines=lambda: describe_circles(found),
    )
