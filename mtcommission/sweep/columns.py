"""The columns of a table: each declared once, with its unit and where its cells come from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isnan
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.catalogue import NAME, Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.describe import unit_of
from mtcommission.machine.profile.lines import read_key
from mtcommission.machine.profile.read import parse_profile
from mtcommission.optimal.free import GAP_TOLERANCE
from mtcommission.sweep.plan import PEAKS_KEY, Plan, Quantity, si_number

if TYPE_CHECKING:
    from mtcommission.limits.judge import Candidate
    from mtcommission.setpoint.motion_limits import MotionLimits

PEAK = "peak_"
"""What columns of the peaks of signals begin with."""

Cell = float | int | str | bool | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Optimum:
    """What was computed for a case of ``optimal``."""

    t_f: float  # [s]
    lower_bound: float  # which no control beats [s]
    peaks: NDArray[np.float64]  # of each of the plant's signals
    switching_times: Sequence[float] = ()  # [s]

    @property
    def gap(self) -> float:
        """By how much the time may be above the least [-]."""
        return (self.t_f - self.lower_bound) / self.t_f


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chosen(Optimum):
    """What was computed for a case of ``limits`` or ``run``; the optimum is of the slowest move."""

    judged: Candidate  # the recommended limits
    bound_by: Message
    max_force: float  # set force [N]
    record: str = ""  # where the record of a whole run is

    @property
    def limits(self) -> MotionLimits:
        """The recommended ones."""
        return self.judged.limits

    @property
    def obstacle(self) -> str:
        """The requirement that stands in the way; "": none."""
        limiting = self.judged.assessment.limiting_requirement
        return limiting.key if limiting else ""


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the table: named as in the record, or by the dotted key of what varies."""

    name: str
    unit: str = ""  # SI
    kind: str = "float"  # or "int", "bool", "str"
    of: Callable[[Any], Cell] | None = None  # its cell, from a ``Found``; None: it is no result
    varies: bool = False

    @property
    def meaning(self) -> Message:
        """What it holds."""
        if self.varies:
            return Message("sweep-column-key")
        if self.name.startswith(PEAK) and self.name != "peak_deviation":
            signal = Message(NAME, key=self.name.removeprefix(PEAK))
            return Message("sweep-column-peak", name=signal)
        return Message(f"sweep-column-{self.name.replace('_', '-')}")


def columns(plan: Plan) -> tuple[Column, ...]:
    """Return the columns of a plan's table; raise InputError if its profile cannot be read."""
    machine = parse_profile(plan.profile_text, where=plan.where)
    plant, varied = build_plant(machine), []
    for axis in plan.axes:
        for key, texts in zip(axis.keys, zip(*axis.rows, strict=True), strict=True):
            if any(isnan(si_number(text)) for text in texts):
                varied.append(Column(key, kind="str", varies=True))
            else:
                varied.append(Column(key, _unit_of_key(key, machine, plant), varies=True))
    return (
        Column("case", kind="int"),
        Column("inputs", kind="str"),
        *varied,
        *result_columns(plan.quantity, machine, plant),
        Column("outcome", kind="str"),
        Column("message", kind="str"),
    )


def result_columns(quantity: Quantity, machine: Machine, plant: Plant) -> tuple[Column, ...]:
    """Return the columns that a quantity fills."""
    length = machine.axis_units.length.si
    force = "N m" if machine.motion is Motion.ROTARY else "N"
    rates = (plant.states[mode.rate] for mode in plant.modes)
    peaks = [_peak(plant, name) for name in (*rates, "tcp_vibration", plant.states[plant.force])]
    proof = (
        Column("t_f", "s", of=lambda found: found.t_f),
        Column("t_f_lower_bound", "s", of=lambda found: found.lower_bound),
        Column("relative_gap", of=lambda found: found.gap),
        Column("certified", kind="bool", of=lambda found: found.gap <= GAP_TOLERANCE),
    )
    if quantity is Quantity.OPTIMAL:
        return (
            *proof,
            Column("switches", kind="int", of=lambda found: len(found.switching_times)),
            Column("switching_times", "s", "str", of=lambda found: _join(found.switching_times)),
            *peaks,
        )
    chosen = (
        *proof,
        Column("acceleration", f"{length}/s^2", of=lambda found: found.limits.acceleration),
        Column("jerk", f"{length}/s^3", of=lambda found: found.limits.jerk),
        Column("jerk_time", "s", of=lambda found: found.limits.jerk_time),
        Column("settling_time", "s", of=lambda found: found.judged.settling_time),
        Column("residual_deviation", length, of=lambda found: found.judged.residual_deviation),
        Column("peak_deviation", length, of=lambda found: found.judged.peak_deviation),
        *peaks,
        Column("peak_F_set", force, of=lambda found: found.max_force),
        Column("requirements_met", kind="bool", of=lambda found: found.judged.assessment.is_met),
        Column("bound_by", kind="str", of=lambda found: Catalogue().say(found.bound_by)),
        Column("obstacle", kind="str", of=lambda found: found.obstacle),
    )
    record = Column("record", kind="str", of=lambda found: found.record)
    return (*chosen, record) if quantity is Quantity.RUN else chosen


def _peak(plant: Plant, signal: str) -> Column:
    place = plant.signals.index(signal)
    return Column(PEAK + signal, plant.unit(signal), of=lambda found: float(found.peaks[place]))


def _join(times: Sequence[float]) -> str:
    return " ".join(f"{time:.12g}" for time in times)


def _unit_of_key(key: str, machine: Machine, plant: Plant) -> str:
    """SI unit of a key of the profile; "SI" where nothing tells."""
    name = key.removeprefix(PEAKS_KEY)
    if name != key and name in plant.signals:
        return plant.unit(name)
    rotary = machine.motion is Motion.ROTARY
    unit = unit_of(read_key(key).split("."), rotary=rotary)
    return "SI" if unit is None else unit
