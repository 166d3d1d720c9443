"""The commands, each a few lines: read the input, call one verb, write the result.

Heavy imports sit inside the commands, so that ``--help`` answers at once.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from mtcommission import __version__
from mtcommission.errors import Fault, InputError, MtcommissionError

if TYPE_CHECKING:
    from mtcommission.commission import Commissioning
    from mtcommission.machine import Machine
    from mtcommission.record.schema import Profile, Record

app = typer.Typer(
    name="mtcommission",
    help="Acceleration and jerk limits for machine tool axes, from the mechanical model.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

ProfileArgument = Annotated[Path, typer.Argument(metavar="PROFILE", help="Machine profile (TOML).")]
ForceOption = Annotated[
    str,
    typer.Option("--f-max", metavar="F", help="Force limit for this call, e.g. 2kN."),
]
LanguageOption = Annotated[
    str, typer.Option("--language", metavar="en|de", help="Language of sheet and summary.")
]
JsonOption = Annotated[
    str, typer.Option("--json", metavar="FILE", help="Write the result as JSON; - for the screen.")
]
CsvOption = Annotated[
    str, typer.Option("--csv", metavar="FILE", help="Write the motion as CSV; - for the screen.")
]


def main() -> NoReturn:
    """Run the command line; every error becomes a message and an exit code."""
    # Matrices here have some ten rows: threads cost more than they give, and the order of
    # summation would change from run to run.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="replace")
    try:
        app()
    except MtcommissionError as error:
        _fail(str(error), error.exit_code)
    except KeyboardInterrupt:
        _fail("interrupted; nothing was written", 3)
    except BrokenPipeError:
        os._exit(0)  # the reader of our output has gone: nobody to tell
    except OSError as error:
        _fail(f"{error.filename or 'file system'}: {error.strerror or error}", 2)
    except Exception as error:
        _fail(f"internal error, please report it with the profile: {error!r}", 3)
    sys.exit(0)


def _fail(message: str, code: int) -> NoReturn:
    sys.stderr.write(message + "\n")
    sys.exit(code)


def _print_version(wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"mtcommission {__version__}\n")
        raise typer.Exit


@app.callback()
def start(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Version.")
    ] = False,
) -> None:
    """Acceleration and jerk limits for machine tool axes, from the mechanical model."""


@app.command()
def run(
    profile: ProfileArgument,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder.")] = Path(
        "commissioning"
    ),
    f_max: ForceOption = "",
    language: LanguageOption = "en",
    no_pdf: Annotated[bool, typer.Option("--no-pdf", help="Leave the PDF out.")] = False,
) -> None:
    """Compute limits and write record.json, sheet.html, sheet.pdf and setpoint.csv."""
    from mtcommission.files import setpoint_csv, write_files
    from mtcommission.record.build import build_record
    from mtcommission.record.files import dump_json
    from mtcommission.sheet import print_html, print_pdf, summarise
    from mtcommission.sheet.languages import find_labels
    from mtcommission.terminal import show

    find_labels(language)
    found = _compute(profile, f_max)
    record = build_record(
        found,
        profile=_describe_profile(profile),
        created=_now(),
        warnings=_warnings(found.machine),
    )
    with _progress() as progress:
        progress("sheet")
        files = {
            "record.json": dump_json(record).encode(),
            "sheet.html": print_html(record, language=language).encode(),
        }
        if not no_pdf:
            files["sheet.pdf"] = print_pdf(record, language=language)
        for number, move in enumerate(found.moves, start=1):
            name = "setpoint.csv" if number == 1 else f"setpoint-{number}.csv"
            cycle = found.tuned.controller.position_cycle
            files[name] = setpoint_csv(move.setpoint, step=cycle).encode()
    write_files(output, files)
    show(summarise(record, language=language))
    sys.stdout.write("written: " + ", ".join(str(output / name) for name in files) + "\n")
    _finish(record)


@app.command()
def check(
    profile: Annotated[
        Path | None, typer.Argument(metavar="PROFILE", help="Machine profile (TOML).")
    ] = None,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON schema of profiles instead.")
    ] = False,
) -> None:
    """Validate a profile; print modes, rigid-body limits and warnings."""
    if schema:
        from mtcommission.profile import profile_schema

        sys.stdout.write(profile_schema().rstrip() + "\n")
        return
    if profile is None:
        raise InputError([Fault(where="check", message="got no profile; give a TOML file")])
    from mtcommission.plant import build_plant
    from mtcommission.profile import read_profile
    from mtcommission.terminal import describe_machine, show

    machine = read_profile(profile)
    show(describe_machine(machine, build_plant(machine), _warnings(machine)))


@app.command()
def optimal(
    profile: ProfileArgument,
    kind: Annotated[str, typer.Option("--kind", metavar="time|damping", help="What to minimise.")],
    t_f: Annotated[
        str, typer.Option("--t-f", metavar="S", help="Final time (damping), e.g. 52.2ms.")
    ] = "",
    limit: Annotated[
        list[str] | None,
        typer.Option("--limit", metavar="NAME=VALUE", help="E.g. v_phi=5mrad/s; repeatable."),
    ] = None,
    f_max: ForceOption = "",
    velocity_step: Annotated[
        str, typer.Option("--velocity-step", metavar="V", help="Move instead of the profile's.")
    ] = "",
    distance: Annotated[
        str, typer.Option("--distance", metavar="L", help="Move instead of the profile's.")
    ] = "",
    move: Annotated[
        int, typer.Option("--move", metavar="N", help="Which of the profile's moves.")
    ] = 1,
    method: Annotated[
        str, typer.Option("--method", metavar="exact|transcription", help="Way of solving.")
    ] = "exact",
    scheme: Annotated[
        str, typer.Option("--scheme", metavar="NAME", help="Transcription: euler or gauss.")
    ] = "gauss",
    intervals: Annotated[
        int, typer.Option("--intervals", metavar="N", help="Transcription: intervals.")
    ] = 1000,
    json_file: JsonOption = "",
    csv_file: CsvOption = "",
) -> None:
    """Compute one optimal control."""
    from time import perf_counter

    from mtcommission.files import motion_csv, write_text
    from mtcommission.options import OptimalRequest, read_optimal_request, solve
    from mtcommission.plant import build_plant
    from mtcommission.record.files import dump_json
    from mtcommission.record.optima import optimum_entry
    from mtcommission.terminal import describe_optimum, show

    machine = _read(profile, f_max)
    plant = build_plant(machine)
    request: OptimalRequest = read_optimal_request(
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
    )
    with _progress() as progress:
        progress(f"{kind}-optimal control")
        begun = perf_counter()
        solution = solve(machine, plant, request)
        elapsed = perf_counter() - begun
    entry = {**optimum_entry(plant, solution), "solve_time": elapsed}
    entry.pop("series")
    if json_file:
        write_text(json_file, dump_json(entry))
    if csv_file:
        write_text(csv_file, motion_csv(plant, solution))
    if "-" not in (json_file, csv_file):
        show(describe_optimum(machine, plant, solution))


@app.command()
def limits(profile: ProfileArgument, f_max: ForceOption = "", json_file: JsonOption = "") -> None:
    """Recommend acceleration and jerk; rules of thumb beside them."""
    from mtcommission.files import write_text
    from mtcommission.record.files import dump_json
    from mtcommission.record.limits import limits_part
    from mtcommission.terminal import describe_limits, show

    found = _compute(profile, f_max)
    if json_file:
        write_text(json_file, dump_json(limits_part(found)))
    if json_file != "-":
        met = found.assessment.is_met
        show(describe_limits(found.machine, limits_part(found), met=met))
    raise typer.Exit(0 if found.assessment.is_met else 1)


@app.command()
def simulate(
    profile: ProfileArgument,
    acceleration: Annotated[str, typer.Option("--acceleration", metavar="A", help="E.g. 2m/s^2.")],
    jerk: Annotated[str, typer.Option("--jerk", metavar="J", help="E.g. 100m/s^3.")],
    f_max: ForceOption = "",
    json_file: JsonOption = "",
    csv_file: CsvOption = "",
) -> None:
    """Run one setpoint through the loop and judge it."""
    from mtcommission.files import response_csv, write_text
    from mtcommission.loop_choice import Settings, settle_on_loop
    from mtcommission.optima import require_force
    from mtcommission.options import read_limits
    from mtcommission.plant import build_plant
    from mtcommission.record.files import dump_json
    from mtcommission.record.moves import simulation_part
    from mtcommission.terminal import describe_simulation, show
    from mtcommission.trials import run_moves

    machine = _read(profile, f_max)
    chosen = read_limits(machine, acceleration=acceleration, jerk=jerk)
    require_force(machine)
    plant = build_plant(machine)
    with _progress() as progress:
        progress("feedback loop")
        tuned = settle_on_loop(machine, plant, Settings()).tuned
        progress("response")
        moves = run_moves(machine, tuned, chosen)
    part = simulation_part(machine, plant, tuned, moves)
    if json_file:
        write_text(json_file, dump_json(part))
    if csv_file:
        write_text(csv_file, response_csv(plant, moves[0]))
    if "-" not in (json_file, csv_file):
        show(describe_simulation(machine, part))
    raise typer.Exit(0 if part["assessment"]["met"] else 1)


@app.command()
def sweep(
    profile: ProfileArgument,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder.")],
    f_max: Annotated[
        str, typer.Option("--f-max", metavar="RANGE", help="E.g. 0.5kN:4kN:100, log:300:20e3:50.")
    ] = "",
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=RANGE", help="E.g. plant.slider_mass=600:900:7."),
    ] = None,
    cases: Annotated[
        Path | None, typer.Option("--cases", metavar="FILE", help="CSV: keys, then a case a line.")
    ] = None,
    paired: Annotated[
        bool, typer.Option("--paired", help="Ranges go together instead of each with each.")
    ] = False,
    quantity: Annotated[
        str, typer.Option("--quantity", metavar="optimal|limits|run", help="What to compute.")
    ] = "optimal",
    limit: Annotated[
        list[str] | None,
        typer.Option("--limit", metavar="NAME=VALUE", help="For optimal, e.g. v_phi=5mrad/s."),
    ] = None,
    move: Annotated[
        int, typer.Option("--move", metavar="N", help="Which of the profile's moves (optimal).")
    ] = 1,
    workers: Annotated[
        int, typer.Option("--workers", metavar="N", min=0, help="Processes; 0: one per core.")
    ] = 0,
    scheduler: Annotated[
        str, typer.Option("--scheduler", metavar="ADDRESS", help="Dask, e.g. tcp://host:8786.")
    ] = "",
    resume: Annotated[bool, typer.Option("--resume", help="Continue what is in DIR.")] = False,
) -> None:
    """Compute many cases; writes rows.parquet, rows.csv and sweep.html."""
    from mtcommission.options import read_optimal_request
    from mtcommission.plant import build_plant
    from mtcommission.sweep.engine import Engine, run_sweep
    from mtcommission.sweep.page import print_sweep
    from mtcommission.sweep.request import read_plan
    from mtcommission.sweep.table import read_table, summarise_table, write_safely, write_table

    machine = _read(profile, "")
    request = read_optimal_request(
        machine,
        build_plant(machine),
        kind="time",
        method="exact",
        t_f="",
        limits=limit or [],
        velocity_step="",
        distance="",
        move=move,
        scheme="gauss",
        intervals=1000,
    )
    plan = read_plan(
        profile,
        f_max=f_max,
        vary=vary or [],
        cases=cases,
        is_paired=paired,
        quantity=quantity,
        bounds=request.bounds,
        move=move,
        created=_now(),
    )
    engine = Engine(workers=workers or os.cpu_count() or 1, scheduler=scheduler)
    with _bar(plan.count) as progress:
        store = run_sweep(plan, folder=output, engine=engine, resume=resume, progress=progress)
    table = read_table(plan, store)
    write_table(table, output)
    page = print_sweep(plan, table, created=store.created)
    write_safely(output / "sweep.html", lambda file: file.write(page.encode()))
    summary = summarise_table(table)
    sys.stdout.write(summary.text + "\n")
    names = ("rows.parquet", "rows.csv", "sweep.html")
    sys.stdout.write("written: " + ", ".join(str(output / name) for name in names) + "\n")
    raise typer.Exit(0 if summary.is_met else 1 if summary.done else 3)


@app.command()
def sheet(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="record.json of a run.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder.")],
    compare: Annotated[
        Path | None,
        typer.Option("--compare", metavar="BEFORE", help="Earlier record.json: say what changed."),
    ] = None,
    language: LanguageOption = "en",
    no_pdf: Annotated[bool, typer.Option("--no-pdf", help="Leave the PDF out.")] = False,
) -> None:
    """Print the sheet again from the record alone."""
    from mtcommission.files import write_files
    from mtcommission.record.files import load_record
    from mtcommission.sheet import print_html, print_pdf

    loaded = load_record(record)
    before = load_record(compare) if compare else None
    try:
        with _progress() as progress:
            progress("sheet")
            files = {"sheet.html": print_html(loaded, language=language, before=before).encode()}
            if not no_pdf:
                files["sheet.pdf"] = print_pdf(loaded, language=language, before=before)
    except KeyError as error:
        message = (
            f"this record lacks {error}: another version of mtcommission wrote it; "
            "run the profile again, or print it with that version"
        )
        raise InputError([Fault(where=str(record), message=message)]) from error
    write_files(output, files)
    sys.stdout.write("written: " + ", ".join(str(output / name) for name in files) + "\n")
    _finish(loaded)


@app.command()
def export(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="record.json of a run.")],
    control: Annotated[
        str, typer.Option("--control", metavar="NAME", help="E.g. sinumerik; ? lists all.")
    ],
    output: Annotated[
        str, typer.Option("-o", "--output", metavar="FILE", help="- for the screen.")
    ] = "-",
    as_csv: Annotated[
        bool, typer.Option("--csv", help="Parameter list to tick off instead.")
    ] = False,
) -> None:
    """Write the limits in a control's own names, units and syntax: text, to be verified."""
    from mtcommission.export import control_keys, export_record, parameter_list
    from mtcommission.files import write_text
    from mtcommission.record.files import load_record

    if control.strip() == "?":
        sys.stdout.write("\n".join(control_keys()) + "\n")
        return
    found = export_record(load_record(record), control=control)
    write_text(output, parameter_list(found) if as_csv else found.text)
    raise typer.Exit(0 if found.meets_requirements else 1)


