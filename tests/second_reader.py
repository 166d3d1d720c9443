"""Exported files read once more: names and units as the makers' manuals have them.

Shares no code with the package: each syntax by a parser of its own or a plain pattern, each number
by a factor that was written down here anew. What it finds drives ``independent_loop``.
"""

from __future__ import annotations

import configparser
import re
from dataclasses import dataclass
from math import ceil, pi
from typing import Any

import numpy as np
import yaml

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.controller import NO_OBSERVER, Controller
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine, Motion, corners, vary
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.setpoint_filter import SetpointFilter
from tests.independent_loop import judge, profile_of, run

TAIL = 0.3
"""Free motion simulated after the end [s]."""

PER_MINUTE = 50.0 / 3.0

REMARKS = {
    "Kv": ("Kv", 1.0),
    "Kp": ("Kp", 1.0),
    "Tn": ("Tn", 1e-3),
    "model": ("reference model", 1e-3),
    "velocity": ("velocity feed-forward", 1.0),
    "mass": ("force feed-forward", 1.0),
    "per_jerk": ("jerk feed-forward", 1.0),
    "delay": ("reference delay", 1e-3),
    "average": ("moving average", 1e-3),
    "second average": ("second moving average", 1e-3),
    "T_p": ("position cycle", 1e-3),
    "T_v": ("velocity cycle", 1e-3),
}
"""What stands in remarks, where the control has no row for it."""


@dataclass(frozen=True, slots=True)
class Reading:
    """Numbers by what they are, in SI; words where there is no number."""

    values: dict[str, float]
    loop: str
    filters: tuple[tuple[str, float, float], ...]
    shaper: tuple[str, float, float] | None


def read_file(control: str, text: str, machine: Machine) -> Reading:
    """A file as the control, and the hand that sets the drive, would take it."""
    text = re.sub("torque (?=feed-forward|filters)", "force ", text)  # of a rotary axis
    remark = dict(re.findall(r"^(?:;|#|\(\*) > (.+?) = (\S+)", text, re.MULTILINE))
    if "N10050 x N10060" in remark:  # of a SINUMERIK, in us
        remark["position cycle"] = str(1e-3 * float(remark["N10050 x N10060"]))
    own, words = _own(control, text, machine)
    found = {
        name: float(remark[label]) * factor
        for name, (label, factor) in REMARKS.items()
        if label in remark
    }
    found |= {name: float(value) * factor for name, (value, factor) in own.items()}
    if "rise" in found:
        found["a"] = found["rapid"] / found["rise"]
    if "ramp" in found:
        found["j"] = found["a"] / found["ramp"]
    found.setdefault("j", found["a"] / found["T_p"])
    filters = words.get("filters")
    if filters is None:
        filters = tuple(
            (
                remark[f"filter {i} kind"],
                float(remark[f"filter {i} frequency"]),
                float(remark[f"filter {i} damping"]),
            )
            for i in range(1, int(remark.get("force filters", "0")) + 1)
        )
    return Reading(
        values=found,
        loop=words.get("loop") or remark["position loop"],
        filters=filters,
        shaper=words.get("shaper"),
    )


def lines(text: str, pattern: str) -> dict[str, str]:
    return dict(re.findall(pattern, text, re.MULTILINE))


def _cells(text: str) -> dict[str, str]:
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines()]
    return {
        row[0]: row[1] for row in rows if len(row) == 5 and not row[0].startswith(("#", "Param"))
    }


def ini_file(text: str) -> configparser.ConfigParser:
    parser = configparser.ConfigParser(interpolation=None, strict=True)
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    parser.read_string(text)
    return parser


