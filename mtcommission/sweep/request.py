"""Options of the command line -> plan; every fault at once, before any work."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import chain, islice, product
from pathlib import Path

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import NUMBER
from mtcommission.commission.options import Options
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.lines import read_key
from mtcommission.machine.profile.read import parse_profile, read_profile_text
from mtcommission.sweep.case_table import load_cases
from mtcommission.sweep.plan import (
    FORCE_KEY,
    PEAKS_KEY,
    Axis,
    Plan,
    Quantity,
    Settings,
    read_axis,
    read_range,
    unit_of,
    vary_profile,
)

ACCELERATION_KEY = "drive.max_acceleration"
"""What --f-max varies where the motor follows its setpoint."""
MOST_COMPANIES = 64
"""Combinations that a refused value is tried in: some 10 ms each."""


def read_plan(
    profile: Path,
    *,
    f_max: str = "",
    vary: Sequence[str] = (),
    limits: Sequence[str] = (),
    cases: Path | None = None,
    is_paired: bool = False,
    quantity: str = "optimal",
    move: int = 1,
    created: str = "",
) -> Plan:
    """Return what ``sweep`` is asked for; F_max runs fastest, so that neighbours help each other.

    ``limits`` have a value or a range; they and ``move`` go with ``optimal`` only.

    Raises
    ------
    InputError
        With every fault found.
    """
    options = Options()
    text = read_profile_text(profile)
    machine = parse_profile(text, where=str(profile))
    plant = build_plant(machine)
    varied = [limit for limit in limits if ":" in limit or "," in limit]
    bounds = tuple(options.bound(plant, limit) for limit in limits if limit not in varied)
    readers = [partial(load_cases, cases)] if cases is not None else []
    readers += [partial(read_axis, item, where="--vary") for item in vary]
    readers += [partial(read_axis, PEAKS_KEY + item, where="--limit") for item in varied]
    if f_max:
        key = ACCELERATION_KEY if machine.drive.follows else FORCE_KEY
        readers.append(partial(_read_force, key, f_max))
    axes = []
    for read in readers:
        try:
            axes.append(read())
        except InputError as error:
            options.faults += error.faults
    options.word("--quantity", quantity, [item.value for item in Quantity])
    if quantity in (Quantity.LIMITS.value, Quantity.RUN.value):
        message = Message("sweep-taken-from-profile", quantity=quantity)
        for name, is_given in (("--limit", bool(limits)), ("--move", move != 1)):
            if is_given:
                options.refuse(name, message)
    options.move(machine, move)
    options.close()
    plan = Plan(
        profile_text=text,
        where=profile.name,
        axes=tuple(axes),
        is_paired=is_paired,
        quantity=Quantity(quantity),
        move=move,
        bounds=bounds,
        created=created,
    )
    check_plan(plan)
    faults = [fault for axis in plan.axes for fault in _wrong_values(plan, axis)]
    if faults:
        raise InputError(faults)
    return plan


def _read_force(key: str, text: str) -> Axis:
    return Axis(keys=(key,), rows=read_range(text, where="--f-max"), where="--f-max")


def check_plan(plan: Plan) -> None:
    """Raise InputError where axes share a key, or are paired and of different length."""
    twice = sorted({key for key in plan.keys if plan.keys.count(key) > 1})
    faults = [
        Fault(where="--vary", key=key, message=Message("sweep-varies-twice")) for key in twice
    ]
    if plan.is_paired and len({len(axis.rows) for axis in plan.axes}) > 1:
        got = tuple(f"{axis.keys[0]} {len(axis.rows)}" for axis in plan.axes)
        faults.append(Fault(where="--paired", message=Message("sweep-unequal-lengths", got=got)))
    if faults:
        raise InputError(faults)
    vary_profile(plan.profile_text, plan.settings(0), where=plan.where)


def _wrong_values(plan: Plan, axis: Axis) -> Iterator[Fault]:
    """Faults of keys and values that the profile's reader refuses.

    Of numbers with the same unit the ends speak for all between, since what a profile allows of
    one key is an interval. A value that is only wrong together with others, e.g. a static load
    above the least of the forces that vary, is a row of its own.
    """
    for column, key in enumerate(axis.keys):
        for rows in _ends([row[column] for row in axis.rows]):
            refusals = ((row, _refusals(plan, axis, row, key)) for row in rows)
            row, refused = next((item for item in refusals if item[1]), (0, []))
            line = axis.lines[row] if axis.lines else 0
            for fault in refused:
                yield Fault(where=axis.where, line=line, key=key, message=fault.message)


def _ends(texts: Sequence[str]) -> list[list[int]]:
    """Places of the least and the largest number of each unit, and of every word."""
    by_unit: dict[str, list[int]] = {}
    for place, text in enumerate(texts):
        by_unit.setdefault(unit_of(text), []).append(place)
    found = []
    for group in by_unit.values():
        numbers = [
            (float(match[0]), place) for place in group if (match := NUMBER.match(texts[place]))
        ]
        found.append([min(numbers)[1], max(numbers)[1]] if numbers else group[:1])
    return found


def _refusals(plan: Plan, axis: Axis, row: int, key: str) -> list[Fault]:
    """What the profile's reader says against a value of a key, whatever the other keys are.

    Tried are nothing else that varies, and the ends of the other axes.
    """
    text = dict(zip(axis.keys, axis.rows[row], strict=True))[key]
    path = f"{read_key(key)}."
    refused: list[Fault] = []
    for others in _companies(plan, axis, row):
        settings = (*((one, value) for one, value in others if one != key), (key, text))
        try:
            varied = vary_profile(plan.profile_text, settings, where=plan.where)
            parse_profile(varied, where=plan.where)
            return []
        except InputError as error:
            of_key = [one for one in error.faults if one.key and path.startswith(f"{one.key}.")]
        if not of_key:
            return []
        refused = refused or of_key
    return refused


def _companies(plan: Plan, axis: Axis, row: int) -> Iterator[Settings]:
    yield ()
    if plan.is_paired:
        yield plan.settings(row)
        return
    rows = [axis.rows[row : row + 1] if other is axis else _outermost(other) for other in plan.axes]
    for met in islice(product(*rows), MOST_COMPANIES):
        pairs = (
            zip(other.keys, texts, strict=True) for other, texts in zip(plan.axes, met, strict=True)
        )
        yield tuple(chain.from_iterable(pairs))


def _outermost(axis: Axis) -> list[tuple[str, ...]]:
    columns = zip(*axis.rows, strict=True)
    places = {place for texts in columns for group in _ends(texts) for place in group}
    return [axis.rows[place] for place in sorted(places, reverse=True)]
