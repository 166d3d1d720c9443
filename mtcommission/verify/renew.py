"""Refined parameters -> the profile they change; every other line of it stays."""

from __future__ import annotations

from typing import Any

import tomlkit

from mtcommission.machine.keys import list_quantities
from mtcommission.messages.catalogue import Catalogue
from mtcommission.profile.read import parse_profile
from mtcommission.verify.refine import Parameter, Refined


def renew_profile(text: str, refined: Refined, *, words: Catalogue, date: str) -> str:
    """Return the text of the record's profile with the parameters that the traces show.

    A kind of plant whose keys state no frequencies gets those values that give the new ones.
    ``words``: language of the comments; ``date``: day, ISO 8601.

    Raises
    ------
    InputError
        The new values make no profile.
    """
    document = tomlkit.parse(text)
    drive: Any = document["drive"]
    changed = [one for one in refined.parameters if one.has_changed]
    for one in changed:
        if one.key in ("coulomb_friction", "viscous_friction"):
            _set(drive, one.key, one.new.value, one.unit, _say(one, words))
    before, after = parse_profile(text, where="record"), refined.machine
    old, new = (
        list(list_quantities(one.mechanics, "plant", one.axis_units)) for one in (before, after)
    )
    for (key, value, unit), (_, was, _) in zip(new, old, strict=True):
        if _written(value, unit) == _written(was, unit):
            continue
        *above, own = key.split(".")
        table: Any = document
        for name in above:
            table = _element(table, name)
        stated = [one for one in changed if _states(key, value, one, after.mechanics.moving_mass)]
        comment = _say(stated[0], words) if stated else words.text("verify-renewed-derived")
        _set(table, own, value, unit, comment)
    head = tomlkit.document()
    head.add(tomlkit.comment(words.text("verify-renewed-head", date=date)))
    renewed = tomlkit.dumps(head) + tomlkit.dumps(document)
    parse_profile(renewed, where="--refine")
    return renewed


def _states(key: str, value: float, one: Parameter, mass: float) -> bool:
    """Whether a key of the profile states a parameter itself."""
    return (
        key.endswith(f".{one.mode}.{one.key}") if one.mode else one.key == "mass" and value == mass
    )


def _element(table: Any, name: str) -> Any:
    """What stands below a key, or the element of an array with this name."""
    if isinstance(table, dict):
        return table[name]
    return next(one for one in table if str(one["name"]) == name)


def _set(table: Any, key: str, value: float, unit: str, comment: str) -> None:
    item = tomlkit.item(_written(value, unit))
    item.comment(comment)
    table[key] = item


def _written(value: float, unit: str) -> str | float:
    return float(f"{value:.4g}") if unit in ("", "-") else f"{value:.6g} {unit}"


def _say(one: Parameter, words: Catalogue) -> str:
    error = f"{2.0 * one.new.sigma:.2g} {one.unit}".rstrip()
    return words.text("verify-renewed", error=error)
