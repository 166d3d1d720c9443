"""The command line: ``machines``, ``measured``, ``compute``, ``records``.

Each command is a few lines: read the input, call one verb, write the result. Heavy imports sit
inside the commands, so that ``--help`` answers at once.
"""

from __future__ import annotations

import gc
import os
import sys
from shutil import get_terminal_size
from textwrap import fill
from typing import NoReturn

import typer

from mtcommission.base import __version__
from mtcommission.base.errors import INTERRUPTED, MtcommissionError
from mtcommission.base.process import end_as_if_by_keyboard, now
from mtcommission.cli.arguments import LANGUAGE, flag
from mtcommission.cli.compute import group, limits, optimal, run, simulate, sweep, validate
from mtcommission.cli.language import (
    SpokenCommand,
    SpokenGroup,
    UsageError,
    choose,
    describe_usage,
    find_language,
    say,
    words,
)
from mtcommission.cli.machines import check, copy_profile, list_profiles, show_profile, wizard
from mtcommission.cli.measured import identify, verify
from mtcommission.cli.records import export, sheet

EXIT_CODES = (
    "Exit codes: 0 done and all requirements met, 1 a requirement is not met, 2 wrong input, "
    "3 a computation ended with a named outcome, 130 interrupted by Ctrl-C."
)

LONGEST_ERROR = 500
"""Letters: an error of encoding holds the whole text."""

ALLOCATIONS = 1_000_000
"""Objects made, less those freed, between two searches for garbage (empirical: Python's 700 cost 3
to 4 % of the time of ``run``, for nearly all that is loaded and computed lives to the end)."""

app = typer.Typer(
    name="mtcommission",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    epilog=EXIT_CODES,
    cls=SpokenGroup,
)
for command in (
    wizard,
    identify,
    check,
    run,
    limits,
    optimal,
    simulate,
    group,
    export,
    sheet,
    verify,
    sweep,
    validate,
):
    app.command(cls=SpokenCommand)(command)

profiles = typer.Typer(cls=SpokenGroup)
profiles.command("list", cls=SpokenCommand)(list_profiles)
profiles.command("show", cls=SpokenCommand)(show_profile)
profiles.command("copy", cls=SpokenCommand)(copy_profile)


@profiles.callback()
def start_profiles(
    language: str = LANGUAGE,
) -> None:
    """The example machines that come with the program."""


app.add_typer(profiles, name="profiles", no_args_is_help=True)


def main() -> NoReturn:
    """Run the command line; every error becomes a message and an exit code."""
    # Matrices here have some ten rows: threads cost more than they give, and with their number the
    # order of summation would change, so the last digits of a record.
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    if not os.environ.get("SOURCE_DATE_EPOCH"):
        os.environ.pop("SOURCE_DATE_EPOCH", None)  # empty is unset; a library wants a number
    gc.set_threshold(ALLOCATIONS)
    _open_closed_streams()
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(encoding="utf-8", errors="replace")
    if hasattr(sys.stdin, "reconfigure"):
        # Bytes of another encoding must reach the question that they answer, to be refused there.
        sys.stdin.reconfigure(errors="surrogateescape")
    choose(find_language(sys.argv[1:], os.environ))
    try:
        now()  # numpy reads a wrong SOURCE_DATE_EPOCH, too, but does not say what is wrong
        with end_as_if_by_keyboard():
            code = app(standalone_mode=False, prog_name="mtcommission")
    except MtcommissionError as error:
        _fail(error.text(words()), error.exit_code)
    except UsageError as error:
        is_help = type(error).__name__ == "NoArgsIsHelpError"
        _fail(str(error) if is_help else words().say(describe_usage(error)), 2)
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED
    except BrokenPipeError:
        os._exit(0)  # the reader of our output has gone: nobody to tell
    except OSError as error:
        _fail(f"{error.filename or say('cli-file-system')}: {error.strerror or error}", 2)
    except Exception as error:
        _fail(say("cli-internal-error", error=repr(error)[:LONGEST_ERROR]), 3)
    if code == INTERRUPTED:  # typer has met Ctrl-C, and says nothing
        _fail(say("cli-interrupted"), INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _open_closed_streams() -> None:
    """Lead closed standard streams nowhere, else the first file that is opened becomes one."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) < 3:
        pass
    os.close(descriptor)
    sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def _fail(message: str, code: int) -> NoReturn:
    # A pipe gets a line for each fault; a terminal would break it inside words.
    if sys.stderr.isatty():
        width = max(40, get_terminal_size().columns - 1)
        message = "\n".join(
            fill(line, width, subsequent_indent="    ", break_on_hyphens=False)
            for line in message.splitlines()
        )
    sys.stderr.write(message + "\n")
    sys.exit(code)


def _print_version(wanted: bool) -> None:
    if wanted:
        sys.stdout.write(f"mtcommission {__version__}\n")
        raise typer.Exit


@app.callback()
def start(
    version: bool = flag("--version", "Version.", callback=_print_version, is_eager=True),
    language: str = LANGUAGE,
) -> None:
    """Acceleration and jerk limits for machine tool axes, from the mechanical model.

    From a data sheet to values for the control: wizard, run, export.
    """
