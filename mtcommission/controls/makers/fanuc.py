"""FANUC 30i and its relatives."""

from __future__ import annotations

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import Axis, Control, Corner, CornerRule, Typed, cycles
from mtcommission.controls.kind import (
    EARLIER,
    MOVING_AVERAGE,
    ControlKind,
    FilterChoice,
    Jerk,
    PositionLoop,
    believed,
    read,
)
from mtcommission.controls.row import Row, Setting, Values, doubted, si_of
from mtcommission.controls.syntax import TABLE
from mtcommission.controls.wording import MILLI

FANUC_MANUAL = "check against FANUC AC Servo Motor Parameter Manual B-65270EN"

FANUC = ControlKind(
    key="fanuc",
    jerk=Jerk.TIME,
    setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE, step=1e-3),),
    reference_delay=False,
    position_loops=(PositionLoop.DRIVE,),
    position_cycle=1e-3,
    velocity_cycle=500e-6,
    force_filters=5,
    features={
        "acceleration": read(
            EARLIER,
            "1620 [ms] with 1420",
            "A time from rest to rapid. In look-ahead 1660 [mm/s^2], 1671 (?).",
        ),
        "jerk": read(
            EARLIER, "1774 [ms]", "Bell time = a/j. In look-ahead 1772, 1788 to 1790 (?)."
        ),
        "modes": believed(note=f"Two ends, level 1 and 10, interpolated; {FANUC_MANUAL}."),
        "setpoint_filters": believed(
            "1769 [ms], 2109 [ms]",
            f"Acceleration after interpolation = moving average; {FANUC_MANUAL}.",
        ),
        "velocity_feedforward": believed("2068, 2092 [0.01 %]", f"{FANUC_MANUAL}."),
        "acceleration_feedforward": believed("2069 [%]", f"Of the inertia set; {FANUC_MANUAL}."),
        "jerk_feedforward": believed(note="None."),
        "reference_delay": believed("2095", "A timing of feed-forward only."),
        "position_loops": believed(
            note="In the servo card; the command is interpolated to its cycle."
        ),
        "position_cycle": believed(note="Position loop 1 ms; interpolator 8 ms down to 1 ms."),
        "velocity_cycle": believed(
            "2017#7", "0.5 ms or less with the high-cycle function, which is assumed; 1 ms without."
        ),
        "position_gain": believed("1825 [0.01 1/s], whole", f"{FANUC_MANUAL}."),
        "velocity_gain": believed(
            "2021, 2043, 2044",
            "Gain = (256 + 2021)/256 of the motor's standard: relative to today's value only; "
            f"{FANUC_MANUAL}.",
        ),
        "force_filters": believed(
            "2113/2177/2359, 2360 to 2368 [Hz], 2067", f"Four notch, one low-pass; {FANUC_MANUAL}."
        ),
        "state_feedback": believed(note="None; fixed structures for two encoders."),
    },
)


def _fanuc(axis: Axis, _loop: Values) -> list[Row]:
    return [
        Row(Setting.RISE_TIME, "1620", unit="ms", step=1),
        Row(Setting.JERK_TIME, "1774", unit="ms", step=cycles(axis, MILLI)),
        doubted(
            Setting.POSITION_GAIN, "1825", unit="0.01/s", step=1, meaning="gain-kv-name-and-unit"
        ),
        doubted(Setting.VELOCITY_FEEDFORWARD, "2068", unit="0.01 %", step=1),
        Row(Setting.RAPID, "1420", unit=f"{axis.small_unit}/min", is_elsewhere=True),
    ]


def _fanuc_notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    length = axis.small_unit
    a = typed.acceleration / si_of(length)
    return (
        Message("fanuc-no-jerk", length=length),
        Message("fanuc-rapid", length=length, acceleration=a),
        Message("fanuc-gain"),
        Message("fanuc-nano"),
        Message("fanuc-look-ahead"),
    )


IN_GROUP = (
    Row(
        Setting.TOGETHER,
        "1783",
        index="corner",
        unit="mm/min",
        step=1,
        meaning="group-row-step",
    ),
)
"""Source: FANUC 0i Connection Manual (Function) B-63833EN-1/02, 7, p. 354; A-63512EN, 2.4."""

CONTROL = Control(
    kind=FANUC,
    rows=_fanuc,
    layout=TABLE,
    notes_of=_fanuc_notes,
    axis_in_group=IN_GROUP,
    corner=CornerRule(
        kind=Corner.STEP, source="FANUC Series 0i Connection Manual B-63833EN-1/02, 7 p. 354"
    ),
)
