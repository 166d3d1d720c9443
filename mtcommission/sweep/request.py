"""Options of the command line -> plan; every fault at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import islice, product
from pathlib import Path

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message
from mtcommission.options.optimal import read_bound
from mtcommission.options.texts import require_move, require_one_of
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile, read_profile_text
from mtcommission.sweep.case_table import load_cases
from mtcommission.sweep.cases import (
    FORCE_KEY,
    PEAKS_KEY,
    Axis,
    Plan,
    Quantity,
    Settings,
    check_plan,
    plain_key,
    read_axis,
    read_range,
    unit_of,
    vary_profile,
)
from mtcommission.units.quantities import NUMBER

MOST_COMPANIES = 64
"""Combinations that a refused value is tried in: some 10 ms each."""


def read_plan(
    profile: Path,
    *,
    f_max: str,
    vary: Sequence[str],
    limits: Sequence[str],
    cases: Path | None,
    is_paired: bool,
    quantity: str,
    move: int,
    created: str,
) -> Plan:
    """Return what ``sweep`` is asked for; F_max runs fastest, so that neighbours help each other.

    Parameters
    ----------
    profile
        The machine as it is.
    f_max, vary, cases, is_paired, quantity
        Of the options; "" or None where one is not given.
    limits, move
        For ``optimal``; anything else refuses them. A limit has a value or a range.
    created
        Date, ISO 8601.

    Raises
    ------
    InputError
        With every fault found.
    """
    faults: list[Fault] = []
    text = read_profile_text(profile)
    machine = parse_profile(text, where=str(profile))
    plant = build_plant(machine)
    fixed, varied = split_limits(limits)
    bounds = tuple(read_bound(plant, limit, faults) for limit in fixed)
    bound = ACCELERATION_KEY if machine.drive.follows else FORCE_KEY
    found = _read_axes(bound, f_max=f_max, vary=vary, limits=varied, cases=cases, faults=faults)
    require_one_of("--quantity", quantity, [item.value for item in Quantity], faults)
    if quantity in (Quantity.LIMITS.value, Quantity.RUN.value):
        message = Message("sweep-taken-from-profile", quantity=quantity)
        given = {"--limit": bool(limits), "--move": move != 1}
        faults += [Fault(where=name, message=message) for name in given if given[name]]
    require_move(machine, move, faults)
    if faults:
        raise InputError(faults)
    plan = Plan(
        profile_text=text,
        where=profile.name,
        axes=tuple(axis for axis, _ in found),
        is_paired=is_paired,
        quantity=Quantity(quantity),
        move=move,
        bounds=bounds,
        created=created,
    )
    check_plan(plan)
    check_values(plan, [place for _, place in found])
    return plan


ACCELERATION_KEY = "drive.max_acceleration"
"""What --f-max varies where the motor follows its setpoint."""


def _read_axes(
    bound: str,
    *,
    f_max: str,
    vary: Sequence[str],
    limits: Sequence[str],
    cases: Path | None,
    faults: list[Fault],
) -> list[tuple[Axis, str]]:
    """What varies, each with the option or file that it came from."""
    readers: list[tuple[Callable[[], Axis], str]] = []
    if cases is not None:
        readers.append((partial(load_cases, cases), str(cases)))
    keyed = [(text, "--vary") for text in vary]
    keyed += [(PEAKS_KEY + text, "--limit") for text in limits]
    readers += [(partial(read_axis, text, where=where), where) for text, where in keyed]
    if f_max:
        where = "--f-max"
        readers.append((lambda: Axis(keys=(bound,), rows=read_range(f_max, where=where)), where))
    found = []
    for read, place in readers:
        try:
            found.append((read(), place))
        except InputError as error:
            faults.extend(error.faults)
    return found


def split_limits(texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the limits that stay, and those that vary.

    Parameters
    ----------
    texts
        ``NAME=VALUE`` or ``NAME=RANGE``.

    Examples
    --------
    >>> split_limits(["v_phi=5mrad/s", "v_b=1:2:3"])
    (['v_phi=5mrad/s'], ['v_b=1:2:3'])
    """
    varied = [text for text in texts if ":" in text or "," in text]
    return [text for text in texts if text not in varied], varied


def check_values(plan: Plan, places: Sequence[str]) -> None:
    """Raise InputError for keys and values that the profile's reader refuses, before any work.

    Of numbers with the same unit the ends speak for all between, since what a profile allows of
    one key is an interval. A value that is only wrong together with others, e.g. a static load
    above the least of the forces that vary, is a row of its own.

    Parameters
    ----------
    plan
        With at least one case.
    places
        Option or file that each axis came from, for messages.

    Raises
    ------
    InputError
        With every fault found.
    """
    faults: list[Fault] = []
    for axis, where in zip(plan.axes, places, strict=True):
        for column, key in enumerate(axis.keys):
            for rows in _representatives([row[column] for row in axis.rows]):
                faults += _first_refused(plan, axis, rows, key, where)
    if faults:
        raise InputError(faults)


def _first_refused(
    plan: Plan, axis: Axis, rows: Sequence[int], key: str, where: str
) -> list[Fault]:
    """The faults of the first of some rows that is refused, with the line that it came from."""
    for row in rows:
        line = axis.lines[row] if axis.lines else 0
        refused = _refusals(plan, axis, row, key)
        if refused:
            return [
                Fault(where=where, line=line, key=key, message=item.message) for item in refused
            ]
    return []


def _representatives(texts: Sequence[str]) -> list[tuple[int, ...]]:
    """Places of the least and the largest number of each unit, and of every word."""
    by_unit: dict[str, list[int]] = {}
    for place, text in enumerate(texts):
        by_unit.setdefault(unit_of(text), []).append(place)
    found: list[tuple[int, ...]] = []
    for group in by_unit.values():
        numbers = [
            (float(match[0]), place) for place in group if (match := NUMBER.match(texts[place]))
        ]
        found.append((min(numbers)[1], max(numbers)[1]) if numbers else (group[0],))
    return found


def _refusals(plan: Plan, axis: Axis, row: int, key: str) -> list[Fault]:
    """What the profile's reader says against a value of a key, whatever the other keys are."""
    text = dict(zip(axis.keys, axis.rows[row], strict=True))[key]
    first = _faults_of(plan, plan.settings(0), key, text)
    if first and not all(
        _faults_of(plan, settings, key, text) for settings in _companies(plan, axis, row)
    ):
        return []
    return first


def _faults_of(plan: Plan, settings: Settings, key: str, text: str) -> list[Fault]:
    changed = (*((k, value) for k, value in settings if k != key), (key, text))
    try:
        parse_profile(vary_profile(plan.profile_text, changed, where=plan.where), where=plan.where)
    except InputError as error:
        path = f"{plain_key(key)}."
        return [fault for fault in error.faults if fault.key and path.startswith(f"{fault.key}.")]
    return []


def _companies(plan: Plan, axis: Axis, row: int) -> Iterator[Settings]:
    """What a row of an axis may meet: nothing else that varies, and the ends of the other axes."""
    yield ()
    if plan.is_paired:
        yield plan.settings(row)
        return
    ends = [[row] if other is axis else sorted(_ends(other), reverse=True) for other in plan.axes]
    for places in islice(product(*ends), MOST_COMPANIES):
        chosen = zip(plan.axes, places, strict=True)
        yield tuple(
            pair
            for other, place in chosen
            for pair in zip(other.keys, other.rows[place], strict=True)
        )


def _ends(axis: Axis) -> set[int]:
    columns = zip(*axis.rows, strict=True)
    return {place for texts in columns for group in _representatives(texts) for place in group}
