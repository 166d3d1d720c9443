"""HEIDENHAIN TNC: names and units as the manuals give them, the rest is marked."""

from __future__ import annotations

from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule, say_mode
from mtcommission.controls.kind import (
    EARLIER,
    MOVING_AVERAGE,
    ControlKind,
    FilterChoice,
    PositionLoop,
    believed,
    read,
)
from mtcommission.controls.row import Row, Setting, Values, doubted
from mtcommission.controls.syntax import TABLE

TECHNICAL = "HEIDENHAIN MANUALplus 620 Technical Manual 01/2012, 6.16"

ITNC = "HEIDENHAIN iTNC 530 HSCI Technical Manual 6.8.2, p. 814"

SERVICE = "HEIDENHAIN iTNC 530 Service Manual, position controller"

TNC_430 = "HEIDENHAIN TNC 426/430 Technical Manual, 2-24, 6-134 to 6-136"

ADDRESSES = {
    TECHNICAL: "easymanua.ls/heidenhain/manualplus-620/manual/506189 (p. 811 to 914, 1108, 1124)",
    ITNC: "easymanua.ls/heidenhain/itnc-530-hsci/manual/716772?p=814",
    SERVICE: "easymanua.ls/heidenhain/itnc-530/manual?p=648",
    TNC_430: "easymanua.ls/heidenhain/tnc-430-pa-m/manual?p=464",
}
"""Where each source was read, November 2026."""

HEIDENHAIN = ControlKind(
    key="heidenhain",
    setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE, advised_cycles=0.0),),
    position_loops=(PositionLoop.CONTROL, PositionLoop.INTERPOLATED, PositionLoop.DRIVE),
    position_cycle=3e-3,
    velocity_cycle=200e-6,
    force_filters=5,
    features={
        "acceleration": read(
            f"{EARLIER}; {ITNC}", "maxAcceleration [m/s^2]; iTNC 530: MP1060.x, path MP1061"
        ),
        "jerk": read(
            f"{TECHNICAL}, pp. 834, 835",
            "axPathJerk, axPathJerkHi [m/s^3] 0..1 000 000",
            "maxPathJerk on top, at least 1.75 times it. iTNC 530: MP1090.x (?).",
        ),
        "modes": believed(
            note="Feed and rapid apart; no columns by machining mode were read. A finishing and a "
            "roughing setting of the filter.",
            beside=f"{TECHNICAL}, p. 811",
        ),
        "setpoint_filters": read(
            f"{TECHNICAL}, pp. 811, 1124; {ITNC}",
            "CfgFilter, CfgPositionFilter",
            "One of average (advised against, so never chosen here), triangle, HSC, Advanced HSC; "
            "set by limit frequency and tolerance, not by a time.",
        ),
        "velocity_feedforward": read(
            f"{TECHNICAL}, p. 840; {SERVICE}",
            "feedForwardFactor 0..1; iTNC 530: MP1396.x",
            "The same on axes that interpolate together.",
        ),
        "acceleration_feedforward": believed(
            "compAcc, MP2600 [A/(rev/s^2)]; analogue axes accForwardFactor [s]",
            "A current: a row only with the torque constant.",
            beside=f"{TECHNICAL}, pp. 914, 1108",
        ),
        "jerk_feedforward": believed(
            "compIpcT1, compIpcT2 [s], compIpcJerkFact",
            "IPC shapes the lag by two times and a jerk factor, which is not the jerk feed-forward "
            "of this loop; so none is counted on.",
        ),
        "reference_delay": believed(
            "compIpcT1, compIpcT2 [s]", "Inside IPC; no row of its own was found."
        ),
        "position_loops": read(
            f"{ITNC}; {SERVICE}; {TNC_430}",
            note="At the interpolator's cycle in the control's own unit. Newer units close it in "
            'the speed cycle (?): position_loop = "drive".',
        ),
        "position_cycle": read(
            f"{ITNC}; {TNC_430}", "MP7600", "3 ms with CC 424 and CC 6xxx; 3 to 6 ms before."
        ),
        "velocity_cycle": believed(
            note="0.6 ms on TNC 426/430; newer 0.1 to 0.3 ms with the PWM frequency.",
            beside=TNC_430,
        ),
        "position_gain": read(
            f"{TECHNICAL}, p. 842", "kvFactor [1/s] 0..1000; iTNC 530 [(m/min)/mm]"
        ),
        "velocity_gain": believed(
            "vCtrlPropGain [A s/rev], vCtrlIntGain [A/rev]; older MP2500 [A s], MP2510 [A]",
            "A current: Kp 2 pi/k_T needs the torque constant k_T.",
            beside=f"{TNC_430}; {TECHNICAL}, p. 856",
        ),
        "force_filters": believed(
            "older MP2530, MP2540, MP2550, MP2560",
            "PT2, band rejection and low-pass; the count is not read.",
            beside=f"{TECHNICAL}, p. 856; {TNC_430}",
        ),
        "state_feedback": read(TECHNICAL, note="None."),
    },
)


def _heidenhain(axis: Axis, _loop: Values) -> list[Row]:
    length = "deg" if axis.is_rotary else "m"
    # The manual states m/s^2 for linear axes; degrees for rotary ones are inferred, and so are
    # columns for the machining modes.
    rows = []
    for mode in ("", "surface", "accuracy", "speed"):
        row = partial(Row, index=mode, is_verified=not (axis.is_rotary or mode))
        for_mode = f", {mode}" if mode else ""
        rows += [
            row(
                Setting.ACCELERATION,
                f"maxAcceleration{for_mode}",
                unit=f"{length}/s^2",
                meaning=say_mode(axis, mode),
            ),
            row(
                Setting.JERK,
                f"axPathJerk{for_mode}",
                unit=f"{length}/s^3",
                meaning="limit-axis-jerk",
            ),
            row(
                Setting.JERK,
                f"axPathJerkHi{for_mode}",
                unit=f"{length}/s^3",
                meaning="limit-axis-jerk-at-rapid",
            ),
        ]
    return [
        *rows,
        Row(Setting.POSITION_GAIN, "kvFactor", unit="1/s"),
        Row(Setting.VELOCITY_FEEDFORWARD, "feedForwardFactor"),
    ]


GROUP = (
    Row(Setting.TOGETHER, "maxPathJerk", index="jerk", unit="m/s^3"),
    Row(Setting.TOGETHER, "maxPathJerkHi", index="jerk", unit="m/s^3"),
    doubted(
        Setting.TOGETHER,
        "pathTolerance",
        index="corner",
        unit="mm",
        meaning="group-row-tolerance",
    ),
)
"""Source: MANUALplus 620 Technical Manual 01/2012, 6.16, pp. 502, 829, 834."""

CONTROL = Control(
    kind=HEIDENHAIN,
    rows=_heidenhain,
    layout=TABLE,
    group=GROUP,
    corner=CornerRule(kind=Corner.OWN, source="names second-hand", is_verified=False),
    notes=("heidenhain-path", "heidenhain-filters", "heidenhain-speed-gains", "heidenhain-itnc"),
)
