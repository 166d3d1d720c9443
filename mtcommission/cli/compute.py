"""Commands that compute: run, optimal, limits, simulate, group, sweep, validate.

What can be refused is refused before the loop's libraries are imported, which takes seconds.
"""

from __future__ import annotations

import os
import shlex
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mtcommission.base.files import require_folder, require_writable, write_files, write_text
from mtcommission.base.messages.message import Message
from mtcommission.base.process import now
from mtcommission.cli.arguments import (
    APPENDIX,
    CSV,
    F_MAX,
    FOLDER,
    JSON,
    LANGUAGE,
    NO_PDF,
    PROFILE,
    SIZES,
    argument,
    flag,
    option,
    read_machine,
)
from mtcommission.cli.language import say, words
from mtcommission.cli.terminal import (
    print_note,
    print_said,
    print_written,
    show,
    show_bar,
    show_stage,
)

if TYPE_CHECKING:
    from mtcommission.commission.recommend import Recommendation
    from mtcommission.machine.profile.read import ProfileSource
    from mtcommission.record.shape import Words

ROWS_BELOW = 4
"""Lines that ``run`` says below its answer: what was written, and what to do next."""


def run(
    profile: Path = PROFILE,
    output: Path = option("-o --output", "DIR", "Folder.", Path("commissioning")),
    f_max: str = F_MAX,
    language: str = LANGUAGE,
    no_pdf: bool = NO_PDF,
    sizes: str = SIZES,
    appendix: bool = APPENDIX,
) -> None:
    """Compute the limits; write record, sheet and setpoint.

    DIR gets record.json, sheet.html, sheet.pdf and, for each move, a setpoint.csv.
    """
    names = ("record.json", "sheet.html", "sheet.pdf", "setpoint.csv")
    require_folder(output, *names, inputs=[profile])
    machine, source = read_machine(profile, f_max=f_max, sizes=sizes)

    from mtcommission.cli.csv_texts import setpoint_csv
    from mtcommission.cli.limits_view import ROWS, describe_limits
    from mtcommission.commission.commission import commission
    from mtcommission.controls.kinds import GENERIC
    from mtcommission.export.catalogue import CONTROL_KEYS
    from mtcommission.export.write import type_in
    from mtcommission.record.limits import limits_answer
    from mtcommission.record.machine import list_assumed
    from mtcommission.record.record import record_run
    from mtcommission.record.shape import dump_json
    from mtcommission.sheet.content import print_html, print_pdf, remark_on_print
    from mtcommission.sheet.verdict import (
        assumed_and_binding,
        attainable_sentences,
        reference_sentence,
        slowest_move,
    )

    spoken = words()
    with show_stage() as progress:
        found = commission(
            machine, profile=source, progress=progress, announce=partial(progress.announce, machine)
        )
        progress(Message("stage-improvements"))
        record = record_run(found, created=now())
        progress(Message("stage-sheet"))
        typed = type_in(record)
        notes = (Message("entry-none", why=typed),) if isinstance(typed, Message) else typed.doubts
        files = {
            "record.json": dump_json(record).encode(),
            "sheet.html": print_html(record, typed, language=language).encode(),
        }
        if not no_pdf:
            files["sheet.pdf"] = print_pdf(record, typed, language=language, appendix=appendix)
            notes = (*notes, *remark_on_print(record))
        for number, move in enumerate(found.moves, start=1):
            name = "setpoint.csv" if number == 1 else f"setpoint-{number}.csv"
            cycle = found.tuned.controller.position_cycle
            files[name] = setpoint_csv(move.setpoint, step=cycle).encode()
    write_files(output, files)
    answer = limits_answer(found)
    # Rules stand in the appendix; warnings are always said, those of the record alone as well.
    warned = list(dict.fromkeys([*answer.warnings, *record.warnings]))
    answer = replace(answer, rules=[], warnings=warned)
    further: tuple[Message | str, ...] = (
        *attainable_sentences(record, spoken),
        *assumed_and_binding(record, spoken),
        *notes,
        reference_sentence(record, slowest_move(record), spoken),
    )
    rows = ROWS - ROWS_BELOW
    assumed = list_assumed(machine, found.plant, source.text, spoken)
    lines = describe_limits(
        machine, answer, spoken, assumed=assumed, further=further, rows=rows, has_sheet=True
    )
    show(lines)
    kind = machine.control.kind.key
    is_known = kind in CONTROL_KEYS and kind != GENERIC.key
    file = shlex.quote(str(output / "record.json"))
    following = say("cli-next-export", record=file, control=kind if is_known else "NAME")
    if not is_known:
        indent = " " * (following.index(":") + 2)
        following += f"\n{indent}{say('cli-list-of-controls')}"
    show([say("cli-written-into", folder=str(output), files=tuple(files))])
    sys.stdout.write(f"{following}\n")
    raise typer.Exit(0 if record.assessment.met else 1)


