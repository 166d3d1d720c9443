"""[control] and [today] of a profile, and what a kind of control lacks."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    model_validator,
)

from mtcommission.control_kinds.kind import ControlKind, PositionLoop
from mtcommission.control_kinds.kinds import GENERIC, KINDS
from mtcommission.machine.mechanics import Misfit
from mtcommission.machine.ranges import (
    ACCELERATIONS,
    CYCLES,
    DELAYS,
    FEEDFORWARDS,
    FREQUENCIES,
    JERKS,
    MASSES,
    POSITION_GAINS,
    TIMES,
    VELOCITY_GAINS,
)
from mtcommission.messages.message import Message
from mtcommission.profile.filter_tables import (
    ChosenFilter,
    ForceFilterTable,
    HeldFilter,
    list_misfits,
    read_force_filters,
)
from mtcommission.profile.table import Table, optional, raise_all, required
from mtcommission.profile.values import (
    PerSignal,
    Read,
    SignalTable,
    describe,
    one_of,
)

FEEDFORWARDS_OF_KINDS = ("velocity_feedforward", "acceleration_feedforward", "jerk_feedforward")
"""Keys of [control], and fields of the kinds of control."""

Kind: Any = Literal[tuple(KINDS)]
"""Key of a kind of control."""

WHOLE_MULTIPLE = 1e-9
"""Relative distance from a whole number of velocity cycles."""


class TodayTable(Table):
    """[today]: what the control holds now."""

    acceleration: Annotated[float, Read(ACCELERATIONS)] = required(
        "Limit of the acceleration that is in the control now.", '"2 m/s^2"'
    )
    jerk: Annotated[float | None, Read(JERKS)] = optional("Limit of the jerk.", '"40 m/s^3"')
    position_gain: Annotated[float | None, Read(POSITION_GAINS)] = optional("Kv.", '"60 1/s"')
    velocity_gain: Annotated[float | None, Read(VELOCITY_GAINS)] = optional("Kp.", '"200 kN s/m"')
    integral_time: Annotated[float | None, Read(TIMES)] = optional("Tn.", '"20 ms"')
    setpoint_filter: HeldFilter = optional(
        'Filter behind the setpoint generator, or "none".', '"none"'
    )


class ControlTable(Table):
    """[control]; what is left out is tuned."""

    kind: Kind = optional("Which control: what it lacks is not used.", '"generic"', GENERIC.key)
    position_loop: Literal["control", "interpolated", "drive"] | None = optional(
        "Where the position loop closes; left out: as the kind of control does.", '"control"'
    )
    position_gain: Annotated[float | None, Read(POSITION_GAINS)] = optional("Kv.", '"60 1/s"')
    velocity_gain: Annotated[float | None, Read(VELOCITY_GAINS)] = optional("Kp.", '"200 kN s/m"')
    integral_time: Annotated[float | None, Read(TIMES)] = optional("Tn.", '"20 ms"')
    reference_model_time: Annotated[float, Read(DELAYS)] = optional(
        "Time constant of the reference model in the integral branch; 0 = none.", '"5 ms"', 0.0
    )
    velocity_feedforward: Annotated[float | None, Read(FEEDFORWARDS)] = optional(
        "Weight; left out: 1 where the control has it.", "1.0"
    )
    acceleration_feedforward: Annotated[float | None, Read(FEEDFORWARDS)] = optional(
        "Weight, times feedforward_mass; left out: 1 where the control has it.", "1.0"
    )
    jerk_feedforward: Annotated[float, Read(FEEDFORWARDS)] = optional(
        "Weight, times feedforward_mass and force_lag.", "0.0", 0.0
    )
    feedforward_mass: Annotated[float | None, Read(MASSES)] = optional(
        "Mass of the feed-forward; default: moving mass at mid payload.", '"800 kg"'
    )
    reference_delay: Annotated[float | None, Read(DELAYS)] = optional(
        "Delay of the reference path, or auto.", '"auto"'
    )
    position_cycle: Annotated[float | None, Read(CYCLES)] = optional(
        "Position controller cycle; left out: what is usual for the kind of control.", '"2 ms"'
    )
    velocity_cycle: Annotated[float | None, Read(CYCLES)] = optional(
        "Velocity controller cycle; left out: what is usual for the kind of control.", '"125 us"'
    )
    tcp_sensor: Literal["none", "position"] = optional(
        "Second encoder near the tool.", '"none"', "none"
    )
    state_feedback: Annotated[
        str | dict[str, float], SignalTable(PerSignal.GAIN, ("auto", "off"))
    ] = optional(
        "Active damping of the dominant mode: auto, off, or gains by state.", '"off"', "off"
    )
    setpoint_filter: ChosenFilter = optional(
        'Filter behind the setpoint generator, "none", or "auto": chosen with the limits.',
        '"auto"',
    )
    force_filters: Annotated[
        Annotated[list[ForceFilterTable], Field(max_length=8)] | None,
        BeforeValidator(read_force_filters),
    ] = Field(
        default=None,
        description='Filters in the set-force path; "auto": those that let Kp rise; []: none.',
    )
    minimum_bandwidth: Annotated[float | None, Read(FREQUENCIES)] = optional(
        "What tuning must at least reach, closed velocity loop, -3 dB.", '"15 Hz"'
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        kind = KINDS[self.kind]
        faults = _list_lacking(self, kind)
        position = cycle_of(self)
        faults += list_misfits(
            "setpoint_filter", self.setpoint_filter, kind, position_cycle=position
        )
        velocity = self.velocity_cycle or kind.velocity_cycle
        if closes_in(self) is PositionLoop.DRIVE and self.reference_delay is not None:
            least = 2.0 * position
            if self.reference_delay < least:
                message = Message("delay-below-drive", got=self.reference_delay, least=least)
                faults.append(("reference_delay", message))
        ratio = position / velocity
        if round(ratio) < 1 or abs(ratio - round(ratio)) > WHOLE_MULTIPLE * ratio:
            message = Message(
                "cycle-no-multiple", got=position, ratio=ratio, velocity_cycle=velocity
            )
            faults.append(("position_cycle", message))
        raise_all(faults)
        return self


def closes_in(control: ControlTable) -> PositionLoop:
    """Return where the position loop closes, as stated or as the kind of control does."""
    loop = control.position_loop
    return PositionLoop(loop) if loop else KINDS[control.kind].position_loops[0]


def cycle_of(control: ControlTable) -> float:
    """Return the position cycle, as stated or as usual for the kind of control [s]."""
    return control.position_cycle or KINDS[control.kind].position_cycle


def _list_lacking(control: ControlTable, kind: ControlKind) -> list[Misfit]:
    """What a profile asks of a kind of control that it does not have."""
    key, faults = kind.key, list[Misfit]()
    if closes_in(control) not in kind.position_loops:
        got = describe(control.position_loop)
        there = one_of([loop.value for loop in kind.position_loops])
        message = Message("control-closes-elsewhere", got=got, control=key, has=there)
        faults.append(("position_loop", message))
    for name in FEEDFORWARDS_OF_KINDS:
        weight = getattr(control, name)
        if weight and not getattr(kind, name):
            has = ", ".join(one for one in FEEDFORWARDS_OF_KINDS if getattr(kind, one))
            got = describe(weight)
            message = Message("control-without-feedforward", got=got, control=key, has=has)
            faults.append((name, message))
    if control.reference_delay and not kind.reference_delay:
        message = Message("control-without-delay", got=control.reference_delay, control=key)
        faults.append(("reference_delay", message))
    if control.state_feedback != "off" and not kind.state_feedback:
        message = Message("control-without-state-feedback", control=key)
        faults.append(("state_feedback", message))
    if control.tcp_sensor != "none" and not kind.state_feedback:
        faults.append(("tcp_sensor", Message("control-without-observer", control=key)))
    filters = control.force_filters or ()
    if len(filters) > kind.force_filters:
        message = Message(
            "control-with-fewer-filters",
            got=len(filters),
            control=key,
            most=kind.force_filters,
        )
        faults.append(("force_filters", message))
    is_asked = "force_filters" in control.model_fields_set and control.force_filters is None
    if is_asked and kind.force_filters == 0:
        faults.append(("force_filters", Message("control-without-force-filters", control=key)))
    return faults
