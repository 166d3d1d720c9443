"""Numerical controls of machine tools: what they have, and where that was read."""

from __future__ import annotations

from mtcommission.control_kinds.kind import (
    MOVING_AVERAGE,
    TWO_AVERAGES,
    ControlKind,
    FilterChoice,
    Jerk,
    PositionLoop,
    believed,
    read,
)

EARLIER = "maker's text read earlier, place not kept"

AXES_2019 = "SINUMERIK Axes and Spindles 06/2019, B2 pp. 371, 377"
LIST_808 = "SINUMERIK 808D ADVANCED Parameter Manual 08/2013, p. 224"
JERK_2005 = "SINUMERIK 840D sl B2 08/2005, 2.17"
COMPENSATIONS = "SINUMERIK Extended Functions 03/2013, K3 pp. 279, 283, B3 p. 84"
SPEED_FFW = "SINUMERIK Extended Functions 01/2008, K3 p. 388"
S120_DSC = "SINAMICS S120 Drive Functions 11/2017, 4.16 p. 170"
S120_LISTS = "SINAMICS S List Manual 07/2007, diagram 3090"
TELEGRAM_105 = "SINAMICS S120 to Technology CPU 09/2011, 5.1.2"
SIMODRIVE = "SIMODRIVE 611 universal 04.05, p. 5-224"
S210_FILTERS = "SINAMICS S210 manual, F07420 p. 445"
S120_FILTERS = "SINAMICS S120 Drive Functions 07/2007, 3.7 p. 81"
PARAMETER_SETS = "SINUMERIK 828D Basic Functions 09/2011, G2 7.5"

TECHNICAL = "HEIDENHAIN MANUALplus 620 Technical Manual 01/2012, 6.16"
ITNC = "HEIDENHAIN iTNC 530 HSCI Technical Manual 6.8.2, p. 814"
SERVICE = "HEIDENHAIN iTNC 530 Service Manual, position controller"
TNC_430 = "HEIDENHAIN TNC 426/430 Technical Manual, 2-24, 6-134 to 6-136"

AXIS = "TwinCAT TF5200 axis parameters (ISG kernel)"
FILTER = "TwinCAT TF5200 axis filter, FIR filter, Vibration Guard"
FEEDFORWARD = "TwinCAT TF5200 feed-forward control"
COMMISSIONING = "TwinCAT TF5200 commissioning, operation modes"
SLOPE = "TwinCAT TF5200 programming, slope and weights"

ADDRESSES = {
    AXES_2019: "manual.onestart.ai/manuals/Siemens-SINUMERIK-840D-Function-Manual-5628446",
    LIST_808: "easymanua.ls/siemens/sinumerik-808d-advanced/manual?p=224",
    JERK_2005: "easymanua.ls/siemens/sinumerik-840de-sl/manual/32519?p=244",
    COMPENSATIONS: "easymanua.ls/siemens/sinumerik-series/manual/275710?p=279",
    SPEED_FFW: "manual.onestart.ai/manuals/Siemens-SINUMERIK-840D-sl-Function-Manual-5628453",
    S120_DSC: "manualshive.com/en/manual/siemens/sinamics-s120/376543?page=170",
    S120_LISTS: "easymanua.ls/siemens/sinamics-s-series/manual?p=1234",
    TELEGRAM_105: "manualshelf.com/manual/connect-tech/cpu/technical-data-english/page-129.html",
    SIMODRIVE: "manualshive.com/ru/manual/siemens/simodrive-611-universal/1265789?page=224",
    S210_FILTERS: "easymanua.ls/siemens/sinamics-s210/manual?p=445",
    S120_FILTERS: "azmanual.top/manuals/84895",
    PARAMETER_SETS: "manualshive.com, sinumerik-828d-turning_function-manual_376603-378",
    TECHNICAL: "easymanua.ls/heidenhain/manualplus-620/manual/506189 (p. 811 to 914, 1108, 1124)",
    ITNC: "easymanua.ls/heidenhain/itnc-530-hsci/manual/716772?p=814",
    SERVICE: "easymanua.ls/heidenhain/itnc-530/manual?p=648",
    TNC_430: "easymanua.ls/heidenhain/tnc-430-pa-m/manual?p=464",
    AXIS: "infosys.beckhoff.com, tf5200_axis_parameter (P-AXIS-00001 to 00833)",
    FILTER: "infosys.beckhoff.com, tf5200_axis_filter, tf5200_fir_filter, tf5200_vibration_guard",
    FEEDFORWARD: "infosys.beckhoff.com, tf5200_feedforward_control/308357131.html",
    COMMISSIONING: "infosys.beckhoff.com, tf5200_commissioning_axis/436095115.html",
    SLOPE: "infosys.beckhoff.com, tf5200_programming_manual/207190411.html",
    EARLIER: "taken over from the project's own list of what was read",
}
"""Where each source was read, November 2026, as stored public copies."""