def optimal(
    profile: Path = PROFILE,
    kind: str = option("--kind", "time|damping", "What to minimise.", ...),
    t_f: str = option("--t-f", "S", "Final time (damping), e.g. 52.2ms."),
    limit: list[str] | None = option(
        "--limit", "NAME=VALUE", "E.g. v_phi=5mrad/s; repeatable.", None
    ),
    f_max: str = F_MAX,
    velocity_step: str = option("--velocity-step", "V", "Move instead of the profile's."),
    distance: str = option("--distance", "L", "Move instead of the profile's."),
    move: int = option("--move", "N", "Which of the profile's moves.", 1),
    method: str = option(
        "--method",
        "exact|transcription",
        "Exact with proof, or on a grid without (needed for damping with --limit).",
        "exact",
    ),
    scheme: str = option(
        "--scheme", "NAME", "Transcription: euler, trapezoidal or gauss.", "gauss"
    ),
    intervals: int = option("--intervals", "N", "Transcription: intervals.", 1000),
    jerk: str = option("--jerk", "J", "Jerk limit of an open-loop axis."),
    language: str = LANGUAGE,
    json_file: str = JSON,
    csv_file: str = CSV,
) -> None:
    """Compute one optimal control."""
    from time import perf_counter

    from mtcommission.cli.csv_texts import motion_csv
    from mtcommission.cli.optimum_view import describe_optimum
    from mtcommission.commission.options import final_time_origin, read_optimal_request, solve
    from mtcommission.machine.plant.plant import build_plant
    from mtcommission.record.optima import optimum_entry
    from mtcommission.record.shape import dump_json, to_plain

    require_writable(json_file, csv_file, inputs=[profile])
    machine, _ = read_machine(profile, f_max=f_max)
    plant = build_plant(machine)
    request = read_optimal_request(
        machine,
        plant,
        kind=kind,
        method=method,
        t_f=t_f,
        limits=limit or [],
        velocity_step=velocity_step,
        distance=distance,
        move=move,
        scheme=scheme,
        intervals=intervals,
        jerk=jerk,
    )
    with show_stage() as progress:
        progress(Message(f"terminal-{kind}-optimal"))
        begun = perf_counter()
        solution = solve(machine, plant, request)
        elapsed = perf_counter() - begun
    entry = {**to_plain(optimum_entry(plant, solution)), "solve_time": elapsed}
    entry.pop("series")
    if json_file:
        write_text(json_file, dump_json(entry))
    if csv_file:
        write_text(csv_file, motion_csv(plant, solution))
    if "-" not in (json_file, csv_file):
        origin = final_time_origin(machine, request)
        show(describe_optimum(machine, plant, solution, words(), origin=origin))


def limits(
    profile: Path = PROFILE,
    f_max: str = F_MAX,
    sizes: str = SIZES,
    language: str = LANGUAGE,
    json_file: str = JSON,
    page: str = option("--page", "FILE", "Only a page to try values on, without the rest."),
) -> None:
    """Recommend acceleration and jerk; rules of thumb beside them."""
    require_writable(json_file, page, inputs=[profile])
    machine, source = read_machine(profile, f_max=f_max, sizes=sizes)
    is_page_only = bool(page and not json_file)

    from mtcommission.commission.recommend import recommend

    with show_stage() as progress:
        found = recommend(
            machine,
            with_rules=not is_page_only,
            progress=progress,
            announce=partial(progress.announce, machine),
        )
    if page:
        write_text(page, _page_of(found, source, language=language))
    if is_page_only:
        if page != "-":
            print_said("cli-page-written", file=page)
        raise typer.Exit(0 if found.choice.meets_requirements else 1)

    from mtcommission.cli.limits_view import ROWS, describe_limits
    from mtcommission.record.limits import limits_answer
    from mtcommission.record.machine import list_assumed
    from mtcommission.record.shape import dump_json

    answer = limits_answer(found)
    if json_file:
        write_text(json_file, dump_json(answer))
    if "-" not in (json_file, page):
        assumed = list_assumed(machine, found.plant, source.text, words())
        show(describe_limits(machine, answer, words(), assumed=assumed, rows=ROWS - 1))
        print_said("cli-next-run", profile=shlex.quote(str(profile)))
    raise typer.Exit(0 if answer.assessment.met else 1)


