"""The part of a page that answers back, as its template and its script want it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Pair = tuple[str, str]
"""Key in the script, and what is said."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """What can be moved: a slider and an entry beside it.

    Parameters
    ----------
    key, label, unit
        For the script, and in words.
    size
        One unit in SI.
    low, high
        Ends of the slider [SI].
    least, most
        What may be entered [SI].
    value
        To begin with [SI].
    log
        Whether the slider moves by factors.
    """

    key: str
    label: str
    unit: str
    size: float
    low: float
    high: float
    least: float
    most: float
    value: float
    log: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """Texts of the template by their key, what can be moved, and all that the script computes with.

    Parameters
    ----------
    texts
        By key.
    moves, columns, margin_columns
        Names.
    filters, rows, margin_rows
        Keys and names.
    fields
        What can be moved.
    follows
        Whether the motor follows its setpoint, so that there is no loop to show.
    data
        For the script, as JSON.
    """

    texts: Mapping[str, str]
    moves: tuple[str, ...]
    columns: tuple[str, ...]
    margin_columns: tuple[str, ...]
    filters: tuple[Pair, ...]
    rows: tuple[Pair, ...]
    margin_rows: tuple[Pair, ...]
    fields: tuple[Field, ...]
    follows: bool
    data: Mapping[str, Any]
