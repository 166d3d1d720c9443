"""Options of the command line -> plan; every fault at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from mtcommission.errors import Fault, InputError
from mtcommission.optimal.solution import Bound
from mtcommission.profile import read_profile_text
from mtcommission.sweep.cases import (
    FORCE_KEY,
    Axis,
    Plan,
    Quantity,
    check_plan,
    read_axis,
    read_cases,
    read_range,
)


def read_plan(
    profile: Path,
    *,
    f_max: str,
    vary: Sequence[str],
    cases: Path | None,
    is_paired: bool,
    quantity: str,
    bounds: tuple[Bound, ...],
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
    bounds, move
        For ``optimal``.
    created
        Date, ISO 8601.

    Returns
    -------
    Plan

    Raises
    ------
    InputError
        With every fault found.
    """
    faults: list[Fault] = []
    axes: list[Axis] = []

    def attempt(read: Callable[[], Axis]) -> None:
        try:
            axes.append(read())
        except InputError as error:
            faults.extend(error.faults)

    if cases is not None:
        attempt(lambda: read_cases(read_profile_text(cases), where=str(cases)))
    for text in vary:
        attempt(lambda text=text: read_axis(text, where="--vary"))  # type: ignore[misc]
    if f_max:
        attempt(lambda: Axis(keys=(FORCE_KEY,), rows=read_range(f_max, where="--f-max")))
    names = [item.value for item in Quantity]
    if quantity not in names:
        message = f"got {quantity!r}, must be {', '.join(names[:-1])} or {names[-1]}"
        faults.append(Fault(where="--quantity", message=message))
    if faults:
        raise InputError(faults)
    plan = Plan(
        profile_text=read_profile_text(profile),
        where=profile.name,
        axes=tuple(axes),
        is_paired=is_paired,
        quantity=Quantity(quantity),
        move=move,
        bounds=bounds,
        created=created,
    )
    check_plan(plan)
    return plan
