"""Refined parameters -> the profile they change, every other line kept; its new limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import tomlkit

from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.keys import list_quantities
from mtcommission.machine.profile.read import parse_profile
from mtcommission.record.record import Record
from mtcommission.verify.refine import Parameter, Refined


def renew_profile(text: str, refined: Refined, *, words: Catalogue, date: str) -> str:
    """Return the text of the record's profile with the parameters that the traces show.

    A kind of plant whose keys state no frequencies gets those values that give the new ones.
    ``words``: language of the comments; ``date``: day, ISO 8601. Raises InputError where the new
    values make no profile.
    """
    document = tomlkit.parse(text)
    changed = [one for one in refined.parameters if one.has_changed]
    for one in changed:
        if one.key in ("coulomb_friction", "viscous_friction"):
            _set(document["drive"], one.key, one.new.value, one.unit, _say(one, words))
    before, after = parse_profile(text, where="record"), refined.machine
    old, new = (list_quantities(one.mechanics, "plant", one.axis_units) for one in (before, after))
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
    if one.mode:
        return key.endswith(f".{one.mode}.{one.key}")
    return one.key == "mass" and value == mass


def _element(table: Any, name: str) -> Any:
    """What stands below a key, or the element of an array with this name."""
    if isinstance(table, dict):
        return table[name]
    return next(one for one in table if str(one["name"]) == name)


def _set(table: Any, key: str, value: float, unit: str, comment: str) -> None:
    table[key] = tomlkit.item(_written(value, unit)).comment(comment)


def _written(value: float, unit: str) -> str | float:
    return float(f"{value:.4g}") if unit in ("", "-") else f"{value:.6g} {unit}"


def _say(one: Parameter, words: Catalogue) -> str:
    error = f"{2.0 * one.new.sigma:.2g} {one.unit}".rstrip()
    return words.text("verify-renewed", error=error)


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Acceleration and jerk, and the settling time of the slowest move in the worst corner [SI]."""

    acceleration: float
    jerk: float
    settling_time: float | None  # None: not settled
    met: bool  # whether all requirements are


@dataclass(frozen=True, slots=True, kw_only=True)
class NewLimits:
    """Old beside new; ``new`` None where ``failure`` says why there are none."""

    old: Limits
    new: Limits | None
    failure: Message | None


def find_new_limits(record: Record, profile: str) -> NewLimits:
    """Return what ``run`` recommends for a refined profile, beside what the record recommends."""
    from mtcommission.commission.commission import commission  # half of what verify would load

    best, new, failure = record.limits.recommended, None, None
    try:
        chosen = commission(parse_profile(profile, where="--refine")).recommended
        new = Limits(
            acceleration=chosen.limits.acceleration,
            jerk=chosen.limits.jerk,
            settling_time=chosen.settling_time,
            met=chosen.assessment.is_met,
        )
    except ComputationError as error:
        failure = Message("verify-no-limits", why=str(error))
    old = Limits(
        acceleration=best.acceleration,
        jerk=best.jerk,
        settling_time=best.settling_time,
        met=record.assessment.met,
    )
    return NewLimits(old=old, new=new, failure=failure)
