"""The numerical settings of a computation, one table for each kind, with their units."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.record import Record
from mtcommission.sheet.model import Table, name_and_numbers

UNITS: Mapping[str, str] = MappingProxyType(
    {
        "gain_margin_db": "dB",
        "phase_margin_deg": "°",
        "reserve_deg": "°",
        "position_noise": "m",
        "longest_integral_time": "s",
    }
)
"""SI units of the settings that have one; the others are counts or ratios, as their names say."""


def settings(record: Record, words: Catalogue) -> tuple[Table, ...]:
    """Return one table for each group of settings that the record names before the dot."""
    groups: dict[str, dict[str, float | str]] = {}
    for key, value in record.settings.items():
        group, _, name = key.rpartition(".")
        groups.setdefault(group, {})[name] = value
    return tuple(_table(names, [groups[name] for name in names], words) for names in _alike(groups))


def _alike(groups: Mapping[str, Mapping[str, object]]) -> list[list[str]]:
    """Return the names of the groups; those that share settings stand beside each other."""
    found: list[list[str]] = []
    for name, group in groups.items():
        for others in found:
            if set(group) & set(groups[others[0]]):
                others.append(name)
                break
        else:
            found.append([name])
    return found


def _table(names: list[str], groups: list[dict[str, float | str]], words: Catalogue) -> Table:
    text = words.text
    keys = list(dict.fromkeys(key for group in groups for key in group))
    heads = [words.known(f"settings-{name}", name) if name else text("value") for name in names]
    return Table(
        caption=text("settings-caption", names=", ".join(heads)),
        columns=name_and_numbers(text("setting"), heads, width=1.6),
        rows=tuple(
            (
                words.known(f"setting-{key.replace('_', '-')}", key),
                *(_shown(key, group.get(key), words) for group in groups),
            )
            for key in keys
        ),
    )


def _shown(key: str, value: float | str | None, words: Catalogue) -> str:
    """Return one number, or several that the record separates by commas; words as they are."""
    f = words.format
    if value is None:
        return "–"
    unit = UNITS.get(key, "")
    if not isinstance(value, str):
        return f.quantity(value, unit)
    try:
        return "; ".join(f.quantity(float(part), unit) for part in value.split(","))
    except ValueError:
        return value
