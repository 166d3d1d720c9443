"""What a terminal shows while something is computed (a pipe sees nothing of it), and after it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mtcommission.cli.language import say, words
from mtcommission.messages.message import Message

if TYPE_CHECKING:
    from mtcommission.limits.judge import Candidate
    from mtcommission.machine.machine import Machine


@contextmanager
def show_stage() -> Iterator[Callable[[Message | str], None]]:
    """Show the running stage on the error stream; silent where that is no terminal."""
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    from rich.console import Console

    with Console(stderr=True, emoji=False).status("") as status:
        yield lambda stage: status.update(f"{words().say(stage)} …")


def announce_limits(machine: Machine) -> Callable[[Candidate], None]:
    """Return what says verdict and limits on the error stream; silent where that is no terminal."""

    def announce(best: Candidate) -> None:
        if sys.stderr.isatty():
            from mtcommission.cli.terminal import words_for
            from mtcommission.glance import say_verdict

            sys.stderr.write(f"{say_verdict(machine, best, words_for(machine))}\n")
            sys.stderr.flush()

    return announce


@contextmanager
def show_bar(total: int) -> Iterator[Callable[[int, int, int], None]]:
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
        TextColumn("{task.fields[failed]}"),
    )
    with Progress(*layout, console=Console(stderr=True, emoji=False)) as bar:
        task = bar.add_task("", total=total, rate=0.0, failed="")
        yield lambda done, total, failures: bar.update(
            task,
            completed=done,
            rate=bar.tasks[0].speed or 0.0,
            failed=say("cli-failed-cases", count=failures),
        )


def print_note(note: Message) -> None:
    """Say on the error stream what the user must know while something is computed."""
    sys.stderr.write(words().say(note) + "\n")


def print_written(folder: Path, names: Iterable[str] = ("",)) -> None:
    """Say which files were written."""
    files = tuple(str(folder / name) for name in names)
    sys.stdout.write(say("cli-written", files=files) + "\n")
