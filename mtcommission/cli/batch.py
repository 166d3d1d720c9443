"""Commands that compute many cases: sweep and validate."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import typer

from mtcommission.base.process import now
from mtcommission.cli.arguments import FOLDER, JSON, LANGUAGE, PROFILE, flag, option
from mtcommission.cli.language import words
from mtcommission.cli.terminal import print_note, print_written, show, show_bar, show_stage


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
    from mtcommission.base.files import require_folder
    from mtcommission.sweep.engine import RESULTS, run_sweep
    from mtcommission.sweep.lanes import Engine
    from mtcommission.sweep.page import print_sweep
    from mtcommission.sweep.request import read_plan
    from mtcommission.sweep.table import read_table, summarise, write_safely, write_table

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
    write_safely(output / "sweep.html", lambda file: file.write(page.encode()))
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
    from mtcommission.base.files import require_folder, require_writable, write_files, write_text
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
