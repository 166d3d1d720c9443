"""What a terminal of 80 columns shows: the frame; plain text when piped.

Every number is formatted by the sheet's formatter, so terminal, HTML and PDF agree. What is shown
of a machine, an optimal control and the results stands in modules of their own, since what they
describe loads slowly.
"""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console, RenderableType
from rich.table import Table
from rich.text import Text

from mtcommission.cli.language import words
from mtcommission.machine.machine import Machine, Motion
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message

WIDTH = 80


def show(content: RenderableType) -> None:
    """Print to standard output: styled on a terminal, plain when piped."""
    console = Console(highlight=False, emoji=False)
    if console.is_terminal and not console.width:  # COLUMNS=0, with which nothing would be shown
        console = Console(highlight=False, emoji=False, width=WIDTH)
    if not console.is_terminal:
        console = Console(highlight=False, emoji=False, width=WIDTH, no_color=True)
    console.print(content)


def warn(spoken: Catalogue, warnings: Sequence[Message | str]) -> list[Text]:
    """Return a line for each warning."""
    lines = [spoken.text("warning", warning=spoken.say(line)) for line in warnings]
    return [Text(line, style="yellow") for line in lines]


def heading(text: str) -> Text:
    """Return a heading."""
    return Text(text, style="bold")


WORD = 19
"""Width that no word of a first column exceeds in either language.

The width is fixed since rich narrows a column below its least width, then cuts the last columns.
"""


def empty_table(spoken: Catalogue, *columns: str) -> Table:
    """Return a table with these columns; their headings are texts of the catalogue."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for number, column in enumerate(columns):
        head = spoken.text(f"terminal-head-{column}")
        table.add_column(head, overflow="fold", width=None if number else WORD)
    return table


def words_for(machine: Machine) -> Catalogue:
    """Return the catalogue of the chosen language for a machine's kind of axis."""
    return words(rotary=machine.motion is Motion.ROTARY)