@app.command()
def validate(
    json_file: JsonOption = "",
    output: Annotated[
        str, typer.Option("-o", "--output", metavar="DIR", help="Write validation.html there.")
    ] = "",
) -> None:
    """Put the paper's numbers and claims beside ours; exit 1 if one is out of tolerance."""
    from mtcommission.files import write_files, write_text
    from mtcommission.record.files import dump_json
    from mtcommission.terminal import show
    from mtcommission.validate.page import print_validation
    from mtcommission.validate.report import validate as compare
    from mtcommission.validate.report import validation_entry
    from mtcommission.validate.table import describe_validation

    with _progress() as progress:
        found = compare(progress)
    if json_file:
        write_text(json_file, dump_json(validation_entry(found)))
    if output:
        page = print_validation(found, created=_now())
        write_files(Path(output), {"validation.html": page.encode()})
    if json_file != "-":
        show(describe_validation(found))
    raise typer.Exit(0 if found.is_met else 1)


@app.command()
def wizard(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="Profile to write or change.")
    ] = Path("machine.toml"),
    answers: Annotated[
        Path | None,
        typer.Option("--answers", metavar="FILE", help="Answers (TOML, the profile's own keys)."),
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Take defaults for what is open instead of asking.")
    ] = False,
    run_after: Annotated[bool, typer.Option("--run", help="Go on to run.")] = False,
) -> None:
    """Ask for the machine and write a commented profile."""
    from mtcommission.wizard import Ending, open_console, run_wizard

    session = run_wizard(
        output,
        console=open_console(),
        answers_file=answers,
        take_defaults=yes,
        offers_run=not run_after,
    )
    if session.ending is Ending.WRITTEN and (run_after or session.wants_run):
        run(profile=output)


