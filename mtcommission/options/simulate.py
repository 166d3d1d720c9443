"""Options of ``simulate``: limits, filter, move, and a machine beside the corners."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from mtcommission.control_kinds.kind import FIR, MOVING_AVERAGE, TWO_AVERAGES
from mtcommission.errors import Fault
from mtcommission.machine.machine import Machine, VelocityStep
from mtcommission.machine.ranges import FILTER_TIMES, FREQUENCIES
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.machine.variations import Corner
from mtcommission.messages.message import Message
from mtcommission.options.texts import raise_all, read_positive, read_within
from mtcommission.setpoint.motion_limits import MotionLimits, without_jerk_limit
from mtcommission.setpoint.smaller_moves import resize
from mtcommission.units.quantities import (
    FREQUENCY,
    RATIO,
    TIME,
)


def read_limits(machine: Machine, *, acceleration: str, jerk: str) -> MotionLimits:
    """Return limits from ``--acceleration`` and ``--jerk``; "" where the control has no jerk limit.

    Raises
    ------
    InputError
        With a fault for each text that is no positive quantity.
    """
    faults: list[Fault] = []
    a = read_positive("--acceleration", acceleration, machine.axis_units.acceleration, faults)
    if not jerk and not machine.control.kind.has_jerk_limit:
        raise_all(faults)
        return without_jerk_limit(machine, a)
    if not jerk:
        faults.append(Fault(where="--jerk", message=Message("option-jerk-needed")))
    j = read_positive("--jerk", jerk, machine.axis_units.jerk, faults) if jerk else 1.0
    raise_all(faults)
    return MotionLimits(acceleration=a, jerk=j)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """What ``simulate`` runs in place of what the profile states; the loop stays the profile's.

    Parameters
    ----------
    machine
        With the moves and the setpoint filter to be simulated.
    place
        A machine to be looked at beside the corners; None: none.
    """

    machine: Machine
    place: Corner | None


LARGEST_FREQUENCY_ERROR = 0.5
"""Either way [-]; beyond, it is another machine."""

LARGEST_PAYLOAD = 1e6
"""[kg]; more than any machine moves."""


def read_tried(
    machine: Machine, *, setpoint_filter: str, move: int, size: str, payload: str, error: str
) -> Tried:
    """Return what the options of ``simulate`` change; "" and 0 change nothing.

    Parameters
    ----------
    machine
        From its profile.
    setpoint_filter
        ``none``, or kind and numbers, e.g. ``moving_average:20ms`` or ``zvd:40Hz:0.05``.
    move
        Number of the only move to be simulated.
    size
        Its velocity step or distance.
    payload, error
        Of a machine to be looked at besides: its payload, and by how much its frequencies are off.

    Raises
    ------
    InputError
        With every fault.
    """
    faults: list[Fault] = []
    control, moves, axis = machine.control, machine.moves, machine.axis_units
    if setpoint_filter:
        item = _read_filter(machine, setpoint_filter, faults)
        control = replace(control, setpoint_filter=item, seeks_setpoint_filter=False)
    if not 0 <= move <= len(moves):
        message = Message("option-no-such-move", got=move, count=len(moves))
        faults.append(Fault(where="--move", message=message))
    elif move or size:
        moves = (moves[max(move - 1, 0)],)
    if size:
        unit = axis.velocity if isinstance(moves[0], VelocityStep) else axis.length
        moves = (resize(moves[0], read_positive("--size", size, unit, faults)),)
    carried = read_within("--payload", payload, axis.mass, (0.0, LARGEST_PAYLOAD), faults)
    ends = (-LARGEST_FREQUENCY_ERROR, LARGEST_FREQUENCY_ERROR)
    off = read_within("--frequency-error", error, RATIO, ends, faults)
    raise_all(faults)
    return Tried(
        machine=replace(machine, control=control, moves=moves),
        place=Corner(payload=carried, frequency_factor=1.0 + off) if carried or off else None,
    )


def _read_filter(machine: Machine, text: str, faults: list[Fault]) -> SetpointFilter | None:
    """A filter that the control has, in its range; None for "none", or after noting a fault."""
    where, kind = "--filter", machine.control.kind
    name, *numbers = text.strip().split(":")
    if name == "none" and not numbers:
        return None
    choice = kind.find_filter(name)
    if choice is None:
        has = ", ".join(["none", *(item.kind for item in kind.setpoint_filters)])
        message = Message("control-without-filter", got=f'"{name}"', control=kind.key, has=has)
        faults.append(Fault(where=where, message=message))
        return None
    shortest, longest = choice.possible_times(machine.control.position_cycle)
    times = max(shortest, FILTER_TIMES.linear.low), min(longest, FILTER_TIMES.linear.high)
    highest = min(choice.most_frequency_hz, FREQUENCIES.linear.high)
    frequency = ("frequency", FREQUENCY, choice.least_frequency_hz, highest)
    damping = ("damping", RATIO, choice.least_damping, choice.most_damping)
    wanted = {MOVING_AVERAGE: [("time", TIME, *times)], TWO_AVERAGES: [("time", TIME, *times)] * 2}
    ranges = wanted.get(name, [frequency, damping])
    if len(numbers) != len(ranges) or name == FIR:
        form = {MOVING_AVERAGE: "time", TWO_AVERAGES: "times", FIR: FIR}.get(name, "mode")
        message = Message("option-filter-form", got=text.strip(), kind=name, numbers=form)
        faults.append(Fault(where=where, message=message))
        return None
    values = []
    for number, (key, unit, low, high) in zip(numbers, ranges, strict=True):
        value = read_within(where, number, unit, (-inf, inf), faults)
        if not low <= value <= high:
            message = Message(
                f"control-filter-{key}", got=value, low=low, high=high, control=kind.key
            )
            faults.append(Fault(where=where, message=message))
        values.append(value)
    if ranges[0][0] == "time":
        return SetpointFilter(kind=name, time=values[0], second_time=sum(values[1:]))
    return SetpointFilter(kind=name, frequency_hz=values[0], damping_ratio=values[1])
