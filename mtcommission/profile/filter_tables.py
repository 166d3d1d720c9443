"""Filters in [control] and [today] of a profile: those of the setpoint, and those of the force."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import fsum, pi
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
)

from mtcommission.control_kinds.kind import (
    FIR,
    MOVING_AVERAGE,
    SHAPERS,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
)
from mtcommission.machine.control import FilterKind, ForceFilter
from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import FILTER_DAMPINGS, FILTER_TIMES, FREQUENCIES, TAPS
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.messages.message import Message
from mtcommission.profile.table import Table, optional, required
from mtcommission.profile.values import Faults, Read, describe, one_of

KEYS: Mapping[str, tuple[str, ...]] = {
    "none": (),
    MOVING_AVERAGE: ("time",),
    TWO_AVERAGES: ("time", "second_time"),
    FIR: ("taps", "spacing"),
    **dict.fromkeys(SHAPERS, ("frequency", "damping")),
}
"""What states each kind of setpoint filter."""

ENDLESS = ("second_order", "band_stop")
"""Kinds that controls have, and behind which a setpoint never ends."""

MOST_TAPS = 64
WHOLE = 1e-6
"""By how much the sum of taps may miss 1: their last printed digit."""

FilterName: Any = Literal[tuple(KEYS)]
Tap = Annotated[float, Read(TAPS)]


class SetpointFilterTable(Table):
    """setpoint_filter of [control] and [today]; a key that is left out is validated, too."""

    model_config = ConfigDict(validate_default=True)

    kind: FilterName = required("Kind of filter.", f'"{MOVING_AVERAGE}"')
    time: Annotated[float | None, Read(FILTER_TIMES)] = optional(
        "Length of the average.", '"20 ms"'
    )
    second_time: Annotated[float | None, Read(FILTER_TIMES)] = optional(
        "Length of the second average.", '"10 ms"'
    )
    frequency: Annotated[float | None, Read(FREQUENCIES)] = optional(
        "Frequency of the mode that a shaper is designed for.", '"40 Hz"'
    )
    damping: Annotated[float | None, Read(FILTER_DAMPINGS)] = optional(
        "Damping ratio of that mode.", "0.05"
    )
    taps: Annotated[list[Tap] | None, Field(min_length=2, max_length=MOST_TAPS)] = optional(
        "Weights of a finite impulse response; their sum is 1.", "[0.25, 0.5, 0.25]"
    )
    spacing: Annotated[float | None, Read(FILTER_TIMES)] = optional(
        "Time between the taps.", '"2 ms"'
    )

    @field_validator("kind", mode="before")
    @classmethod
    def _refuse_endless(cls, value: object) -> object:
        if value in ENDLESS:
            raise Faults([("", Message("filter-without-end", got=describe(value)))])
        return value

    @field_validator("time", "second_time", "frequency", "damping", "taps", "spacing", mode="wrap")
    @classmethod
    def _belongs_to_kind(
        cls, value: object, read: ValidatorFunctionWrapHandler, info: ValidationInfo
    ) -> object:
        kind = info.data.get("kind")  # None where it is wrong itself
        is_given, is_needed = value is not None, info.field_name in KEYS.get(kind or "", ())
        if kind and is_given != is_needed:
            said = "filter-key-unused" if is_given else "filter-key-missing"
            raise Faults([("", Message(said, kind=kind))])
        return read(value) if is_given else None

    @field_validator("taps")
    @classmethod
    def _sum_up(cls, taps: list[float] | None) -> list[float] | None:
        if taps is not None and abs(fsum(taps) - 1.0) > WHOLE:
            raise Faults([("", Message("filter-taps-sum", got=fsum(taps)))])
        return taps

    def build(self) -> SetpointFilter | None:
        """Return the filter, in SI; None for none."""
        if self.kind == "none":
            return None
        return SetpointFilter(
            kind=self.kind,
            time=self.time or 0.0,
            second_time=self.second_time or 0.0,
            frequency_hz=self.frequency or 0.0,
            damping_ratio=self.damping or 0.0,
            taps=tuple(self.taps or ()),
            spacing=self.spacing or 0.0,
        )


def _read_filter(value: object, *words: str) -> object:
    """A filter as it stands in the profile; "none" as a kind, any other word as None."""
    if isinstance(value, str) and value not in words:
        raise Faults([("", Message("got-no-filter", got=describe(value), words=one_of(words)))])
    if value == "none":
        return {"kind": value}
    return None if isinstance(value, str) else value


ChosenFilter = Annotated[
    SetpointFilterTable | None, BeforeValidator(lambda value: _read_filter(value, "auto", "none"))
]
"""None: chosen with the limits."""

HeldFilter = Annotated[
    SetpointFilterTable | None, BeforeValidator(lambda value: _read_filter(value, "none"))
]
"""None: not stated, so none."""


def list_misfits(
    key: str, table: SetpointFilterTable | None, kind: ControlKind, *, position_cycle: float
) -> Iterator[Misfit]:
    """Yield where a kind of control cannot be set to a filter.

    Parameters
    ----------
    key
        Of the filter in the profile.
    table
        The filter as it stands there.
    kind
        Of the control.
    position_cycle
        [s].
    """
    item = table.build() if table else None
    if table is None or item is None:
        return
    choice = kind.find_filter(item.kind)
    if choice is None:
        there = one_of(["none", *(choice.kind for choice in kind.setpoint_filters)])
        got = describe(item.kind)
        yield key, Message("control-without-filter", got=got, control=kind.key, has=there)
        return
    for name, (low, high) in _ranges(choice, position_cycle).items():
        got = getattr(table, name)
        if got is not None and not low <= got <= high:
            message = Message(
                f"control-filter-{name.removeprefix('second_')}",
                got=got,
                low=low,
                high=high,
                control=kind.key,
            )
            yield f"{key}.{name}", message


def _ranges(choice: FilterChoice, position_cycle: float) -> dict[str, tuple[float, float]]:
    """What a control takes, by the profile's keys; plain ranges bound what it leaves open."""
    least_time, most_time = choice.possible_times(position_cycle)
    times = least_time, min(most_time, FILTER_TIMES.linear.high)
    most = min(choice.most_frequency_hz, FREQUENCIES.linear.high)
    return {
        "time": times,
        "second_time": times,
        "frequency": (choice.least_frequency_hz, most),
        "damping": (choice.least_damping, choice.most_damping),
    }


class ForceFilterTable(Table):
    """An element of force_filters of [control]."""

    kind: Literal["notch", "low_pass"] = required("Kind of filter.", '"notch"')
    frequency: Annotated[float, Read(FREQUENCIES)] = required("Frequency of the filter.", '"72 Hz"')
    damping: Annotated[float, Read(FILTER_DAMPINGS)] = required(
        "Damping ratio: of the denominator of a low-pass, of the numerator of a notch.", "0.1"
    )
    width: Annotated[float, Read(FILTER_DAMPINGS)] = optional(
        "Damping ratio of the denominator of a notch; depth = damping / width.", "0.5", 1.0
    )

    def build(self) -> ForceFilter:
        """Return the filter, in SI."""
        return ForceFilter(
            kind=FilterKind(self.kind),
            natural_frequency=2.0 * pi * self.frequency,
            damping=self.damping,
            width=self.width,
        )


def read_force_filters(value: object) -> object:
    """Return filters as they stand in the profile; None for "auto"."""
    return None if value == "auto" else value
