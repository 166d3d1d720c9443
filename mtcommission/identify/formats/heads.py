"""Heads of columns: name and unit, the words of a name, and which one ``--columns`` means."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from mtcommission.identify.formats.contents import refuse

CLOCK = "t"
SAMPLE_TIME = "sample_time"

_IN_BRACKETS = re.compile(r"^(?P<name>[^\[]*)\[(?P<unit>.*)\]\s*$")
_IN_PARENTHESES = re.compile(r"^(?P<name>[^(]*)\((?P<unit>.*)\)\s*$")
_AFTER_SLASH = re.compile(r"^(?P<name>.*\S)\s+(?:/|in)\s+(?P<unit>\S.*)$")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")


def split_head(head: str) -> tuple[str, str]:
    """Return name and unit of a column's head; "" where there is no unit.

    Examples
    --------
    >>> [split_head(head) for head in ("F [N]", "re [(m/s)/A]", "Kraft in N", "t / s", "x_ref")]
    [('F', 'N'), ('re', '(m/s)/A'), ('Kraft', 'N'), ('t', 's'), ('x_ref', '')]
    """
    for form in (_IN_BRACKETS, _IN_PARENTHESES, _AFTER_SLASH):
        if match := form.match(head.strip()):
            return match["name"].strip(), match["unit"].strip()
    return head.strip(), ""


def words_of(name: str) -> tuple[str, ...]:
    """Return the words of a name, in small letters.

    Examples
    --------
    >>> words_of("joint.0.motorPos-fb")
    ('joint', '0', 'motor', 'pos', 'fb')
    """
    spaced = _CAMEL.sub(" ", name)
    return tuple(re.findall(r"[a-zäöüßζγ²]+|[0-9]+", spaced.casefold()))


def find_column(names: Sequence[str], wanted: str) -> tuple[int, str | None]:
    """Return the place of a column that ``--columns`` names, and the unit that it gives it.

    Examples
    --------
    >>> find_column(["t", "pos"], "pos [mm]")
    (1, 'mm')
    """
    if wanted in names:
        return names.index(wanted), None
    name, unit = split_head(wanted)
    if name in names:
        return names.index(name), unit or None
    if name.isdigit() and 1 <= int(name) <= len(names):
        return int(name) - 1, unit or None
    found = tuple(f"{place}: {one or '?'}" for place, one in enumerate(names, start=1))
    raise refuse("--columns", "identify-no-column", got=wanted, found=found)


def find_columns(
    names: Sequence[str], said: Mapping[str, str], known: Collection[str]
) -> dict[int, tuple[str, str | None]]:
    """Return our name and the unit given for each column that ``--columns`` names, by its place."""
    found = {}
    for own, wanted in said.items():
        if own in (CLOCK, SAMPLE_TIME):
            continue
        if own not in known:
            raise refuse("--columns", "identify-no-such-name", got=own, names=tuple(known))
        place, unit = find_column(names, wanted)
        found[place] = (own, unit)
    return found
