"""What a terminal of 80 columns shows: lines and tables; plain text when piped.

Every number is formatted by the sheet's formatter, so terminal, HTML and PDF agree. What is shown
of a machine, an optimal control and the results stands in modules of their own, since what they
describe loads slowly.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain, repeat, zip_longest
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING

from mtcommission.base.messages.message import Message, Value, printable
from mtcommission.base.units.quantities import wrap_whole
from mtcommission.cli.language import say, words

if TYPE_CHECKING:
    from mtcommission.base.messages.catalogue import Catalogue
    from mtcommission.limits.judge import Candidate
    from mtcommission.machine.machine import Machine
    from mtcommission.sheet.document import Table
    from mtcommission.sheet.tables import Quantity

WIDTH = 80
GAP = "  "

Line = str | tuple[str, str]
"""What stands in a paragraph of its own, and in which of rich's styles."""


def show(lines: Iterable[Line]) -> None:
    """Print to standard output: styled on a terminal, plain when piped."""
    if not sys.stdout.isatty():
        sys.stdout.write("".join(f"{line}\n" for line in fold(lines)))
        return
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False, emoji=False)
    if not console.width:  # COLUMNS=0, with which nothing would be shown
        console.width = WIDTH
    for line in lines:
        text, style = (line, "") if isinstance(line, str) else line
        for one in fold([text]):
            # A Text is never read as markup, whatever the machine is called.
            console.print(Text(one), style=style, soft_wrap=True)


def fold(lines: Iterable[Line]) -> list[str]:
    """Return lines as long as the terminal is wide, none ending between a number and its unit."""
    found = list[str]()
    for line in lines:
        text = printable(line if isinstance(line, str) else line[0])
        found += [text] if len(text) <= columns() else wrap_whole(text, columns())
    return found


def columns() -> int:
    """Return the width of the terminal; 80 when piped."""
    return (get_terminal_size().columns if sys.stdout.isatty() else 0) or WIDTH


def describe_table(found: Table) -> list[Line]:
    """Return the rows of a table of the sheet."""
    rows = [[str(cell) for cell in row] for row in found.rows]
    return table([column.head for column in found.columns], rows)


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], styles: Iterable[str] = ()
) -> list[Line]:
    """Return the lines of a table; where it is too wide, its widest columns wrap.

    ``styles``: of each row, where they have any.
    """
    cells = [list(map(printable, row)) for row in (heads, *rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    while sum(widths) + len(GAP) * (len(widths) - 1) > columns():
        widths[widths.index(max(widths))] -= 1
    found = list[Line]()
    for row, style in zip(cells, chain(("bold",), styles, repeat("")), strict=False):
        wrapped = [wrap_whole(cell, width) for cell, width in zip(row, widths, strict=True)]
        for parts in zip_longest(*wrapped, fillvalue=""):
            padded = (f"{part:<{width}}" for part, width in zip(parts, widths, strict=True))
            found.append((GAP.join(padded).rstrip(), style))
    return found


def heads(spoken: Catalogue, *names: str) -> list[str]:
    """Return heads of columns: the terminal's own short ones, or the sheet's words."""
    return [spoken.own("terminal-head", name) for name in names]


def list_quantities(
    spoken: Catalogue,
    columns: Sequence[Quantity],
    items: Iterable[object],
    styles: Iterable[str] = (),
) -> list[Line]:
    """Return the lines of a table as the sheet has it, with the terminal's own short heads."""
    names = [
        spoken.known(f"terminal-head-{column.name}", column.head(spoken)) for column in columns
    ]
    rows = ([column.show(item, spoken) for column in columns] for item in items)
    return table(names, rows, styles)


def warn(spoken: Catalogue, warnings: Iterable[Message | str]) -> list[Line]:
    """Return a line for each warning."""
    return [(spoken.text("warning", warning=spoken.say(line)), "yellow") for line in warnings]


def heading(text: str) -> Line:
    """Return a heading."""
    return text, "bold"


def print_said(kind: str, **values: Value) -> None:
    """Say a text of the command line itself on standard output."""
    sys.stdout.write(say(kind, **values) + "\n")


def print_note(note: Message) -> None:
    """Say on the error stream what the user must know while something is computed."""
    sys.stderr.write(words().say(note) + "\n")


def print_written(folder: Path, names: Iterable[str] = ("",)) -> None:
    """Say which files were written."""
    show([say("cli-written", files=tuple(str(folder / name) for name in names))])


# While something is computed


class Stage:
    """Says what is computed, and what is known already, until the answer takes their place."""

    def __init__(self, show: Callable[[str], None] | None = None) -> None:
        self._show, self._known, self._now = show, "", ""

    def __call__(self, stage: Message | str) -> None:
        """Say which stage runs."""
        said = words().say(stage) if self._show else ""
        self._now = f"{said[:1].upper()}{said[1:]} …" if said else ""
        self._update()

    def announce(self, machine: Machine, best: Candidate) -> None:
        """Say verdict and limits, as soon as they are known."""
        if self._show:
            from mtcommission.commission.glance import say_verdict

            self._known = say_verdict(machine, best, words())
            self._update()

    def _update(self) -> None:
        if self._show:
            self._show("\n".join(filter(None, (self._known, self._now))))


@contextmanager
def show_stage() -> Iterator[Stage]:
    """Show the running stage on the error stream; silent where that is no terminal."""
    if not sys.stderr.isatty():
        yield Stage()
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True, emoji=False).status("") as status:
        yield Stage(lambda text: status.update(Text(text)))


@contextmanager
def show_bar(total: int) -> Iterator[Callable[[int, int, int], None]]:
    """Show cases done, their rate, the remaining time and failures; silent when piped."""
    if not sys.stderr.isatty():
        yield lambda done, total, failures: None
        return
    from rich import progress as rich
    from rich.console import Console

    layout = (
        rich.BarColumn(),
        rich.MofNCompleteColumn(),
        rich.TextColumn("{task.fields[rate]:.3g}/s"),
        rich.TimeRemainingColumn(),
        rich.TextColumn("{task.fields[failed]}"),
    )
    with rich.Progress(*layout, console=Console(stderr=True, emoji=False)) as bar:
        task = bar.add_task("", total=total, rate=0.0, failed="")
        yield lambda done, total, failures: bar.update(
            task,
            completed=done,
            rate=bar.tasks[0].speed or 0.0,
            failed=say("cli-failed-cases", count=failures),
        )
