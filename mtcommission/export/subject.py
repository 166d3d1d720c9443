"""Record -> Subject: what an export needs to know, and the loop of the record built again.

The record holds the profile's text and every gain that was chosen, so the loop is built again
as it was, in every corner, without tuning or optimising anything.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, pi

import numpy as np

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis
from mtcommission.controls.kind import ControlKind, PositionLoop
from mtcommission.limits.corner_velocity import find_corner_velocity
from mtcommission.loop.model.assembly import as_state_space
from mtcommission.loop.model.controller import INTERPOLATED, Controller
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.moves import peak_velocity
from mtcommission.machine.plant.plant import build_plant, dominant_mode
from mtcommission.machine.setpoint_filter import SetpointFilter, list_misfits
from mtcommission.record.read_back import AxisRecord, close_as_held, read_held, read_limits
from mtcommission.setpoint.motion_limits import MotionLimits

REBUILT, ROUNDING = 1e-6, 1e-12
"""Largest relative difference of an entry of the record's loop from the one built again, and what
counts as zero beside its largest entry: versions of the linear algebra may differ by so much."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Subject:
    """An axis with its recommended limits, ready to be written for a control."""

    record: AxisRecord
    kind: ControlKind  # what the control has that it is written for
    machine: Machine  # built again from the record, like the controller
    controller: Controller
    limits: MotionLimits  # the recommendation

    @property
    def is_rotary(self) -> bool:
        """Whether the axis turns."""
        return self.machine.motion is Motion.ROTARY

    @property
    def length(self) -> str:
        """SI unit of a position."""
        return self.machine.axis_units.length.si

    @property
    def shaft(self) -> float | None:
        """Motion of the axis per angle of the motor's shaft [m/rad]; None: not stated."""
        drive = self.machine.drive
        if drive.lead is not None:
            return drive.lead / (2.0 * pi * drive.gear)
        return 1.0 / drive.gear if self.is_rotary else None

    @property
    def axis(self) -> Axis:
        """What the rows of the control need to know."""
        machine = self.machine

        def corner_velocity(kinds: Sequence[str]) -> float:
            return min(find_corner_velocity(machine, one) for one in self.shapers(kinds))

        return Axis(
            name=machine.axis.strip(),
            kind=self.kind,
            units=machine.axis_units,
            is_rotary=self.is_rotary,
            follows=machine.drive.follows,
            shaft=self.shaft,
            position_cycle=self.controller.position_cycle,
            acceleration=self.limits.acceleration,
            bands={mode.name: mode.band for mode in self.record.limits.modes},
            state_units=self.record.plant.units,
            has_own_filter=self.setpoint_filter is not None,
            mode_name=dominant_mode(build_plant(machine)).name,
            corner_velocity=corner_velocity,
        )

    def shapers(self, kinds: Sequence[str]) -> list[SetpointFilter]:
        """Return the run's own shaper, or some on the mode that a setpoint excites most."""
        if self.setpoint_filter:
            return [self.setpoint_filter]
        mode = dominant_mode(build_plant(self.machine))
        choices = (self.kind.find_filter(kind) for kind in kinds)
        return [
            SetpointFilter(
                kind=choice.kind,
                frequency_hz=mode.frequency_hz,
                damping_ratio=choice.nearest_damping(mode.damping_ratio),
            )
            for choice in choices
            if choice
        ]

    @property
    def fastest(self) -> float:
        """Largest velocity of the profile's moves [m/s]."""
        return max(peak_velocity(move, self.limits.acceleration) for move in self.machine.moves)

    @property
    def settling_time(self) -> float:
        """What the recommendation reached in the run, worst case [s]; inf if not settled."""
        found = self.record.limits.recommended.settling_time
        return inf if found is None else found

    @property
    def position_loop(self) -> PositionLoop:
        """Where the position loop closes: as in the record, or where this control closes it."""
        place, there_are = self.machine.control.position_loop, self.kind.position_loops
        return place if place in there_are else there_are[0]

    @property
    def setpoint_filter(self) -> SetpointFilter | None:
        """That of the record as this control can be set; None: none, or it lacks it."""
        item = self.limits.setpoint_filter
        choice = self.kind.find_filter(item.kind) if item else None
        if item is None or choice is None:
            return None
        own = replace(item, damping_ratio=choice.nearest_damping(item.damping_ratio))
        misfits = list_misfits(own, self.kind, position_cycle=self.controller.position_cycle)
        return None if any(misfits) else own

    @property
    def own_delay(self) -> float:
        """How old the newest setpoint is that the control can compare with [s]."""
        in_drive = self.position_loop is PositionLoop.DRIVE
        return INTERPOLATED * self.controller.position_cycle if in_drive else 0.0

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the loop of the record uses and this control lacks."""
        kind, loop, place = self.kind, self.controller, self.machine.control.position_loop
        has_same_filter = self.limits.setpoint_filter == self.setpoint_filter
        if loop.follows:
            return () if has_same_filter else ("setpoint-filter",)
        force, jerk = loop.acceleration_feedforward, loop.jerk_feedforward
        waits = loop.reference_delay > self.own_delay + ROUNDING
        lacks = {
            "state-feedback": bool(loop.state_gains.any()) and not kind.state_feedback,
            "velocity": loop.velocity_feedforward > 0.0 and not kind.velocity_feedforward,
            "acceleration": force > 0.0 and not kind.acceleration_feedforward,
            "jerk": jerk > 0.0 and not kind.jerk_feedforward,
            "delay": waits and not kind.reference_delay,
            "setpoint-filter": not has_same_filter,
            "force-filters": len(loop.force_filters) > kind.force_filters,
            f"loop-{place.value}": self.position_loop is not place,
        }
        return tuple(name for name, is_lacking in lacks.items() if is_lacking)


def build_subject(record: AxisRecord, kind: ControlKind) -> Subject:
    """Return the axis of a record with its loop built again.

    Raises InputError if that is not the record's loop.
    """
    machine, recommended = read_held(record), record.limits.recommended
    tuned, recorded = close_as_held(machine), np.array(record.loop.closed_loop.A)
    rebuilt = as_state_space(tuned.loops[0]).A
    same = recorded.shape == rebuilt.shape and np.allclose(
        recorded, rebuilt, rtol=REBUILT, atol=ROUNDING * float(np.max(np.abs(rebuilt)))
    )
    if not (same and isfinite(recommended.acceleration) and recommended.jerk > 0.0):
        raise InputError.at("record", Message("export-other-loop"), key="loop")
    return Subject(
        record=record,
        kind=kind,
        machine=machine,
        controller=tuned.controller,
        limits=read_limits(recommended),
    )