SINUMERIK = ControlKind(
    key="sinumerik",
    modes=("DYNNORM", "DYNPOS", "DYNROUGH", "DYNSEMIFIN", "DYNFINISH"),
    setpoint_filters=(
        FilterChoice(
            kind=MOVING_AVERAGE,
            least_cycles=1.0,
            advised_cycles=16.0,
        ),
        FilterChoice(
            kind=TWO_AVERAGES,
            least_cycles=1.0,
            advised_cycles=16.0,
        ),
    ),
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL, PositionLoop.INTERPOLATED),
    force_filters=4,
    features={
        "acceleration": read(
            f"{EARLIER}; {AXES_2019}",
            "MD32300 MAX_AX_ACCEL[0..4] [m/s^2, rev/s^2]",
            "G0: times MD32434.",
        ),
        "jerk": read(
            f"{EARLIER}; {AXES_2019}",
            "MD32431 MAX_AX_JERK[0..4] [m/s^3, rev/s^3 (?)]",
            "Path MD20600 above it; G0: times MD32435; JOG: MD32420, MD32430.",
        ),
        "modes": read(
            EARLIER,
            "index 0..4 of the limits",
            "A sixth column in newer software (?).",
        ),
        "setpoint_filters": read(
            f"{AXES_2019}; {LIST_808}; {JERK_2005}",
            "MD32400 = 1; MD32402 = 2 (one average) or 4 (two); MD32410, MD32411 [s]",
            "One per axis. An average acts only above one position cycle; the maker advises 1 to "
            "16, and warns of contour error with two equal ones. Second order, band-stop and FIR "
            "(MD32402 = 1, 3, 5) are not offered: the first two ring on without end, and the taps "
            "of the third were not read.",
        ),
        "velocity_feedforward": read(
            f"{COMPENSATIONS}; {SPEED_FFW}",
            "MD32620 FFW_MODE = 3, MD32610 VELO_FFW_WEIGHT[set] 0..1",
            "From the program by FFWON if MD32630 = 1 or 2.",
        ),
        "acceleration_feedforward": read(
            COMPENSATIONS,
            "MD32620 FFW_MODE = 4, MD32650 AX_INERTIA [kg m^2 (?)], MD32652 AX_MASS [kg (?)]",
            "Without spline telegrams it arrives in steps of a position cycle.",
        ),
        "jerk_feedforward": read(COMPENSATIONS, note="In none of the sources."),
        "reference_delay": read(
            f"{COMPENSATIONS}; {PARAMETER_SETS}; {S120_DSC}",
            "MD32810 EQUIV_SPEEDCTRL_TIME [s] with speed, MD32800 EQUIV_CURRCTRL_TIME [s] with "
            "torque feed-forward",
            "Belongs to feed-forward. With spline DSC the drive balances itself: p1195, p1427.",
        ),
        "position_loops": believed(
            "MD32640 STIFFNESS_CONTROL_ENABLE = 1 and telegram 105/106: DSC in the drive",
            "DSC needs a P controller and clock-synchronous operation. The smooth setpoint that is "
            "simulated needs a spline telegram (125, 126, 136 (?)).",
            beside=f"{S120_LISTS}; {TELEGRAM_105}; {S120_DSC}",
        ),
        "position_cycle": read(
            COMPENSATIONS,
            "MD10050 x MD10060 (?), shown in MD10061",
            "1 to 2 ms typical; 828D 1.5 or 3 ms (?). Ratio fixed at 1 on an 840D sl; MD10070 is "
            "that of the interpolator.",
        ),
        "velocity_cycle": read(EARLIER, note="125 us in the maker's example."),
        "position_gain": read(
            f"{EARLIER}; {SIMODRIVE}", "MD32200 POSCTRL_GAIN[set] [(m/min)/mm]", "Double."
        ),
        "velocity_gain": read(
            f"{EARLIER}; {S210_FILTERS}",
            "p1460 [N m s/rad, linear N s/m (?)], p1462 [ms], p1433 to p1435 (?)",
            "At the motor shaft.",
        ),
        "force_filters": read(
            f"{S210_FILTERS}; {S120_FILTERS}",
            "p1656, p1657 to p1676 (order (?))",
            "Four, ten with the extended module; below half the current controller's rate.",
        ),
        "state_feedback": read(S210_FILTERS, note="None; APC is an option of the drive (?)."),
    },
)

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

ISG = ControlKind(
    key="isg",
    jerk=Jerk.TIME,
    setpoint_filters=(
        FilterChoice(
            kind=MOVING_AVERAGE,
            least_cycles=1.0,
            most_cycles=200.0,
            step=1e-6,
        ),
    ),
    jerk_feedforward=True,
    position_loops=(PositionLoop.DRIVE, PositionLoop.CONTROL),
    position_cycle=1e-3,
    force_filters=4,
    features={
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
        "velocity_cycle": believed(note="The drive's."),
        "position_gain": read(
            AXIS, "getriebe[i].kv [0.01 1/s], whole", "Only with CNC_POSITION_CONTROL."
        ),
        "velocity_gain": believed(note="In the drive."),
        "force_filters": believed(note="Those of the drive; four is what drives usually have."),
        "state_feedback": read(
            AXIS,
            note="None; Improved Position Control adds a band-passed velocity (not modelled).",
        ),
    },
)