def _own(control: str, text: str, machine: Machine) -> tuple[dict[str, Any], dict[str, Any]]:
    """The control's own rows: value as text and factor to SI; and what is no number."""
    rotary = machine.motion is Motion.ROTARY
    small = pi / 180.0 if rotary else 1e-3
    lead = 2.0 * pi if rotary else machine.drive.lead
    i = 2.0 * pi * machine.drive.gear / lead if lead else 1.0  # rad of the motor per m
    match control:
        case "sinumerik":
            n = lines(text, r"^N(\d+ \$MA_\w+(?:\[\d\])?)=(\S+) ")
            p = lines(text, r"^p(\d+)=(\S+) ")
            turn = 2.0 * pi if rotary else 1.0
            own = {
                "a": (n["32300 $MA_MAX_AX_ACCEL[0]"], turn),
                "j": (n["32431 $MA_MAX_AX_JERK[0]"], turn),
                "Kv": (n["32200 $MA_POSCTRL_GAIN[0]"], PER_MINUTE),
                "velocity": (n["32610 $MA_VELO_FFW_WEIGHT[0]"], 1.0),
                "Tn": (p["1462"], 1e-3),
            }
            force = n["32620 $MA_FFW_MODE"] == "4"
            delay = (
                "32800 $MA_EQUIV_CURRCTRL_TIME[0]" if force else "32810 $MA_EQUIV_SPEEDCTRL_TIME[0]"
            )
            own["delay"] = (n[delay], 1.0)
            if lead:
                own["Kp"] = (p["1460"], i**2)
                own["mass"] = (n["32650 $MA_AX_INERTIA"] if force else "0", i**2)
            if n["32400 $MA_AX_JERK_ENABLE"] == "1":
                own["average"] = (n["32410 $MA_AX_JERK_TIME"], 1.0)
                if n["32402 $MA_AX_JERK_MODE"] == "4":
                    own["second average"] = (n["32411 $MA_AX_JERK_TIME_ADD"], 1.0)
                else:
                    assert n["32402 $MA_AX_JERK_MODE"] == "2"
            filters = []
            for number in range(bin(int(p["1656"])).count("1")):
                first = 1657 + 5 * number
                value = [p.get(str(first + place), "") for place in range(5)]
                if value[0] == "1":
                    filters.append(("low_pass", float(value[1]), float(value[2])))
                else:
                    assert value[1] == value[3]
                    assert value[2] == "1"  # width of the notch
                    filters.append(("notch", float(value[1]), float(value[4])))
            dsc = n.get("32640 $MA_STIFFNESS_CONTROL_ENABLE[0]")
            loop = {"1": "drive", "0": "control"}.get(dsc or "", "")
            return own, {"filters": tuple(filters), "loop": loop}
        case "heidenhain":
            c, size = _cells(text), pi / 180.0 if rotary else 1.0
            assert c["axPathJerk"] == c["axPathJerkHi"]
            return {
                "a": (c["maxAcceleration"], size),
                "j": (c["axPathJerk"], size),
                "Kv": (c["kvFactor"], 1.0),
                "velocity": (c["feedForwardFactor"], 1.0),
            }, {}
        case "fanuc":
            c = _cells(text)
            rapid = re.search(r"^# > 1420 = (\S+) +\[(?:mm|deg)/min\]", text, re.MULTILINE)
            assert rapid is not None
            return {
                "rapid": (rapid[1], small / 60.0),
                "rise": (c["1620"], 1e-3),
                "ramp": (c["1774"], 1e-3),
                "Kv": (c["1825"], 0.01),
                "velocity": (c["2068"], 1e-4),
            }, {}
        case "isg":
            n = lines(text, r"^([a-z]\S+)  (\S+) +\(")
            place = "getriebe[0].slope_profil."
            own = {
                "a": (n[f"{place}a_beschl"], small),
                "ramp": (n[f"{place}tr_beschl_zu"], 1e-6),
            }
            if "getriebe[0].kv" in n:
                own["Kv"] = (n["getriebe[0].kv"], 0.01)
            if "getriebe[0].load" in n:
                own["mass"] = (n["getriebe[0].load"], i**2)
            if "filter_fir.order_time" in n:
                own["average"] = (n["filter_fir.order_time"], 1e-6)
            places = {"DSC_POSITION_CONTROL": "drive", "CNC_POSITION_CONTROL": "control"}
            return own, {"loop": places.get(n.get("antr.operation_mode", ""), "")}
        case "twincat" | "plcopen":
            n = lines(text, r"^ +c[A-Z]\w*?_(\w+) : LREAL := ([0-9]+\.[0-9]+);")
            assert n["Deceleration"] == n["Acceleration"]
            own = {"a": (n["Acceleration"], small), "j": (n["Jerk"], small)}
            if control == "twincat":
                path = re.search(r"^\(\* #set paramPathDynamics\((\S+)\)# \*\)$", text, re.M)
                assert path is not None
                assert [float(v) for v in path[1].split(";")] == [
                    float(n[k]) for k in ("Acceleration", "Deceleration", "Jerk")
                ]
                s = lines(text, r"^\(\* > (S-0-\d+|NC .+?) += (\S+)")
                own["Tn"] = (s["S-0-0101"], 1e-4)
                if "S-0-0100" in s:
                    own["Kp"] = (s["S-0-0100"], i**2)
                if "S-0-0104" in s:
                    own["Kv"] = (s["S-0-0104"], PER_MINUTE)
                    own["velocity"] = (s["S-0-0296"], 0.01)
                else:
                    own["Kv"] = (s["NC position controller Kv"], 1.0)
                    own["velocity"] = (s["NC velocity pre-control weight"], 1.0)
            return own, {}
        case "generic":
            c = _cells(text)
            own = {"a": (c["acceleration"], 1.0), "j": (c["jerk"], 1.0)}
            own |= {
                name: (c[label], factor) for name, (label, factor) in REMARKS.items() if label in c
            }
            filters = tuple(
                (
                    c[f"filter {k} kind"],
                    float(c[f"filter {k} frequency"]),
                    float(c[f"filter {k} damping"]),
                )
                for k in range(1, int(c["force filters"]) + 1)
            )
            return own, {"filters": filters, "loop": c["position loop"]}
        case "linuxcnc":
            ini = ini_file(text)
            joint = next(ini[name] for name in ini.sections() if name.startswith("JOINT_"))
            assert ini["TRAJ"]["PLANNER_TYPE"] == "1"
            own = {
                "a": (joint["MAX_ACCELERATION"], small),
                "j": (joint["MAX_JERK"], small),
                "T_p": (ini["EMCMOT"]["SERVO_PERIOD"], 1e-9),
            }
            if "P" in joint:
                own |= {"Kv": (joint["P"], 1.0), "velocity": (joint["FF1"], 1.0)}
            return own, {}
        case "grblhal":
            (a_key, a), (j_key, j) = sorted(lines(text, r"^\$(\d+)=(\S+) ").items())
            assert int(j_key) - int(a_key) == 680
            return {"a": (a, small), "j": (j, small)}, {}
        case "fluidnc":
            (axis,) = yaml.safe_load(text)["axes"].values()
            return {"a": (axis["acceleration_mm_per_sec2"], small)}, {}
        case "klipper":
            ini = ini_file(text)
            part = ini["input_shaper"]
            kind = (
                part["shaper_type_x"],
                float(part["shaper_freq_x"]),
                float(part["damping_ratio_x"]),
            )
            return {"a": (ini["printer"]["max_accel"], 1e-3)}, {"shaper": kind}
        case "marlin":
            g = re.findall(r"^M(\d+) (?:X ?)?([A-Z]?)([\d.]+) *;", text, re.MULTILINE)
            words = {f"{number}{letter}": value for number, letter, value in g}
            assert words["493S"] == "1"
            named = "zv", "zvd", "zvdd", "zvddd", "ei", "2hump_ei", "3hump_ei", "mzv"
            kind = (
                f"marlin_{named[int(words['493C']) - 1]}",
                float(words["493A"]),
                float(words["493I"]),
            )
            return {"a": (words["201"], 1e-3)}, {"shaper": kind}
        case "ros2":
            tree = yaml.safe_load(text)
            (limits,) = tree["joint_limits"].values()
            assert limits["has_jerk_limits"] is True
            own = {"a": (limits["max_acceleration"], 1.0), "j": (limits["max_jerk"], 1.0)}
            if "joint_trajectory_controller" in tree:
                (gains,) = tree["joint_trajectory_controller"]["ros__parameters"]["gains"].values()
                own |= {"Kv": (gains["p"], 1.0), "velocity": (gains["ff_velocity_scale"], 1.0)}
            return own, {}
    raise AssertionError(f"nobody has read the manual of {control} yet")


