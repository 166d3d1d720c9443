"""Commands about the machine itself: wizard, check, and the example machines."""

from __future__ import annotations

import sys
from pathlib import Path

from mtcommission.base.errors import InputError
from mtcommission.base.files import require_writable, write_text
from mtcommission.base.messages.message import Message
from mtcommission.cli.arguments import LANGUAGE, argument, flag, option, read_machine
from mtcommission.cli.compute import run
from mtcommission.cli.language import words
from mtcommission.cli.terminal import print_written, show


def wizard(
    output: Path = option(
        "-o --output", "FILE", "Profile to write or change.", Path("machine.toml")
    ),
    answers: Path | None = option(
        "--answers", "FILE", "Answers (TOML, the profile's own keys).", None
    ),
    yes: bool = flag("--yes", "Take defaults for what is open instead of asking."),
    run_after: bool = flag("--run", "Go on to run."),
    language: str = LANGUAGE,
) -> None:
    """Ask for the machine and write a commented profile."""
    from mtcommission.wizard import Ending, open_console, run_wizard

    require_writable(str(output), inputs=[answers] if answers else [])
    ending = run_wizard(
        output,
        console=open_console(),
        answers_file=answers,
        take_defaults=yes,
        offers_run=not run_after,
        language=language,
    )
    if ending is Ending.TO_RUN or (run_after and ending is Ending.WRITTEN):
        run(output, Path("commissioning"), "", language, False, "", False)


def check(
    profile: Path | None = argument("PROFILE", "Machine profile (TOML).", None),
    schema: bool = flag("--schema", "Print the JSON schema of profiles instead."),
    language: str = LANGUAGE,
) -> None:
    """Validate a profile; print modes, rigid-body limits and warnings."""
    if schema:
        from mtcommission.machine.profile.describe import profile_schema

        sys.stdout.write(profile_schema().rstrip() + "\n")
        return
    if profile is None:
        raise InputError.at("check", Message("cli-no-profile"))
    from mtcommission.cli.machine_view import describe_machine
    from mtcommission.machine.checks import check_plausibility
    from mtcommission.machine.plant.plant import build_plant
    from mtcommission.record.machine import list_assumed
    from mtcommission.setpoint.duration import require_short_moves

    machine, source = read_machine(profile)
    warnings: list[Message | str] = list(check_plausibility(machine))
    if not machine.control.leaves_all_to_rules:
        from mtcommission.loop.tuning.tuning import check_loop  # its libraries load slowly

        warnings += check_loop(machine)
    plant = build_plant(machine)
    assumed = list_assumed(machine, plant, source.text, words())
    show(describe_machine(machine, plant, warnings, assumed, words()))
    require_short_moves(machine)


def list_profiles(
    language: str = LANGUAGE,
) -> None:
    """List the example machines with the source of their numbers."""
    from mtcommission.machine.profile.shipped import describe_shipped, read_shipped, shipped_names

    shipped = map(read_shipped, shipped_names())
    sys.stdout.write("".join(describe_shipped(one, words()) for one in shipped))


def show_profile(
    name: str = argument("NAME", "From profiles list."),
    language: str = LANGUAGE,
) -> None:
    """Print an example machine."""
    from mtcommission.machine.profile.shipped import read_shipped

    sys.stdout.write(read_shipped(name).text)


def copy_profile(
    name: str = argument("NAME", "From profiles list."),
    file: str = argument("FILE", "Default: NAME.toml here.", ""),
    language: str = LANGUAGE,
) -> None:
    """Copy an example machine to start from; never overwrites a file."""
    from mtcommission.machine.profile.shipped import read_shipped

    found = read_shipped(name)
    target = file or f"{found.name}.toml"
    if target != "-" and Path(target).exists():
        raise InputError.at(target, Message("cli-file-exists"))
    write_text(target, found.text)
    if target != "-":
        print_written(Path(target))
