"""[control] and [today]: the cascade and its filters as stated, and what the control holds now."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from math import pi
from typing import Any, Literal

from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import AxisUnits
from mtcommission.controls.kind import LOW_PASS, NOTCH, ControlKind, Jerk, PositionLoop
from mtcommission.controls.kinds import GENERIC, KINDS
from mtcommission.machine import readers as of
from mtcommission.machine.keys import Misfit, Table, keyed
from mtcommission.machine.readers import (
    Array,
    PerSignal,
    Reading,
    Signals,
    SignalValue,
    Word,
    as_typed,
    describe,
    one_of,
    word_of,
)
from mtcommission.machine.setpoint_filter import (
    AUTO,
    CHOSEN_FILTER,
    HELD_FILTER,
    SetpointFilter,
    list_misfits,
)

FEEDFORWARDS_OF_KINDS = ("velocity_feedforward", "acceleration_feedforward", "jerk_feedforward")
"""Keys of [control], and fields of the kinds of control."""

WHOLE_MULTIPLE = 1e-9
"""Relative distance from a whole number of velocity cycles."""

MOST_FORCE_FILTERS = 8

MOST_CYCLES_LATE = 500
"""Position cycles by which the setpoint waits at most: the record holds four states for each of
them (empirical: half a second at 1 ms)."""

ROUNDED = 1.001
"""A ramp of one position cycle, with acceleration and jerk as rounded to what is typed."""

UNSEEN = 0.1
"""Share of a velocity cycle below which a ramp is a step to the drive."""


class StateFeedback(Enum):
    """How the state-space extension gets its gains."""

    AUTO = "auto"
    OFF = "off"
    GIVEN = "given"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceFilter:
    """One filter in the set-force path, an element of force_filters of [control]."""

    kind: Literal["notch", "low_pass"] = keyed(word_of((NOTCH, LOW_PASS)), "Kind of filter.", NOTCH)
    natural_frequency: float = keyed(
        of.FREQUENCIES, "Frequency of the filter.", "72 Hz", key="frequency", factor=2.0 * pi
    )  # [rad/s]
    damping: float = keyed(
        of.FILTER_DAMPINGS,
        "Damping ratio: of the denominator of a low-pass, of the numerator of a notch.",
        "0.1",
    )
    width: float = keyed(
        of.FILTER_DAMPINGS,
        "Damping ratio of the denominator of a notch; depth = damping / width.",
        "0.5",
        default=1.0,
    )
    """1 is the widest without overshoot. Without effect on a low-pass."""

    @property
    def delay(self) -> float:
        """Delay at low frequencies [s]."""
        over = self.damping if self.kind == LOW_PASS else self.width - self.damping
        return 2.0 * over / self.natural_frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Today:
    """What the control holds now; None for what is not known, which is then as recommended."""

    acceleration: float = keyed(
        of.ACCELERATIONS, "Limit of the acceleration that is in the control now.", "2 m/s^2"
    )
    jerk: float | None = keyed(of.JERKS, "Limit of the jerk.", "40 m/s^3", left_out=None)
    position_gain: float | None = keyed(of.POSITION_GAINS, "Kv.", "60 1/s", default=None)
    velocity_gain: float | None = keyed(of.VELOCITY_GAINS, "Kp.", "200 kN s/m", default=None)
    integral_time: float | None = keyed(of.TIMES, "Tn.", "20 ms", default=None)
    setpoint_filter: SetpointFilter | None = keyed(
        HELD_FILTER, 'Filter behind the setpoint generator, or "none".', "none", default=None
    )


def shortest_ramp(jerk: str, position_cycle: float, velocity_cycle: float) -> float:
    """Return below which length a ramp of acceleration is a step to the drive [s].

    ``jerk``: how the control takes a limit of it. Where it takes none, limits have a ramp of a
    position cycle, and a rule that was tried with a longer one shows the jerk that it has.
    """
    return ROUNDED * position_cycle if jerk == Jerk.NONE.value else UNSEEN * velocity_cycle


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """The cascade as the profile states it; None means "left out: tune it and print it"."""

    kind: ControlKind = keyed(
        Word(KINDS), "Which control: what it lacks is not used.", "generic", default=GENERIC
    )
    position_loop: PositionLoop = keyed(
        word_of(PositionLoop),
        "Where the position loop closes; left out: as the kind of control does.",
        "control",
        default=PositionLoop.CONTROL,
        left_out=None,
    )
    position_gain: float | None = keyed(of.POSITION_GAINS, "Kv.", "60 1/s", default=None)
    velocity_gain: float | None = keyed(of.VELOCITY_GAINS, "Kp.", "200 kN s/m", default=None)
    integral_time: float | None = keyed(of.TIMES, "Tn.", "20 ms", default=None)
    reference_model_time: float = keyed(
        of.MODEL_TIMES,
        "Time constant of the reference model in the integral branch; 0 = none.",
        "5 ms",
        default=0.0,
    )
    velocity_feedforward: float = keyed(
        of.FEEDFORWARDS,
        "Weight; left out: 1 where the control has it.",
        "1.0",
        default=1.0,
        left_out=None,
    )
    acceleration_feedforward: float = keyed(
        of.FEEDFORWARDS,
        "Weight, times feedforward_mass; left out: 1 where the control has it.",
        "1.0",
        default=1.0,
        left_out=None,
    )
    jerk_feedforward: float = keyed(
        of.FEEDFORWARDS,
        "Weight, times feedforward_mass and force_lag.",
        "0.0",
        default=0.0,
    )
    feedforward_mass: float | None = keyed(
        of.MASSES,
        "Mass of the feed-forward; default: moving mass at mid payload.",
        "800 kg",
        default=None,
    )
    reference_delay: float | None = keyed(
        of.DELAYS, "Delay of the reference path, or auto.", AUTO, default=None
    )  # τ [s]; None: chosen so that feed-forward meets feedback
    position_cycle: float = keyed(
        of.CYCLES,
        "Position controller cycle; left out: what is usual for the kind of control.",
        "2 ms",
        default=2e-3,
        left_out=None,
    )  # [s], a whole multiple of the velocity cycle
    velocity_cycle: float = keyed(
        of.CYCLES,
        "Velocity controller cycle; left out: what is usual for the kind of control.",
        "125 us",
        default=125e-6,
        left_out=None,
    )
    has_tcp_sensor: bool = keyed(
        Word({"none": False, "position": True}),
        "Second encoder near the tool.",
        "none",
        key="tcp_sensor",
        default=False,
    )
    state_feedback: StateFeedback = StateFeedback.OFF  # auto, off, or given by ``state_gains``
    state_gains: tuple[SignalValue, ...] = keyed(
        Word(
            {"auto": StateFeedback.AUTO, "off": StateFeedback.OFF},
            Signals(PerSignal.GAIN, ("auto", "off")),
        ),
        "Active damping of the dominant mode: auto, off, or gains by state.",
        "off",
        key="state_feedback",
        default=(),
        left_out=StateFeedback.OFF,
    )
    setpoint_filter: SetpointFilter | None = keyed(
        CHOSEN_FILTER,
        'Filter behind the setpoint generator, "none", or "auto": chosen with the limits.',
        AUTO,
        default=None,
        left_out=AUTO,
    )
    seeks_setpoint_filter: bool = False
    """Whether one is chosen together with the limits; else it is ``setpoint_filter``, or none."""
    force_filters: tuple[ForceFilter, ...] = keyed(
        Word({AUTO: AUTO}, Array(Table(ForceFilter), 0, MOST_FORCE_FILTERS)),
        'Filters in the set-force path; "auto": those that let Kp rise; []: none.',
        default=(),
        left_out=AUTO,
    )
    seeks_force_filters: bool = False
    """Whether those that let Kp rise are used; otherwise they are only suggested."""
    minimum_bandwidth_hz: float = keyed(
        of.FREQUENCIES,
        "What tuning must at least reach, closed velocity loop, -3 dB.",
        "15 Hz",
        key="minimum_bandwidth",
        default=0.0,
    )  # 0: none

    @property
    def has_given_gains(self) -> bool:
        """Whether Kv, Kp or Tn are given."""
        gains = (self.position_gain, self.velocity_gain, self.integral_time)
        return any(gain is not None for gain in gains)

    @property
    def leaves_all_to_rules(self) -> bool:
        """Whether nothing of the loop is given or demanded, so nothing can be poor about it."""
        given = self.has_given_gains or self.force_filters or self.state_gains
        return not given and self.minimum_bandwidth_hz == 0.0

    @property
    def shortest_ramp(self) -> float:
        """Below which length a ramp of acceleration is a step to the drive [s]."""
        return shortest_ramp(self.kind.jerk.value, self.position_cycle, self.velocity_cycle)

    @classmethod
    def complete(
        cls, values: dict[str, Any], stated: Mapping[str, Any], reading: Reading
    ) -> dict[str, Any]:
        """Return the values with what is left out as the kind of control has it."""
        kind, gains = values["kind"], values["state_gains"]
        usual = {
            "position_loop": kind.position_loops[0],
            "velocity_feedforward": float(kind.velocity_feedforward),
            "acceleration_feedforward": float(kind.acceleration_feedforward),
            "reference_delay": None if kind.reference_delay else 0.0,
            "position_cycle": kind.position_cycle,
            "velocity_cycle": kind.velocity_cycle,
        }
        is_given = isinstance(gains, tuple)
        sought = {key: values[key] == AUTO for key in ("setpoint_filter", "force_filters")}
        return {
            **values,
            **{key: usual[key] for key in usual if values[key] is None},
            "state_feedback": StateFeedback.GIVEN if is_given else gains,
            "state_gains": gains if is_given else (),
            "setpoint_filter": None if sought["setpoint_filter"] else values["setpoint_filter"],
            "seeks_setpoint_filter": sought["setpoint_filter"],
            "force_filters": () if sought["force_filters"] else values["force_filters"],
            "seeks_force_filters": sought["force_filters"] and kind.force_filters > 0,
        }

    def find_faults(self, stated: Mapping[str, Any], axis: AxisUnits) -> Iterator[Misfit]:
        """Yield what the kind of control does not have, and what does not fit together."""
        yield from self._lacking(stated)
        for key, message in list_misfits(
            self.setpoint_filter, self.kind, position_cycle=self.position_cycle
        ):
            yield f"setpoint_filter.{key}", message
        least, delay = 2.0 * self.position_cycle, self.reference_delay
        is_drive = self.position_loop is PositionLoop.DRIVE
        if is_drive and "reference_delay" in stated and delay is not None and delay < least:
            yield "reference_delay", Message("delay-below-drive", got=delay, unit="s", least=least)
        ratio = self.position_cycle / self.velocity_cycle
        if round(ratio) < 1 or abs(ratio - round(ratio)) > WHOLE_MULTIPLE * ratio:
            message = Message(
                "cycle-no-multiple",
                got=self.position_cycle,
                unit="s",
                ratio=ratio,
                velocity_cycle=as_typed(stated.get("velocity_cycle"), self.velocity_cycle, "s"),
            )
            yield "position_cycle", message

    def _lacking(self, stated: Mapping[str, Any]) -> Iterator[Misfit]:
        kind, name = self.kind, self.kind.key
        seeks_filters = stated.get("force_filters") == AUTO
        if self.position_loop not in kind.position_loops:
            got, there = (
                describe(self.position_loop.value),
                [one.value for one in kind.position_loops],
            )
            message = Message("control-closes-elsewhere", got=got, control=name, has=one_of(there))
            yield "position_loop", message
        for key in FEEDFORWARDS_OF_KINDS:
            if getattr(self, key) and not getattr(kind, key):
                has = ", ".join(one for one in FEEDFORWARDS_OF_KINDS if getattr(kind, one))
                weight = getattr(self, key)
                message = Message("control-without-feedforward", got=weight, control=name, has=has)
                yield key, message
        is_fed_back = self.state_feedback is not StateFeedback.OFF
        for at, is_asked, is_there, feature in (
            ("reference_delay", self.reference_delay, kind.reference_delay, "reference-delay"),
            ("state_feedback", is_fed_back, kind.state_feedback, "state-feedback"),
            ("tcp_sensor", self.has_tcp_sensor, kind.state_feedback, "state-feedback"),
            ("force_filters", seeks_filters, kind.force_filters, "force-filters"),
        ):
            if is_asked and not is_there:
                what = Message(f"has-{feature}")
                yield at, Message("control-lacks", control=name, what=what)
        count, most = len(self.force_filters), kind.force_filters
        if count > most:
            message = Message("control-with-fewer-filters", got=count, control=name, most=most)
            yield "force_filters", message