profiles_app = typer.Typer(help="The example machines that come with the program.")
app.add_typer(profiles_app, name="profiles", no_args_is_help=True)


@profiles_app.command("list")
def list_profiles() -> None:
    """List the example machines with the source of their numbers."""
    from mtcommission.shipped import describe_shipped, read_shipped, shipped_names

    sys.stdout.write("".join(describe_shipped(read_shipped(name)) for name in shipped_names()))


@profiles_app.command("show")
def show_profile(
    name: Annotated[str, typer.Argument(metavar="NAME", help="From profiles list.")],
) -> None:
    """Print an example machine."""
    from mtcommission.shipped import read_shipped

    sys.stdout.write(read_shipped(name).text)


@profiles_app.command("copy")
def copy_profile(
    name: Annotated[str, typer.Argument(metavar="NAME", help="From profiles list.")],
    file: Annotated[str, typer.Argument(metavar="[FILE]", help="Default: NAME.toml here.")] = "",
) -> None:
    """Copy an example machine to start from; never overwrites a file."""
    from mtcommission.files import write_text
    from mtcommission.shipped import read_shipped

    found = read_shipped(name)
    target = file or f"{found.name}.toml"
    if target != "-" and Path(target).exists():
        raise InputError([Fault(where=target, message="exists already; give another name")])
    write_text(target, found.text)
    if target != "-":
        sys.stdout.write(f"written: {target}\n")


