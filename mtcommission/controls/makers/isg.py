"""The ISG kernel, also as TwinCAT CNC."""

from __future__ import annotations

from collections.abc import Iterator

from mtcommission.controls.control import (
    Axis,
    Control,
    Corner,
    CornerRule,
    acceleration_row,
    cycles,
)
from mtcommission.controls.kind import (
    MOVING_AVERAGE,
    OF_DRIVE,
    ControlKind,
    FilterChoice,
    Jerk,
    PositionLoop,
    read,
)
from mtcommission.controls.row import Row, Setting, Values, doubted, fixed
from mtcommission.controls.syntax import NAMED_LIST
from mtcommission.controls.wording import MICRO

AXIS = "TwinCAT TF5200 axis parameters (ISG kernel)"

FILTER = "TwinCAT TF5200 axis filter, FIR filter, Vibration Guard"

FEEDFORWARD = "TwinCAT TF5200 feed-forward control"

COMMISSIONING = "TwinCAT TF5200 commissioning, operation modes"

SLOPE = "TwinCAT TF5200 programming, slope and weights"

ADDRESSES = {
    AXIS: "infosys.beckhoff.com, tf5200_axis_parameter (P-AXIS-00001 to 00833)",
    FILTER: "infosys.beckhoff.com, tf5200_axis_filter, tf5200_fir_filter, tf5200_vibration_guard",
    FEEDFORWARD: "infosys.beckhoff.com, tf5200_feedforward_control/308357131.html",
    COMMISSIONING: "infosys.beckhoff.com, tf5200_commissioning_axis/436095115.html",
    SLOPE: "infosys.beckhoff.com, tf5200_programming_manual/207190411.html",
}
"""Where each source was read, November 2026."""

ISG = ControlKind(
    key="isg",
    jerk=Jerk.TIME,
    setpoint_filters=(
        FilterChoice(kind=MOVING_AVERAGE, least_cycles=1.0, most_cycles=200.0, step=1e-6),
    ),
    jerk_feedforward=True,
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
    position_cycle=1e-3,
    force_filters=4,
    features={
        **OF_DRIVE,
        "acceleration": read(
            AXIS,
            "getriebe[i].slope_profil.a_beschl, a_brems, a_grenz [mm/s^2, deg/s^2], whole",
            "Not above a_max.",
        ),
        "jerk": read(
            f"{AXIS}; {SLOPE}",
            "getriebe[i].slope_profil.tr_beschl_zu and three more, tr_grenz [us], whole",
            "Jerk = a/time; only with slope TRAPEZ, SIN2 or HSC. The default STEP has none.",
        ),
        "modes": read(
            SLOPE, "G130 to G134 [%], dynamic_weighting.param[i]", "Weights, no columns."
        ),
        "setpoint_filters": read(
            FILTER,
            "filter_fir.type = 1, order_time [us]",
            "One FIR of 1 to 200 NC cycles; beside it three in series and a shaper of four modes "
            "(Vibration Guard), which shaper each is was not read: not offered.",
        ),
        "velocity_feedforward": read(
            f"{AXIS}; {FEEDFORWARD}",
            "vorsteuer.vorsteuerung 0x001 (0x100), weights 00514/00515; drive 00833 [0.1 %]",
        ),
        "acceleration_feedforward": read(
            f"{AXIS}; {FEEDFORWARD}",
            "vorsteuer.vorsteuerung 0x002 with 0x200, getriebe[i].load [kg m^2, kg]",
            "As torque, motor and load at the motor shaft; SERCOS is named.",
        ),
        "jerk_feedforward": read(
            AXIS,
            "vorsteuer.vorsteuerung 0x004, factor 00337/00338",
            "Only with a jerk-limited slope.",
        ),
        "reference_delay": read(
            AXIS,
            "timeconst_sym_filter [us], shift_time 0..4 cycles",
            "PROFIdrive with absolute encoder. With feed-forward five interpolator cycles lie in "
            "between (00566 removes them).",
        ),
        "position_loops": read(
            f"{AXIS}; {COMMISSIONING}",
            "antr.operation_mode",
            "In the drive by default on SERCOS, PROFIdrive, CANopen; in the CNC on +-10 V.",
        ),
        "position_cycle": read(FILTER, note="The NC cycle; 1 and 4 ms in examples."),
        "position_gain": read(
            AXIS, "getriebe[i].kv [0.01 1/s], whole", "Only with CNC_POSITION_CONTROL."
        ),
        "state_feedback": read(
            AXIS, note="None; Improved Position Control adds a band-passed velocity (not modelled)."
        ),
    },
)

RAMPS = (
    ("tr_beschl_zu", "isg-acceleration-rises"),
    ("tr_beschl_ab", "isg-acceleration-falls"),
    ("tr_brems_zu", "isg-deceleration-rises"),
    ("tr_brems_ab", "isg-deceleration-falls"),
    ("tr_grenz", "isg-ramp-at-rapid"),
)
"""P-AXIS-00196, 195, 198, 197 and 200 of the kernel."""


def _isg(axis: Axis, loop: Values) -> Iterator[Row]:
    slope = "getriebe[0].slope_profil"
    for name, meaning in (
        ("a_beschl", "limit-acceleration"),
        ("a_brems", "limit-deceleration"),
        ("a_grenz", "isg-acceleration-at-rapid"),
    ):
        yield acceleration_row(axis, f"{slope}.{name}", meaning, step=1)
    step = cycles(axis, MICRO)
    for name, meaning in RAMPS:
        yield Row(Setting.JERK_TIME, f"{slope}.{name}", unit="us", step=step, meaning=meaning)
    yield Row(
        Setting.POSITION_LOOP,
        "antr.operation_mode",
        codes={"drive": "DSC_POSITION_CONTROL", "control": "CNC_POSITION_CONTROL"},
        meaning="isg-operation-mode",
    )
    if loop[Setting.POSITION_LOOP, ""] != "drive":
        yield Row(Setting.POSITION_GAIN, "getriebe[0].kv", unit="0.01/s", step=1)
    yield doubted(
        Setting.FEEDFORWARD,
        "vorsteuer.vorsteuerung",
        codes={"none": "0", "velocity": "0x101", "force": "0x303"},
        meaning="isg-feedforward",
    )
    if axis.shaft:
        yield Row(
            Setting.FORCE_FEEDFORWARD,
            "getriebe[0].load",
            unit="kg m^2",
            at_shaft=axis.shaft**-2,
            meaning="row-feedforward-inertia",
        )
    if loop.get((Setting.AVERAGE, "")):
        yield fixed("filter_fir.type", "1", "isg-moving-average")
        yield Row(Setting.AVERAGE, "filter_fir.order_time", unit="us", digits=9)


GROUP = (
    doubted(
        Setting.TOGETHER,
        "#CONTOUR MODE [DEV, PATH_DEV v]: v",
        index="corner",
        meaning="group-row-arc",
        unit="mm",
        is_elsewhere=True,
    ),
)

CONTROL = Control(
    kind=ISG,
    rows=_isg,
    layout=NAMED_LIST,
    notes=("isg-gear-sets", "isg-own-limits", "isg-slope"),
    group=GROUP,
    corner=CornerRule(kind=Corner.ARC, source="names second-hand", is_verified=False),
)
