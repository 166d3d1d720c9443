"""What an export is made of: parameters in a control's own words, and how they are laid out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from mtcommission.export.gains import NO_GAINS, GainUnits
from mtcommission.export.modes import Values
from mtcommission.export.rounding import Coding
from mtcommission.export.subject import Subject
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One parameter to be typed in.

    Parameters
    ----------
    name
        As the control spells it.
    value, unit
        Number and the control's unit.
    meaning
        What it limits, in a few words; None where the name says it.
    section
        Where it stands in a structured file, parts separated by "/".
    is_verified
        Whether name and unit were read in a maker's text or source file.
    """

    name: str
    value: str
    unit: str
    meaning: Message | None
    section: str = ""
    is_verified: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Parameters that belong together.

    Parameters
    ----------
    title
        None for the recommendation itself, else what the alternative is.
    entries
        In the order of entry.
    notes
        Sentences about them.
    """

    title: Message | None
    entries: tuple[Entry, ...]
    notes: tuple[Message, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """A control and how it takes limits.

    Parameters
    ----------
    key
        For ``--control``; one of ``catalogue.CONTROL_KEYS``.
    coding
        How limits are stored.
    describe
        The parameters for typed limits.
    layout
        The parameters in the control's syntax, as lines, with remarks in a language.
    comment
        A line of text as a comment of that syntax.
    gains
        Units of the gains that are exported with the limits.
    has_modes
        Whether it takes limits by machining mode.
    in_degrees
        Whether its angles are degrees, not radians.
    alternatives
        Further blocks, e.g. with the control's jerk filter.
    notes
        Sentences for the header: what the control itself adds, and what to mind.
    """

    key: str
    coding: Callable[[Subject], Coding]
    describe: Callable[[Subject, Values], tuple[Entry, ...]]
    layout: Callable[[Sequence[Entry], Catalogue], list[str]]
    comment: Callable[[str], str]
    gains: GainUnits = NO_GAINS
    has_modes: bool = False
    in_degrees: bool = True
    alternatives: Callable[[Subject, Values], tuple[Block, ...]] = lambda _subject, _values: ()
    notes: Callable[[Subject, Values], tuple[Message, ...]] = lambda _subject, _values: ()


BLANK = "__________"
"""Room for the old value, to be filled in by hand."""

DOUBT = "(?)"
"""Mark of what was not read in a maker's text; the header says what it means."""


def say_meaning(entry: Entry, words: Catalogue) -> str:
    """Return what a parameter limits, or nothing."""
    return words.say(entry.meaning) if entry.meaning else ""


def remark(entry: Entry, words: Catalogue) -> str:
    """Return unit, room for the old value and meaning of a parameter, for a comment."""
    doubt = "" if entry.is_verified else f" {DOUBT}"
    unit = f"[{entry.unit}] " if entry.unit else ""
    return f"{unit}{words.text('export-old')}: {BLANK}  {say_meaning(entry, words)}{doubt}"


def line_layout(
    pattern: str, comment: Callable[[str], str], entries: Sequence[Entry], words: Catalogue
) -> list[str]:
    """Return one line for each parameter, with its remark behind it.

    Parameters
    ----------
    pattern
        With fields ``name`` and ``value``.
    comment
        A text as a comment.
    entries
        The parameters.
    words
        Of the remarks.

    Returns
    -------
    list of str
    """
    heads = [pattern.format(name=entry.name, value=entry.value) for entry in entries]
    width = max(map(len, heads))
    return [
        f"{head:<{width}}  {comment(remark(entry, words))}"
        for head, entry in zip(heads, entries, strict=True)
    ]


def table_layout(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    """Return a table for entry by hand: parameter, new value, unit, old value, meaning."""
    head = Entry(
        name=words.text("export-head-parameter"),
        value=words.text("export-head-new-value"),
        unit=words.text("export-head-unit"),
        meaning=Message("export-head-meaning"),
    )
    names, values, units = (
        max(len(getattr(entry, field)) for entry in (head, *entries))
        for field in ("name", "value", "unit")
    )
    lines = []
    for entry in (head, *entries):
        old = words.text("export-head-old-value") if entry is head else BLANK
        doubt = "" if entry.is_verified else f" {DOUBT}"
        lines.append(
            f"{entry.name:<{names}} | {entry.value:>{values}} | {entry.unit:<{units}} | "
            f"{old:<{len(BLANK)}} | {say_meaning(entry, words)}{doubt}"
        )
    lines.insert(1, "-" * max(map(len, lines)))
    return lines


def ini_layout(mark: str, entries: Sequence[Entry], words: Catalogue) -> list[str]:
    """Return sections with one parameter per line; remarks stand on lines of their own.

    Parameters
    ----------
    mark
        Between name and value, with its blanks.
    entries
        The parameters; their section is the header in brackets.
    words
        Of the remarks.

    Returns
    -------
    list of str
    """
    lines: list[str] = []
    for section in dict.fromkeys(entry.section for entry in entries):
        lines.append(f"[{section}]")
        for entry in entries:
            if entry.section == section:
                lines += [hash_comment(remark(entry, words)), f"{entry.name}{mark}{entry.value}"]
        lines.append("")
    return lines[:-1]


def yaml_layout(entries: Sequence[Entry], words: Catalogue) -> list[str]:
    """Return nested mappings, one level for each part of the section."""
    lines: list[str] = []
    open_parts: list[str] = []
    for entry in entries:
        parts = entry.section.split("/")
        shared = 0
        while shared < min(len(parts), len(open_parts)) and parts[shared] == open_parts[shared]:
            shared += 1
        lines += [f"{'  ' * i}{part}:" for i, part in enumerate(parts) if i >= shared]
        open_parts = parts
        indent = "  " * len(parts)
        lines.append(f"{indent}{entry.name}: {entry.value}  {hash_comment(remark(entry, words))}")
    return lines


def semicolon_comment(text: str) -> str:
    """Return a comment of G-code and machine data files."""
    return f"; {text}".rstrip()


def hash_comment(text: str) -> str:
    """Return a comment of INI, YAML and table files."""
    return f"# {text}".rstrip()


def bracket_comment(text: str) -> str:
    """Return a comment behind a value of an ISG list: everything from the parenthesis on."""
    return f"( {text}".rstrip()


def structured_text_comment(text: str) -> str:
    """Return a comment of IEC 61131-3 Structured Text."""
    return f"(* {text.replace('*)', '* )')} *)"


def unverified(entry: Entry) -> Entry:
    """Return the parameter marked as not verified."""
    return replace(entry, is_verified=False)
