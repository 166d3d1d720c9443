"""Heads of columns: name and unit, and the words that names are made of."""

from __future__ import annotations

import re

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