def _page_of(found: Recommendation, source: ProfileSource, *, language: str) -> str:
    from mtcommission.record.loop import what_if_part
    from mtcommission.record.machine import MachineEntry, Profile
    from mtcommission.record.shape import entry_of
    from mtcommission.sheet.what_if import print_answers

    machine, limits = found.machine, found.choice.limits
    part = what_if_part(machine, found.plant, found.tuned, limits, found.today)
    about, text = entry_of(MachineEntry, machine), entry_of(Profile, source)
    return print_answers(part, about, text, created=now(), language=language)


def simulate(
    profile: Path = PROFILE,
    acceleration: str = option("--acceleration", "A", "E.g. 2m/s^2.", ...),
    jerk: str = option("--jerk", "J", "E.g. 100m/s^3; needed where the control limits it."),
    setpoint_filter: str = option(
        "--filter",
        "TIME|KIND:...",
        "Length of a moving average, e.g. 20ms; a shaper's frequency and damping ratio, "
        "e.g. zvd:40Hz:0.05; none.",
    ),
    move: int | None = option(
        "--move", "N", "Only this one of the profile's moves, counted from 1; otherwise all.", None
    ),
    size: str = option("--size", "S", "Its distance or velocity step."),
    payload: str = option("--payload", "M", "Of one machine more, e.g. 50kg."),
    frequency_error: str = option("--frequency-error", "E", "Of that machine, e.g. 7%."),
    f_max: str = F_MAX,
    sizes: str = SIZES,
    language: str = LANGUAGE,
    json_file: str = JSON,
    csv_file: str = CSV,
) -> None:
    """Run one setpoint through the loop and evaluate it.

    The loop is that of the profile, whatever is tried.
    """
    from mtcommission.commission.options import read_limits, read_tried
    from mtcommission.machine.machine import require_force
    from mtcommission.setpoint.duration import require_short_moves

    require_writable(json_file, csv_file, inputs=[profile])
    machine, source = read_machine(profile, f_max=f_max, sizes=sizes)
    asked = chosen = read_limits(machine, acceleration=acceleration, jerk=jerk)
    tried = read_tried(
        machine,
        setpoint_filter=setpoint_filter,
        move=move,
        size=size,
        payload=payload,
        error=frequency_error,
    )
    require_force(machine)
    require_short_moves(tried.machine, acceleration=chosen.acceleration)

    from mtcommission.cli.limits_view import describe_simulation
    from mtcommission.limits.judge import simulate_moves
    from mtcommission.loop.tuning.tuned import close_beside
    from mtcommission.machine.plant.plant import build_plant
    from mtcommission.record.machine import list_assumed
    from mtcommission.record.moves import simulation_part
    from mtcommission.record.shape import dump_json
    from mtcommission.setpoint.motion_limits import without_jerk_limit
    from mtcommission.study.loops import describe_loop, settle_on_loop

    notes: list[Words] = []
    if tried.machine.control.seeks_setpoint_filter:
        notes.append(Message("simulated-without-filter"))
    if asked.jerk_time < machine.control.position_cycle:
        chosen = without_jerk_limit(machine, asked.acceleration)
        ramps = {"ramp": asked.jerk_time, "cycle": chosen.jerk_time}
        notes.append(Message("simulated-ramp-of-a-cycle", **ramps))
    plant = build_plant(machine)
    with show_stage() as progress:
        progress(Message("stage-feedback-loop"))
        tuned = settle_on_loop(machine).tuned
        if tried.place:
            tuned = close_beside(tuned, machine, tried.place)
        progress(Message("stage-response"))
        moves = simulate_moves(tried.machine, tuned, chosen)
    notes += describe_loop(tuned.controller)
    part = simulation_part(tried.machine, plant, tuned, moves)
    part = replace(part, warnings=[*notes, *part.warnings])
    if json_file:
        write_text(json_file, dump_json(part))
    if csv_file:
        from mtcommission.cli.csv_texts import response_csv

        write_text(csv_file, response_csv(plant, moves[0]))
    if "-" not in (json_file, csv_file):
        assumed = list_assumed(tried.machine, plant, source.text, words())
        first = move or 1
        show(describe_simulation(tried.machine, chosen, part, assumed, words(), first=first))
    raise typer.Exit(0 if part.assessment.met else 1)


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
    if output:
        require_folder(output, "group.json", "sheet.html", "sheet.pdf", inputs=profiles_of_axes)
    require_writable(json_file, inputs=profiles_of_axes)
    read = [read_machine(profile) for profile in profiles_of_axes]

    from mtcommission.cli.group_view import describe_group, say_next
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
        if record.assessment.met:
            print_said("cli-next-export", record=file, control=record.axes[0].loop.kind)
    if json_file != "-" and not record.assessment.met:
        show([say_next(record, profiles_of_axes, words())])
    raise typer.Exit(0 if record.assessment.met else 1)