def _read(profile: Path, f_max: str) -> Machine:
    from mtcommission.options import with_force
    from mtcommission.profile import read_profile

    machine = read_profile(profile)
    return with_force(machine, f_max) if f_max else machine


def _compute(profile: Path, f_max: str) -> Commissioning:
    from mtcommission.commission import commission

    machine = _read(profile, f_max)
    with _progress() as progress:
        return commission(machine, progress=progress)


def _describe_profile(path: Path) -> Profile:
    from mtcommission.profile import profile_text_hash, read_profile_text
    from mtcommission.record.schema import Profile

    return Profile(
        name=path.name, sha256=profile_text_hash(path.read_bytes()), text=read_profile_text(path)
    )


def _now() -> str:
    """Date and time of the record; SOURCE_DATE_EPOCH fixes it for repeatable builds."""
    from datetime import UTC, datetime

    fixed = os.environ.get("SOURCE_DATE_EPOCH")
    moment = datetime.fromtimestamp(int(fixed), UTC) if fixed else datetime.now(UTC)
    return moment.isoformat(timespec="seconds")


def _finish(record: Record) -> NoReturn:
    raise typer.Exit(0 if record["assessment"]["met"] else 1)


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """Show the running stage on the error stream; silent where that is no terminal."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True).status("") as status:
        yield lambda stage: status.update(f"{stage} …")


@contextmanager
def _bar(total: int) -> Iterator[Callable[[int, int, int], None]]:
    """Show cases done, their rate, the remaining time and failures; silent when piped."""
    if not sys.stderr.isatty():
        yield lambda done, total, failures: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    layout = (
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]:.3g}/s"),
        TimeRemainingColumn(),
        TextColumn("{task.fields[failures]} failed"),
    )
    with Progress(*layout, console=Console(stderr=True)) as bar:
        task = bar.add_task("cases", total=total, rate=0.0, failures=0)
        yield lambda done, total, failures: bar.update(
            task, completed=done, rate=bar.tasks[0].speed or 0.0, failures=failures
        )


def _warnings(machine: Machine) -> list[str]:
    from mtcommission.plausibility import check_plausibility

    return [f"{remark.key}: {remark.message}" for remark in check_plausibility(machine)]
