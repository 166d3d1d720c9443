"""Records of runs with the numbers that tests quote, made up so that a misplaced one is noticed.

Records are JSON here, as in their files: a test changes what it wants, and ``on_json`` hands the
record to a function as it would be read.
"""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable
from copy import deepcopy
from functools import cache, wraps
from pathlib import Path
from typing import Any

from filelock import FileLock

import mtcommission
from mtcommission.base.messages.message import Message, Value, to_json
from mtcommission.controls.control import complete
from mtcommission.controls.kinds import CONTROLS
from mtcommission.controls.syntax import type_in
from mtcommission.export.held import loop_of, today_of, write_limits
from mtcommission.export.subject import Subject
from mtcommission.export.write import Export
from mtcommission.limits.requirements import RESIDUAL_DEVIATION, SET_FORCE
from mtcommission.loop.model.assembly import INPUTS
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Motion
from mtcommission.machine.mechanics import SOURCE
from mtcommission.machine.plant.plant import build_plant
from mtcommission.machine.profile.read import parse_profile, profile_text_hash
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.loop import ClosedLoop
from mtcommission.record.machine import list_data
from mtcommission.record.moves import describe_move
from mtcommission.record.read_back import read_limits
from mtcommission.record.record import Record
from mtcommission.record.shape import dump_json, entry_of, find_checksum, to_entry, to_plain

Json = dict[str, Any]

HOSTILE = '<script>alert("1")</script> #set text(red) [bold]x[/bold] $x_1$ \\u{41} &amp; ÄÖÜß µ'
"""Markup of every printer at once, 80 characters or so, with umlauts."""

LONG = "Fräs- und Bohrwerk mit Portal, Werkstückmanipulator Ä Ö Ü ß & <b>x</b> Nr. 12345-67890"
WORD = "Donaudampfschifffahrtsgesellschaftskapitänsmützenhalterungsschraubensicherungsblech"
"""Names as long as a profile may make them, one of them a single word."""

TABLE = """
schema = 1
[machine]
name = "Table"
axis = "C"
motion = "rotary"
source = "made up"
[plant]
kind = "modal"
moving_mass = "8.3 kg m^2"
[[plant.modes]]
name = "disc"
frequency = "50 Hz"
damping_ratio = 0.0207
tcp_gain = "0.03 1/(kg m^2)"
[drive]
force_lag = "1 ms"
max_force = "800 N m"
[[moves]]
velocity_step = "60 deg/s"
[requirements]
tcp_deviation = "25 urad"
move_sizes = "listed"
"""
"""A rotary axis with one mode."""


@cache
def _run(text: str) -> str:
    """The record of a profile's run as text; computed once by all processes of a session."""
    session = os.environ.get("PYTEST_XDIST_TESTRUNUID", str(os.getpid()))
    name = f"mtcommission-{session}-{profile_text_hash(text.encode())[:12]}"
    file = Path(tempfile.gettempdir()) / f"{name}.json"
    with FileLock(file.with_suffix(".lock")):
        if not file.exists():
            profile = file.with_suffix(".toml")
            profile.write_text(text, "utf-8")
            record = mtcommission.make_record(mtcommission.run(profile))
            file.write_text(dump_json(record), "utf-8")
    return file.read_text("utf-8")


def said(kind: str, **values: Value) -> Any:
    """What the program says, as a record holds it."""
    return to_json(Message(kind, **values))