def sweep(
    profile: Path = PROFILE,
    output: Path = FOLDER,
    f_max: str = option("--f-max", "RANGE", "E.g. 0.5kN:4kN:100, log:300:20e3:50."),
    vary: list[str] | None = option(
        "--vary", "KEY=RANGE", "E.g. plant.slider_mass=600:900:7.", None
    ),
    cases: Path | None = option("--cases", "FILE", "CSV: keys, then a case a line.", None),
    paired: bool = flag("--paired", "Ranges go together instead of each with each."),
    quantity: str = option("--quantity", "optimal|limits|run", "What to compute.", "optimal"),
    limit: list[str] | None = option(
        "--limit",
        "NAME=RANGE",
        "For optimal, e.g. v_phi=5mrad/s or v_phi=4mrad/s:20mrad/s:9.",
        None,
    ),
    move: int = option("--move", "N", "Which of the profile's moves (optimal).", 1),
    workers: int = option("--workers", "N", "Processes; 0: one per core.", 0, min=0),
    scheduler: str = option("--scheduler", "ADDRESS", "Dask, e.g. tcp://host:8786."),
    resume: bool = flag("--resume", "Continue what is in DIR."),
    language: str = LANGUAGE,
) -> None:
    """Compute many cases; write a table and a page.

    A RANGE is START:STOP:COUNT, log:START:STOP:COUNT, random:LOW:HIGH:COUNT:SEED or a comma list.
    Several ranges make a grid. DIR gets rows.parquet, rows.csv and sweep.html.
    """
    from mtcommission.sweep.engine import RESULTS, run_sweep
    from mtcommission.sweep.lanes import Engine
    from mtcommission.sweep.request import read_plan
    from mtcommission.sweep.store import write_safely
    from mtcommission.sweep.table import (
        print_sweep,
        read_table,
        summarise,
        write_table,
    )

    require_folder(output, *RESULTS, inputs=[profile, *([cases] if cases else [])])
    plan = read_plan(
        profile,
        f_max=f_max,
        vary=vary or [],
        limits=limit or [],
        cases=cases,
        is_paired=paired,
        quantity=quantity,
        move=move,
        created=now(),
    )
    engine = Engine(workers=workers or os.cpu_count() or 1, scheduler=scheduler)
    with show_bar(plan.count) as progress:
        store = run_sweep(
            plan, folder=output, engine=engine, resume=resume, progress=progress, notice=print_note
        )
    table = read_table(plan, store)
    write_table(table, output, words())
    page = print_sweep(plan, table, words(), created=store.created)
    write_safely(output / "sweep.html", page.encode())
    sys.stdout.write("\n".join(summarise(table, words())) + "\n")
    print_written(output, RESULTS)
    raise typer.Exit(0 if table.is_met else 1 if table.done else 3)


def validate(
    all_rows: bool = flag("--all", "Every row, not only what does not agree as printed."),
    json_file: str = JSON,
    output: str = option("-o --output", "DIR", "Write validation.html there."),
    language: str = LANGUAGE,
) -> None:
    """Put the paper's numbers and claims beside ours.

    Exit code 1 if one is out of its stated tolerance.
    """
    from mtcommission.cli.validation_view import describe_validation
    from mtcommission.record.shape import dump_json
    from mtcommission.validate import page

    require_writable(json_file)
    if output:
        require_folder(Path(output), "validation.html")
    with show_stage() as progress:
        found = page.validate(progress)
    if json_file:
        write_text(json_file, dump_json(page.validation_entry(found)))
    if output:
        text = page.print_validation(found, words(), created=now())
        write_files(Path(output), {"validation.html": text.encode()})
    if json_file != "-":
        show(describe_validation(found, words(), every_row=all_rows))
    raise typer.Exit(0 if found.is_met else 1)