def controller_of(reading: Reading, machine: Machine) -> Controller:
    """The controller that these numbers make."""
    get = reading.values.get
    T_p, T_v = reading.values["T_p"], reading.values["T_v"]
    mass, per_jerk, lag = get("mass", 0.0), get("per_jerk", 0.0), machine.drive.force_lag
    tau = get("delay", 0.0)
    loop = PositionLoop(reading.loop)
    if loop is PositionLoop.DRIVE:
        tau = max(tau, 2.0 * T_p)
    return Controller(
        position_loop=loop,
        position_gain=reading.values["Kv"],
        velocity_gain=reading.values["Kp"],
        integral_time=reading.values["Tn"],
        reference_model_time=get("model", 0.0),
        velocity_feedforward=get("velocity", 0.0),
        acceleration_feedforward=1.0 if mass else 0.0,
        jerk_feedforward=per_jerk / (mass * lag) if per_jerk else 0.0,
        feedforward_mass=mass,
        force_lag=lag,
        reference_delay=tau,
        velocity_cycle=T_v,
        cycles=round(T_p / T_v),
        force_filters=tuple(
            ForceFilter(kind=kind, natural_frequency=2.0 * pi * f, damping=damping)
            for kind, f, damping in reading.filters
        ),
        sensors=("encoder",),
        state_gains=np.zeros(build_plant(machine).order),
        observer=NO_OBSERVER,
    )


def simulate_file(control: str, text: str, machine: Machine) -> tuple[float, float, bool]:
    """Worst settling time and residual over moves and corners; whether it ever saturates."""
    reading = read_file(control, text, machine)
    gains = controller_of(reading, machine)
    limit, band = machine.drive.motion_force, machine.requirements.tcp_deviation
    settling, residual, saturates = 0.0, 0.0, False
    for move in machine.moves:
        times = tuple(reading.values.get(name, 0.0) for name in ("average", "second average"))
        profile = profile_of(
            move, reading.values["a"], reading.values["j"], means=tuple(filter(None, times))
        )
        if reading.shaper:
            kind, hertz, damping = reading.shaper
            item = SetpointFilter(kind=kind, frequency_hz=hertz, damping_ratio=damping)
            profile = profile.copied(*item.impulses)
        samples = ceil((profile.end + gains.reference_delay + TAIL) / gains.velocity_cycle)
        for corner in corners(machine):
            motion = run(
                vary(machine, corner),
                gains,
                profile,
                nominal=machine,
                samples=samples,
                force_limit=limit,
            )
            tau = gains.reference_delay
            found = judge(motion, profile, tau=tau, band=band)
            settling = max(settling, found.settling_time)
            residual = max(residual, found.residual)
            saturates |= bool(np.max(np.abs(motion.force)) >= limit * (1.0 - 1e-9))
    return settling, residual, saturates