def on_json(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of records as one of records in JSON."""

    @wraps(function)
    def call(*values: Any, **named: Any) -> Any:
        return function(*map(_read, values), **{key: _read(value) for key, value in named.items()})

    return call


def _read(value: Any) -> Any:
    is_record = isinstance(value, dict) and "checksum" in value
    return to_entry(to_plain(value), Record) if is_record else value


def example_record() -> Json:
    """One move, all requirements met; sealed as a run does it."""
    record = json.loads(_run(read_shipped("milling-manipulator").text))
    _quote(record)
    return {**record, "checksum": find_checksum(record)}


def _quote(record: Json) -> None:
    """What the tests speak of."""
    base, speed = {"base": 0.2075}, {"velocity_step": 0.102}
    limits, loop, (move,), (optima,) = (
        record[key] for key in ("limits", "loop", "moves", "optima")
    )
    record |= {
        "tool": {"name": "mtcommission", "version": "0.1.0", "libraries": {"numpy": "2.3.4"}},
        "created": "2026-03-04T05:06:07+00:00",
        "profile": {"name": "mill.toml", "sha256": "0123456789abcdef" * 4, "text": "schema = 1\n"},
        "assumptions": [said("assumption-linear")],
        "warnings": [said("loop-unseen-modes", modes="rotation")],
        "what_if": None,
        "data": [
            _datum("control.kind", "state-space", "") | {"source": said("source-default")},
            _datum("plant.base_mass", 451.0, "kg"),
            _datum("plant.base_stiffness", 44.41e6, "N/m"),
            _datum("drive.max_force", 2010.0, "N"),
            _datum("moves[1].velocity_step", 0.102, "m/s"),
            _datum("requirements.tcp_deviation", 5.1e-6, "m"),
            _datum("requirements.frequency_spread", 0.052, "-"),
            _datum("requirements.reserve.band", 0.93, "-"),
            _datum("requirements.reserve.force", 0.97, "-"),
            _datum("requirements.peaks.v_phi", 0.0053, "SI"),
        ],
    }
    record["machine"] |= {"name": "Milling machine", "source": "Table 1"}
    mode = {"name": "base", "frequency_hz": 50.03, "damping_ratio": 0.0301}
    record["plant"]["modes"] = [record["plant"]["modes"][0] | mode]
    (check, *_) = record["assessment"]["checks"]
    record["assessment"]["checks"] = [check | {"value": 4.582e-6, "limit": 5.1e-6, "reserve": 0.93}]
    response = {
        "settling_time": 0.1049, "residual_deviation": 4.581e-6, "peak_deviation": 9.46e-6,
        "max_force": 1803.0, "rms_force": 886.3, "mode_amplitudes": {"base": 1.67e-6},
    }  # fmt: skip
    move["move"] = optima["move"] = optima["time"]["move"] = speed
    move["response"] |= response
    optima["time"] |= {"t_f": 0.0435, "f_max": 2010.0}
    reached = {"settling_time": 0.1056, "residual_deviation": 4.582e-6, "peak_deviation": 9.47e-6}
    limits["recommended"] |= reached | {
        "acceleration": 2.41,
        "jerk": 41.2,
        "jerk_time": 0.0585,
        "setpoint_filter": None,
        "bound_by": said("bound-by-requirements", requirements=RESIDUAL_DEVIATION.message),
        "valid_for": [{"smallest": 0.0, "largest": 0.102}],
    }
    limits["recommended"]["worst_sizes"] = [
        one | {"requirement": "residual deviation"}
        for one in limits["recommended"]["worst_sizes"][:1]
    ]
    limits["warnings"] = loop["warnings"] = record["robustness"]["warnings"] = []
    for sizes in limits["move_sizes"]:
        sizes["move"] = speed
    for other, name in zip(limits["rules"], ("j = a f", "j = 10 a"), strict=False):
        other |= {"name": name, "source": "a handbook"}
    for other in (*limits["rules"], *limits["alternatives"]):
        other["meets_requirements"] = other is limits["alternatives"][0]
    loop |= {
        "Kv": 42.79,
        "Kp": 128400.0,
        "Tn": 0.02337,
        "reference_delay": 0.005625,
        "motion_force": 2010.0,
        "state_feedback": {"v_b": 1236.4},
        "encoder_resolution": 1e-8,
        "encoder_noise": {"tool": 3.3e-8, "force": 21.2},
        "mode_damping": base,
        "worst_mode_damping": base,
        "force_filters": [
            {"kind": "notch", "natural_frequency": 452.0, "damping": 0.1, "width": 0.8}
        ],
    }
    loop["feedforward"]["mass"] = 752.0
    error = record["robustness"]["frequency_error"]
    error |= {"kept_from": 0.99, "kept_to": 1.01}
    record["robustness"]["damping_error"] |= {"kept_from": 0.61}


UNKNOWN = (
    *("settling_time", "residual_deviation", "kept_from", "kept_to", "full_from"),
    *("damping", "listed_only"),
)
"""What may be null, wherever it stands but in the loop."""


def _forget(item: Any) -> None:
    for key, value in item.items() if isinstance(item, dict) else enumerate(item):
        if key in UNKNOWN:
            item[key] = _nothing(value)
        elif isinstance(value, dict | list):
            _forget(value)


def _nothing(value: Any) -> Any:
    return [_nothing(one) for one in value] if isinstance(value, list) else None


def unsettled_record() -> Json:
    """Nothing settles, nothing is met, and every null is null."""
    record = example_record()
    for part in ("limits", "moves", "optima", "robustness"):
        _forget(record[part])
    limits, loop = record["limits"], record["loop"]
    for item in (loop, loop["worst_corner"]):
        item |= dict.fromkeys(("gain_margin_db", "phase_margin_deg", "bandwidth_hz"))
    loop |= dict.fromkeys(("gain_margin_hz", "phase_margin_hz"))
    for item in loop["variants"]:
        item["settling_time"] = None
    for mode in limits["modes"]:
        mode |= dict.fromkeys(("acceleration", "jerk", "jerk_time"))
        mode |= {"meets_requirements": False}
    limits["modes"][0]["attainable"] = 3.17e-6
    limits["recommended"]["valid_for"] = [{"smallest": 0.102, "largest": 0.102}]
    missed, place = {"limit": 0.2, "unit": "s"}, Message("place-move", number=1)
    limits["attainable"] = [
        missed
        | {"requirement": "settling time", "value": 0.2313, "together_with": []}
        | {"acceleration": 0.9, "jerk": 11.0}
    ]
    check = missed | {"name": "settling time", "value": None, "reserve": 1.0, "met": False}
    record["assessment"] = {
        "met": False,
        "checks": [check | {"where": said("place", parts=(place,))}],
        "obstacle": "settling time",
    }
    return record


def five_moves_record() -> Json:
    """Five moves with bounded optima, and hostile names everywhere."""
    record = example_record()
    moves = [
        {"velocity_step": 0.102},
        {"distance": 0.0203, "max_velocity": 0.504},
        {"distance": 0.105},
        {"velocity_step": 0.0506},
        {"distance": 0.00107, "dwell": 0.2},
    ]
    _repeat(record, moves)
    for item in record["optima"]:
        item["constrained"] = deepcopy(item["time"])
        item["constrained"]["limits"] = {"v_phi": 0.0053}
    for place in (record["machine"], record["profile"], record["plant"]["modes"][0]):
        place["name"] = HOSTILE
    for item in (record["loop"], *record["loop"]["variants"]):
        item["mode_damping"] = {HOSTILE: 0.2075}
    record["profile"]["text"] = HOSTILE
    record["machine"]["axis"] = HOSTILE
    record["warnings"] = record["assumptions"] = record["loop"]["remarks"] = [HOSTILE]
    for item in (*record["limits"]["alternatives"], *record["limits"]["rules"]):
        item["name"] = HOSTILE
    record["limits"]["recommended"]["bound_by"] = HOSTILE
    sizes = [move.get("velocity_step") or move["distance"] for move in moves]
    listed = [{"smallest": size, "largest": size} for size in sizes]
    record["limits"]["recommended"] |= {"valid_for": listed, "worst_sizes": []}
    record["limits"]["listed_only"] = None
    record["data"][0]["source"] = HOSTILE
    return record


def _repeat(record: Json, moves: list[dict[str, float]]) -> None:
    """The first move's entries for each of some moves."""
    for key in ("optima", "moves"):
        record[key] = [deepcopy(record[key][0]) for _ in moves]
    for move, optima, entry in zip(moves, record["optima"], record["moves"], strict=True):
        optima["move"] = entry["move"] = optima["time"]["move"] = move


def extreme_record() -> Json:
    """Six modes, five moves, 27 corners, long names, numbers of every size."""
    record = five_moves_record()
    names = [WORD, LONG, "m3 " + "x" * 77, "a", "mode<script>", "mode 6"]
    record["machine"] |= {"name": LONG, "axis": "X", "source": f"{WORD} {LONG} {LONG}"}
    record["plant"]["modes"] = [
        {
            "name": name,
            "frequency_hz": 10.0**k,
            "damping_ratio": 10.0**-k,
            "tcp_gain": (-1) ** k * 1.2345e-7 * 10.0**k,
            "measured_gain": 9.8765e8,
        }
        for k, name in enumerate(names)
    ]
    for item in (record["loop"], *record["loop"]["variants"]):
        item["mode_damping"] = {name: 0.12345 * 10.0**-k for k, name in enumerate(names)}
    for move in record["moves"]:
        move["response"]["mode_amplitudes"] = {n: 1.2e-6 * 10.0**k for k, n in enumerate(names)}
        move["corners"] = [
            move["response"] | {"payload": 1234.5 * k, "max_force": 1.2345e9} for k in range(27)
        ]
    best = record["limits"]["recommended"]
    best |= {"acceleration": 1.23456789e-5, "jerk": 9.87654321e12, "jerk_time": 1.234e-18}
    record["limits"]["rules"] = [
        record["limits"]["rules"][0] | {"name": f"{LONG} {k}", "source": WORD} for k in range(14)
    ]
    record["warnings"] = [f"{LONG} {WORD} {HOSTILE}"] * 14
    record["profile"]["text"] = f"# {LONG * 4}\n{WORD * 4}\n" * 60
    record["loop"]["poles"] = [[-(10.0**k), 10.0**k * (k % 2)] for k in range(-3, 24)]
    record["data"] += [
        _datum(f"plant.{WORD}_{k}", 10.0 ** (3 * k - 30), "N s/m") | {"source": LONG}
        for k in range(21)
    ]
    return record


def rotary_record() -> Json:
    """A rotary table with one mode."""
    record = json.loads(_run(TABLE)) | {"what_if": None}
    return record | {"checksum": find_checksum(record)}


def _datum(key: str, value: float | str, unit: str) -> Any:
    return {"key": key, "value": value, "unit": unit, "source": "Table 1"}


def average(time: float) -> Any:
    return {
        "kind": "moving_average",
        "time": time,
        "second_time": 0.0,
        "frequency_hz": 0.0,
        "damping_ratio": 0.0,
        "delays": [0.0],
        "shares": [1.0],
        "duration": time,
    }


def retuned(record: Json) -> Json:
    """The same axis later: more payload, a wider band, other limits, one move more slowly."""
    later = deepcopy(record)
    for item in later["data"]:
        if item["key"] == "requirements.tcp_deviation":
            item["value"] *= 2.0
    later["data"] = [item for item in later["data"] if item["key"] != "plant.base_mass"]
    later["data"].append(
        {"key": "plant.tcp_height", "value": 0.2, "unit": "m", "source": "measured"}
    )
    later["limits"]["recommended"] |= {
        "acceleration": 2.41 * 1.2,
        "bound_by": said("bound-by-requirements", requirements=SET_FORCE.message),
    }
    later["limits"]["recommended"]["settling_time"] = None
    later["loop"]["Kv"] *= 0.9
    later["checksum"] = find_checksum(later)
    return later


@cache
def _tuned(name: str) -> Controller:
    return tune_loop(read_shipped(name).machine).controller


def typed_rows(name: str, record: Record) -> Export:
    """The rows that an example machine's control gets, with the made-up numbers; nothing judged."""
    machine = read_shipped(name).machine
    kind = machine.control.kind
    subject = Subject(
        record=record,
        kind=kind,
        machine=machine,
        controller=_tuned(name),
        limits=read_limits(record.limits.recommended),
    )
    control, loop = CONTROLS[kind.key], loop_of(subject)
    values = dict(loop)
    for mode in ("", *(mode.name for mode in record.limits.modes)):
        values |= write_limits(subject.limits, subject.fastest, mode)
    rows = complete(control.rows(subject.axis, loop), loop, machine.axis_units)
    return Export(
        header=(),
        entries=tuple(type_in(rows, values, today_of(subject))),
        limits=subject.limits,
        verdict=None,
        is_met=True,
        meets_requirements=True,
        judgement=Message("export-ceiling"),
        doubts=(),
        text="",
    )


def exportable_record(text: str) -> Json:
    """Made-up limits, with the loop that tuning gives a profile: it can be exported."""
    machine = parse_profile(text, where="test.toml")
    tuned, control = tune_loop(machine), machine.control
    controller = tuned.controller
    record = rotary_record() if machine.motion is Motion.ROTARY else example_record()
    record["profile"] |= {"text": text, "sha256": profile_text_hash(text.encode())}
    record["machine"] |= {
        "name": machine.name,
        "axis": machine.axis,
        "drive": SOURCE if machine.drive.follows else "servo",
    }
    record["data"] = to_plain(list_data(machine, build_plant(machine), text))
    follows = machine.drive.follows
    loop = tuned.loops[0]
    record["loop"] |= {
        "kind": control.kind.key,
        "jerk": control.kind.jerk.value,
        "position_loop": control.position_loop.value,
        "Kv": None if follows else controller.position_gain,
        "Kp": None if follows else controller.velocity_gain,
        "Tn": None if follows else controller.integral_time,
        "reference_delay": controller.reference_delay,
        "state_feedback": {},
        "force_filters": [to_plain(item) for item in controller.force_filters],
        "feedforward": {
            "velocity": controller.velocity_feedforward,
            "acceleration": controller.acceleration_feedforward,
            "jerk": controller.jerk_feedforward,
            "mass": controller.feedforward_mass,
        },
        "closed_loop": to_plain(
            entry_of(
                ClosedLoop,
                loop.lifted,
                loop,
                inputs=INPUTS,
                outputs=[f"{name}[{i}]" for i in range(controller.cycles) for name in loop.outputs],
            )
        ),
    }
    return record


def shipped_record(name: str) -> Json:
    """The words of an example machine on made-up numbers: its names, data, sources, moves, control.

    As long on paper as its own record, without the minutes that it takes to compute that.
    """
    profile = read_shipped(name)
    machine = profile.machine
    plant = build_plant(machine)
    is_rotary = machine.motion is Motion.ROTARY
    record = rotary_record() if is_rotary else example_record()
    moves = [describe_move(move) for move in machine.moves]
    record["profile"] |= {"name": f"{name}.toml", "text": profile.text}
    record["machine"] |= {"name": machine.name, "axis": machine.axis, "source": machine.source}
    record["data"] = to_plain(list_data(machine, plant, profile.text))
    modes = record["plant"]["modes"]
    record["plant"]["modes"] = [
        modes[0] | {"name": mode.name, "frequency_hz": mode.frequency_hz} for mode in plant.modes
    ]
    damping = {mode.name: 0.031 for mode in plant.modes}
    _repeat(record, moves)
    limits, loop = record["limits"], record["loop"]
    sizes = [move.get("velocity_step") or move["distance"] for move in moves]
    limits["recommended"] |= {
        "setpoint_filter": average(0.016),
        "valid_for": [{"smallest": 0.0, "largest": size} for size in sizes],
    }
    limits["move_sizes"] = [
        item | {"move": move} for move in moves for item in limits["move_sizes"][:3]
    ]
    limits["would_bring"] = [limits["would_bring"][0] for _ in range(6)]
    kind = machine.control.kind
    loop |= {
        "kind": kind.key,
        "jerk": kind.jerk.value,
        "position_loop": machine.control.position_loop.value,
        "mode_damping": damping,
        "worst_mode_damping": damping,
        "state_feedback": dict.fromkeys(plant.states, 1236.4) if kind.state_feedback else {},
        "reasons": loop["reasons"],
    }
    for variant in loop["variants"]:
        variant["mode_damping"] = damping
    check = record["assessment"]["checks"][0]
    names = ["residual deviation", "settling time", "set force", "RMS force"]
    parts = (
        Message("place-move", number=1),
        Message("place-payload", payload=200.0),
        Message("place-frequencies", factor=0.95),
        Message("place-damping", factor=1.3),
    )
    record["assessment"]["checks"] = [
        check | {"name": kind, "where": said("place", parts=parts)} for kind in names
    ]
    return record


def with_today(record: Json) -> Json:
    """Today's limits and Kv beside the recommended ones."""
    record["limits"]["today"] = {
        "acceleration": 2.03,
        "jerk": 17.1,
        "jerk_time": 2.03 / 17.1,
        "setpoint_filter": None,
        "Kv": 31.0,
        "Kp": 128400.0,
        "Tn": 0.02337,
        "stated": ["Kv"],
        "basis": said("today-in-mixed-loop", stated=("Kv",), others=("Kp", "Tn")),
        "failure": None,
        "bound_by": None,
        "settling_time": 0.3101,
        "residual_deviation": 45.2e-6,
        "peak_deviation": 61.3e-6,
        "meets_requirements": False,
        "keeps_reserve": False,
        "frequency_range": None,
        "valid_for": [{"smallest": 0.102, "largest": 0.102}],
    }
    return record


def not_met(record: Json) -> Json:
    """One requirement missed, with what could be met instead."""
    check = record["assessment"]["checks"][0]
    record["assessment"] |= {"met": False, "obstacle": "residual deviation"}
    check |= {"value": 1.3 * check["limit"], "met": False}
    record["limits"]["attainable"] = [
        {
            "requirement": name,
            "limit": limit,
            "value": 1.3 * limit,
            "unit": unit,
            "acceleration": 0.9,
            "jerk": 11.0,
            "together_with": [],
        }
        for name, limit, unit in (("residual deviation", 5e-6, "m"), ("settling time", 0.1, "s"))
    ]
    return record
