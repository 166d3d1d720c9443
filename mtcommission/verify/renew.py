"""Refined parameters -> the profile they change; every other line of it stays."""

from __future__ import annotations

from typing import Any

import tomlkit

from mtcommission.machine.keys import list_quantities
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.plant.modal import Modal
from mtcommission.profile.read import parse_profile
from mtcommission.verify.refine import Parameter, Refined


def renew_profile(text: str, refined: Refined, *, words: Catalogue, date: str) -> str:
    """Return a profile with the parameters that the traces show.

    Parameters
    ----------
    text
        Of the record's profile.
    refined
        What has changed.
    words
        Language of the comments.
    date
        ISO 8601, day.

    Raises
    ------
    InputError
        The new values make no profile.
    """
    document = tomlkit.parse(text)
    plant: Any = document["plant"]
    drive: Any = document["drive"]
    changed = [one for one in refined.parameters if one.has_changed]
    for one in changed:
        comment = words.text("verify-renewed", error=_short(2.0 * one.new.sigma, one.unit))
        if one.key in ("coulomb_friction", "viscous_friction"):
            _set(drive, one.key, _quantity(one.new.value, one.unit), comment)
        elif isinstance(refined.machine.mechanics, Modal):
            _set_modal(plant, one, comment)
    if not isinstance(refined.machine.mechanics, Modal) and changed:
        _set_manipulator(plant, parse_profile(text, where="record"), refined.machine, words)
    head = tomlkit.document()
    head.add(tomlkit.comment(words.text("verify-renewed-head", date=date)))
    renewed = tomlkit.dumps(head) + tomlkit.dumps(document)
    parse_profile(renewed, where="--refine")
    return renewed


def _set_modal(plant: Any, one: Parameter, comment: str) -> None:
    if one.key == "mass":
        _set(plant, "moving_mass", _quantity(one.new.value, one.unit), comment)
        return
    table = next((mode for mode in plant["modes"] if str(mode["name"]) == one.mode), None)
    if table is None or one.key not in ("frequency", "damping_ratio"):
        return
    value = _quantity(one.new.value, one.unit) if one.unit else float(f"{one.new.value:.4g}")
    _set(table, one.key, value, comment)


def _set_manipulator(plant: Any, before: Machine, after: Machine, words: Catalogue) -> None:
    """Masses, stiffnesses and damping that give the new frequencies and damping ratios."""
    old, new = (
        list(list_quantities(one.mechanics, "plant", one.axis_units)) for one in (before, after)
    )
    for (key, value, unit), (_, was, _) in zip(new, old, strict=True):
        if value != was:
            own = key.rpartition(".")[2]
            _set(plant, own, _quantity(value, unit), words.text("verify-renewed-derived"))


def _set(table: Any, key: str, value: str | float, comment: str) -> None:
    item = tomlkit.item(value)
    item.comment(comment)
    table[key] = item


def _quantity(value: float, unit: str) -> str:
    return f"{value:.6g} {unit}"


def _short(value: float, unit: str) -> str:
    return f"{value:.2g} {unit}".rstrip()
