"""A small record with made-up numbers, all different, so that a misplaced one is noticed.

Records are JSON here, as in their files: a test changes what it wants, and ``on_json`` hands the
record to a function as it would be read.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from functools import cache, wraps
from math import exp, pi, sin
from typing import Any

from mtcommission.control_kinds.control import complete
from mtcommission.control_kinds.kinds import CONTROLS
from mtcommission.control_kinds.row import Setting
from mtcommission.control_kinds.syntax import Entry
from mtcommission.export.held import loop_of, today_of, write_limits
from mtcommission.export.subject import Subject
from mtcommission.export.write import Export
from mtcommission.limits.commissioning_rule import ADVICE, DESCRIPTION, VALIDITY, formulas_for
from mtcommission.loop.model.assembly import INPUTS
from mtcommission.loop.model.controller import Controller
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Motion
from mtcommission.machine.moves import VelocityStep
from mtcommission.messages.message import Message, Value, to_json
from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile, profile_text_hash
from mtcommission.profile.shipped import read_shipped
from mtcommission.record.files import find_checksum
from mtcommission.record.loop import ClosedLoop, feature_entries
from mtcommission.record.machine import list_data
from mtcommission.record.read_back import read_limits
from mtcommission.record.record import SCHEMA, Record
from mtcommission.record.shape import entry_of, to_entry, to_plain
from mtcommission.record.values import describe_move
from mtcommission.requirements.residual_deviation import RESIDUAL_DEVIATION
from mtcommission.requirements.set_force import SET_FORCE
from mtcommission.study.attainable import NO_LIMITS

Json = dict[str, Any]

HOSTILE = '<script>alert("1")</script> #set text(red) [bold]x[/bold] $x_1$ \\u{41} &amp; ÄÖÜß µ'
"""Markup of every printer at once, 80 characters or so, with umlauts."""

LONG = "Fräs- und Bohrwerk mit Portal, Werkstückmanipulator Ä Ö Ü ß & <b>x</b> Nr. 12345-67890"
WORD = "Donaudampfschifffahrtsgesellschaftskapitänsmützenhalterungsschraubensicherungsblech"
"""Names as long as a profile may make them, one of them a single word."""

STATES = ["x_b", "x_s", "phi", "v_b", "v_s", "v_phi", "F"]
OUTPUTS = ["tcp", "encoder", "tcp_vibration"]
UNITS = {
    "x_b": "m",
    "x_s": "m",
    "phi": "rad",
    "v_b": "m/s",
    "v_s": "m/s",
    "v_phi": "rad/s",
    "F": "N",
    "tcp": "m",
    "encoder": "m",
    "tcp_vibration": "m",
}
REFERENCES = ["x_ref_delayed", "v_ref", "a_ref", "j_ref", "deviation"]


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
    """One move, one corner, all requirements met; sealed as a run does it."""
    record = _unsealed_record()
    return {**record, "checksum": find_checksum(record)}


def _unsealed_record() -> Json:
    return {
        "schema": SCHEMA,
        "checksum": "",
        "tool": {"name": "mtcommission", "version": "0.1.0", "libraries": {"numpy": "2.3.4"}},
        "created": "2026-03-04T05:06:07+00:00",
        "profile": {"name": "mill.toml", "sha256": "0123456789abcdef" * 4, "text": "schema = 1\n"},
        "machine": {
            "name": "Milling machine",
            "axis": "X",
            "motion": "linear",
            "source": "Table 1",
            "kind": "manipulator",
            "drive": "servo",
        },
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
        "settings": {"tuning.gain_margin_db": 6.1, "tuning.mode_weights": "0.2, 0.1"},
        "assumptions": [said("assumption-linear")],
        "warnings": [said("loop-unseen-modes", modes="rotation")],
        "plant": {
            "states": STATES,
            "units": UNITS,
            "A": [[0.0] * len(STATES) for _ in STATES],
            "B": [0.0] * len(STATES),
            "outputs": {},
            "modes": [
                {
                    "name": "base",
                    "frequency_hz": 50.03,
                    "damping_ratio": 0.0301,
                    "tcp_gain": 0.0022,
                    "measured_gain": 0.0023,
                }
            ],
            "controllability_rank": 7,
            "moving_mass": 751.0,
        },
        "optima": [_optima({"velocity_step": 0.102})],
        "limits": _limits(),
        "loop": _loop(),
        "moves": [_move({"velocity_step": 0.102})],
        "comparisons": [_comparison()],
        "robustness": _robustness(),
        "what_if": None,
        "assessment": {
            "met": True,
            "checks": [
                {
                    "name": "residual deviation",
                    "value": 4.582e-6,
                    "limit": 5.1e-6,
                    "reserve": 0.93,
                    "unit": "m",
                    "met": True,
                    "where": said(
                        "place", parts=(Message("place-move", number=1), Message("place-nominal"))
                    ),
                }
            ],
            "obstacle": "",
        },
        "identified": None,
    }


def unsettled_record() -> Json:
    """Nothing settles, nothing is met, and every null is null."""
    record = example_record()
    limits = record["limits"]
    for item in (limits["recommended"], *limits["alternatives"], *limits["rules"]):
        item["settling_time"] = item["residual_deviation"] = None
    shape = limits["landscape"]
    shape["settling_time"] = [[None for _ in row] for row in shape["settling_time"]]
    loop = record["loop"]
    loop["gain_margin_db"] = loop["phase_margin_deg"] = loop["bandwidth_hz"] = None
    loop["worst_corner"] |= dict.fromkeys(("gain_margin_db", "phase_margin_deg", "bandwidth_hz"))
    for move in record["moves"]:
        for response in (move["response"], *move["corners"]):
            response["settling_time"] = response["residual_deviation"] = None
            response["saturated"] = True
    record["optima"][0]["damping"] = None
    for item in record["loop"]["variants"]:
        item["settling_time"] = None
    for comparison in record["comparisons"][0]["controls"]:
        comparison["transfer_time"] = None
    record["robustness"] = _unsettled_robustness()
    for mode in limits["modes"]:
        mode["acceleration"] = mode["jerk"] = mode["jerk_time"] = None
        mode["settling_time"] = mode["residual_deviation"] = None
        mode["bound_by"] = mode["reason"] = to_json(NO_LIMITS)
        mode["meets_requirements"] = False
    limits["modes"][0]["attainable"] = 3.17e-6
    limits["recommended"]["valid_for"] = [{"smallest": 0.102, "largest": 0.102}]
    limits["listed_only"] = None
    limits["attainable"] = [
        {
            "requirement": "settling time",
            "limit": 0.2,
            "value": 0.2313,
            "unit": "s",
            "acceleration": 0.9,
            "jerk": 11.0,
            "together_with": [],
        }
    ]
    for item in limits["move_sizes"]:
        item["kept_from"] = item["kept_to"] = item["full_from"] = None
    record["assessment"] = {
        "met": False,
        "checks": [
            {
                "name": "settling time",
                "value": None,
                "limit": 0.2,
                "reserve": 1.0,
                "unit": "s",
                "met": False,
                "where": said("place", parts=(Message("place-move", number=1),)),
            }
        ],
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
    record["moves"] = [_move(move) for move in moves]
    record["optima"] = [_optima(move) for move in moves]
    record["comparisons"] = [_comparison() for _ in moves]
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
            _response() | {"payload": 1234.5 * k, "max_force": 1.2345e9} for k in range(27)
        ]
    best = record["limits"]["recommended"]
    best |= {"acceleration": 1.23456789e-5, "jerk": 9.87654321e12, "jerk_time": 1.234e-18}
    record["limits"]["rules"] = [
        _trial(f"{LONG} {k}", 1.0 + 1e-4 * k) | {"source": WORD} for k in range(14)
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
    record = example_record()
    record["machine"]["motion"] = "rotary"
    record["machine"]["kind"] = "modal"
    states = ["x", "v", "q_disc", "v_disc", "F"]
    units = {"x": "rad", "v": "rad/s", "q_disc": "N m s^2", "v_disc": "N m s", "F": "N m"}
    record["plant"]["states"] = states
    record["plant"]["A"] = [[0.0] * len(states) for _ in states]
    record["plant"]["B"] = [0.0] * len(states)
    record["plant"]["units"] = units | dict.fromkeys(OUTPUTS, "rad")
    names = dict(zip(STATES, ["q_disc", "x", "", "v_disc", "v", "", "F"], strict=True))
    for series in (record["moves"][0]["series"], record["optima"][0]["time"]["series"]):
        series["signals"] = {
            names.get(name, name): values
            for name, values in series["signals"].items()
            if names.get(name, name)
        }
    record["optima"][0]["damping"] = None
    for peaks in (record["moves"][0]["response"]["peaks"], record["optima"][0]["time"]["peaks"]):
        for name in STATES:
            value = peaks.pop(name)
            if names[name]:
                peaks[names[name]] = value
    record["data"] = [
        _datum("plant.modes.disc.damping_ratio", 0.0207, "-"),
        _datum("requirements.tcp_deviation", 2.5e-5, "rad"),
    ]
    return record


def _datum(key: str, value: float | str, unit: str) -> Any:
    return {"key": key, "value": value, "unit": unit, "source": "Table 1"}


def _series(end: float, extra: list[str]) -> Any:
    """Decaying vibrations, one frequency for each signal."""
    t = [end * i / 400 for i in range(401)]
    size = {"F_set": 1803.0, "F": 1702.0, "a_ref": 2.41, "v_ref": 0.102, "v_s": 0.1021}
    return {
        "t": t,
        "signals": {
            name: [size.get(name, 1e-5) * exp(-9 * s) * sin(2 * pi * (3 + k) * s / end) for s in t]
            for k, name in enumerate(["F_set", *STATES, *OUTPUTS, *extra])
        },
    }


def _optimum(move: dict[str, float], t_f: float) -> Any:
    return {
        "kind": "time",
        "method": "exact",
        "f_max": 2010.0,
        "move": move,
        "limits": {},
        "t_f": t_f,
        "arcs": [
            {"t_start": 0.0, "t_end": 0.00934, "control": "+F_max"},
            {"t_start": 0.00934, "t_end": 0.0367, "control": "-F_max"},
            {"t_start": 0.0367, "t_end": t_f, "control": "+F_max"},
        ],
        "switching_times": [0.00934, 0.0367],
        "touch_points": [],
        "peaks": {name: 0.00123 * (k + 1) for k, name in enumerate([*STATES, *OUTPUTS])},
        "terminal_error": dict.fromkeys(STATES, 1e-12),
        "cost": None,
        "cost_terms": {},
        "weights": {},
        "certificate": {
            "t_f_lower_bound": 0.0434,
            "relative_gap": 2.5e-11,
            "adjoint_initial": {"x_b": -11.88},
            "switching_slopes": [0.0082, -0.0083],
            "switching_law_holds": True,
            "terminal_jacobian_rank": 6,
            "terminal_jacobian_condition": None,
        },
        "series": _series(t_f, []),
    }


def _optima(move: dict[str, float]) -> Any:
    damping = _optimum(move, 0.0522) | {
        "kind": "damping",
        "cost": 448828.4,
        "weights": {"x_b": 1.8858e15},
        "certificate": {"adjoint_initial": {}, "law_residual": 6.04e-14},
    }
    return {
        "move": move,
        "time": _optimum(move, 0.0435),
        "constrained": None,
        "damping": damping,
        "band": {
            "t_f": 0.0431,
            "lower_bound": 0.043098,
            "gap": 4.6e-5,
            "band": 5e-6,
            "offset": 1.2e-6,
            "segments": [{"duration": 0.0431, "force": 1900.0}],
        },
        "robust": {
            "t_f": 0.0493,
            "band": 5e-6,
            "offset": 0.9e-6,
            "machines": 243,
            "peak": 4.98e-6,
            "segments": [{"duration": 0.0493, "force": 1700.0}],
        },
        "remarks": [said("damping-optimum-exceeds-velocity", times=1.25)],
    }


def _trial(name: str, scale: float) -> Any:
    return {**_alternative(name, scale), "source": "a handbook"}


def _alternative(name: str, scale: float) -> Any:
    return {"name": name, **_judged(scale)}


def _judged(scale: float) -> Any:
    return {
        "acceleration": 2.41 * scale,
        "jerk": 41.2 * scale,
        "jerk_time": 0.0585,
        "setpoint_filter": None,
        "settling_time": 0.1056 * scale,
        "residual_deviation": 4.582e-6 * scale,
        "peak_deviation": 9.47e-6 * scale,
        "meets_requirements": scale < 1.1,
        "keeps_reserve": scale < 0.9,
    }


def _limits() -> Any:
    return {
        "recommended": _judged(1.0)
        | {
            "keeps_reserve": True,
            "bound_by": said("bound-by-requirements", requirements=RESIDUAL_DEVIATION.message),
            "frequency_range": [0.9475, 1.0525],
            "damping_range": [0.61, 1.7],
            "valid_for": [{"smallest": 0.0, "largest": 0.102}],
            "worst_sizes": [
                {
                    "requirement": "residual deviation",
                    "value": 4.61e-6,
                    "bound": 4.63e-6,
                    "move": 1,
                    "size": 0.0173,
                }
            ],
        },
        "listed_only": _judged(0.9) | {"valid_for": [{"smallest": 0.102, "largest": 0.102}]},
        "today": None,
        "modes": [_mode("surface", 2e-6), _mode("accuracy", 5e-6), _mode("speed", 2e-5)],
        "would_bring": [
            {
                "name": "dsc",
                "change": said("change-dsc"),
                "settling_time": 0.0891,
                "saved": 0.0158,
                "share": 0.1506,
                "meets_requirements": True,
                "outcome": "",
            },
            {
                "name": "force-filters",
                "change": said("change-force-filters"),
                "settling_time": None,
                "saved": None,
                "share": None,
                "meets_requirements": False,
                "outcome": said("change-no-filters"),
            },
        ],
        "attainable": [],
        "move_sizes": [
            _move_sizes("way-recommended", 41.0, 0.0),
            _move_sizes("commissioning-rule", 24.0, 0.0),
            _move_sizes("way-listed", 52.0, 0.0199),
        ],
        "alternatives": [_alternative("gentler", 0.8)],
        "rules": [_trial("j = a f", 1.3), _trial("j = 10 a", 1.7)],
        "rule": {
            "text": to_json(DESCRIPTION),
            "formula": [
                {
                    "text": item.text,
                    "aside": item.aside and to_json(item.aside),
                }
                for item in formulas_for([VelocityStep(velocity_step=0.1)])
            ],
            "advice": to_json(ADVICE),
            "valid_for": to_json(VALIDITY),
            "acceleration": 1.4,
            "jerk": 24.0,
            "jerk_time": 1.4 / 24.0,
            "average": 0.05,
            "chosen": to_json(Message("rule-average", time=0.05)),
            "bound_by": to_json(Message("rule-force")),
            "predicted_settling_time": 0.14,
            "predicted_residual": 4.9e-6,
            "steps": [
                _step(Message("rule-speed-loop"), "Kp/m", 170.97, "1/s"),
                _step(
                    Message("rule-average-length"),
                    to_json(Message("rule-average", time=0.05)),
                    0.05,
                    "s",
                ),
                _step(
                    Message("rule-mode-passed", mode="base"),
                    "R(f T_F)",
                    0.4,
                    "1",
                ),
            ],
            "warnings": [],
        },
        "landscape": {
            "acceleration": [1.0, 2.0, 3.0],
            "jerk_time": [0.02, 0.04, 0.06, 0.08],
            "settling_time": [[0.3, 0.2, 0.15, 0.25], [0.2, 0.12, 0.11, 0.2], [None] * 4],
            "residual_deviation": [[9e-6, 5e-6, 4e-6, 6e-6], [5e-6, 4e-6, 3e-6, 5e-6], [None] * 4],
            "usage": [[0.4, 0.4, 0.4, 0.4], [0.8, 0.8, 0.7, 0.7], [1.2, 1.2, 1.1, 1.1]],
        },
        "warnings": [],
    }


def _mode(name: str, band: float) -> Any:
    return {
        "name": name,
        "band": band,
        "acceleration": 1.9,
        "jerk": 41.0,
        "jerk_time": 1.9 / 41.0,
        "bound_by": said("bound-by-requirements", requirements=RESIDUAL_DEVIATION.message),
        "settling_time": 0.11,
        "residual_deviation": 0.9 * band,
        "peak_deviation": 1.8 * band,
        "meets_requirements": True,
        "reason": "",
        "attainable": None,
    }


def _step(name: Message, how: object, value: float, unit: str) -> Any:
    return {"name": to_json(name), "formula": how, "value": value, "unit": unit}


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


def _move_sizes(way: str, jerk: float | None, time: float) -> Any:
    size = [0.00102 * 300 ** (k / 31) for k in range(32)]
    return {
        "way": to_json(Message(way)),
        "acceleration": 1.9,
        "jerk": jerk,
        "setpoint_filter": average(time) if time else None,
        "move": {"velocity_step": 0.102},
        "own": 0.102,
        "size": size,
        "settling_time": [0.06 + 0.4 * value for value in size],
        "residual_deviation": [4.5e-6 * (1.3 + sin(40.0 * value)) for value in size],
        "full_from": 0.0881,
        "kept_from": 0.0714,
        "kept_to": 0.1233,
    }


def _loop() -> Any:
    f = [0.1 * 10 ** (k / 20) for k in range(81)]
    return {
        "kind": "state-space",
        "jerk": "limit",
        "position_loop": "control",
        "features": [
            _feature("jerk", True, "MD32431", "A manual, p. 3", True),
            _feature("force_filters", True, "p1656", "", False),
            _feature("jerk_feedforward", False, "", "A manual, p. 3", True),
        ],
        "Kv": 42.79,
        "Kp": 128400.0,
        "Tn": 0.02337,
        "reference_model_time": 0.0,
        "reference_delay": 0.005625,
        "reference_age": 0.0026875,
        "velocity_age": 0.00275,
        "state_feedback": {"v_b": 1236.4},
        "feedforward": {"velocity": 1.0, "acceleration": 1.0, "jerk": 0.0, "mass": 752.0},
        "position_cycle": 0.002,
        "velocity_cycle": 0.000125,
        "force_lag": 0.0025,
        "motion_force": 2010.0,
        "force_filters": [
            {"kind": "notch", "natural_frequency": 452.0, "damping": 0.1, "width": 0.8}
        ],
        "encoder_resolution": 1e-8,
        "encoder_noise": {"tool": 3.3e-8, "force": 21.2},
        "sensors": ["encoder"],
        "observer": {
            "states": ["x_b", "v_b"],
            "sensors": ["encoder"],
            "A": [[0.0, 1.0], [0.0, 0.0]],
            "B": [0.0, 0.1],
            "C": [[1.0, 0.0]],
            "L": [[0.1], [0.2]],
        },
        "closed_loop": {
            "A": [[0.0]],
            "B": [[0.0]],
            "C": [[0.0]],
            "D": [[0.0]],
            "dt": 0.002,
            "states": ["x_b"],
            "inputs": ["x_ref"],
            "outputs": ["tcp"],
        },
        "poles": [[-22.5, 452.2], [-22.5, -452.2], [-31.78, 0.0]],
        "gain_margin_db": 13.52,
        "phase_margin_deg": 31.84,
        "sensitivity_peak": 1.921,
        "bandwidth_hz": 23.96,
        "dynamic_stiffness": 6.724e6,
        "weakest_frequency_hz": 14.87,
        "mode_damping": {"base": 0.2075},
        "candidates": [
            _candidate(0.1, 5e6, classic=True),
            _candidate(0.102, 6.1e6, used=True),
            _candidate(0.104, 6.0e6),
            _candidate(0.13, 7e6),
        ],
        "reasons": [said("state-feedback-stiffness", ratio=1.1)],
        "variants": [
            _variant("without-state-feedback", 1.0, used=False),
            _variant("with-state-feedback", 1.1, used=True),
        ],
        "worst_corner": {
            "gain_margin_db": 12.31,
            "phase_margin_deg": 30.12,
            "sensitivity_peak": 1.985,
            "bandwidth_hz": 21.7,
            "dynamic_stiffness": 6.1e6,
        },
        "cross_check": {
            "pole_difference": 7e-15,
            "gain_margin_db": 13.5,
            "phase_margin_deg": 33.1,
        },
        "gain_margin_up_db": None,
        "gain_margin_down_db": 13.5,
        "worst_mode_damping": {"base": 0.18, "rotation": 0.047},
        "corners": [_loop_corner(1.0), _loop_corner(0.95), _loop_corner(1.05)],
        "delays": [
            _delay("path-position-setpoint", age=5.625e-3),
            _delay("path-position-controller", dead=2e-3, hold=0.9375e-3),
            _delay("path-velocity-feed-forward", age=2.6875e-3, dead=2e-3, hold=0.9375e-3),
            _delay("path-wanted-state", age=2.6875e-3, dead=2e-3, hold=0.9375e-3),
            _delay("path-force-feed-forward", dead=2.125e-3, hold=1e-3, lag=2.5e-3),
            _delay("path-velocity-controller", dead=0.125e-3, hold=0.0625e-3, lag=2.5e-3),
        ],
        "disturbance": {
            "t": [5e-4 * k for k in range(600)],
            "signals": {
                name: [peak * sin(0.05 * k) * exp(-0.02 * k) for k in range(600)]
                for name, peak in (
                    ("without-state-feedback", 1.1e-7),
                    ("with-state-feedback", 0.5e-7),
                )
            },
        },
        "bode": {
            "t": f,
            "signals": {
                "open_loop_db": [60 - 20 * k / 20 for k in range(81)],
                "open_loop_deg": [92.0 + k for k in range(81)],
                "closed_velocity_db": [-k / 4 for k in range(81)],
            },
        },
        "remarks": [said("loop-tn-yaskawa")],
        "warnings": [],
    }


def _candidate(settling: float, stiffness: float, *, classic=False, used=False) -> Any:
    return {
        "Kv": 42.79,
        "Kp": 128400.0,
        "Tn": 0.02337,
        "state_feedback": used,
        "settling_time": settling,
        "meets_requirements": True,
        "classic": classic,
        "used": used,
        "gain_margin_db": 12.3,
        "phase_margin_deg": 30.1,
        "sensitivity_peak": 1.98,
        "bandwidth_hz": 21.7,
        "dynamic_stiffness": stiffness,
    }


def _feature(name: str, has: bool, parameters: str, source: str, verified: bool) -> Any:
    return {
        "name": name,
        "has": has,
        "parameters": parameters,
        "source": source,
        "verified": verified,
    }


def _loop_corner(factor: float) -> Any:
    return {
        "payload": 0.0,
        "frequency_factor": factor,
        "damping_factor": 1.0,
        "state": "",
        "gain_margin_db": 13.5,
        "phase_margin_deg": 31.8,
        "sensitivity_peak": 1.92,
        "bandwidth_hz": 23.8 * factor,
        "dynamic_stiffness": 6.7e6 * factor,
        "mode_damping": {"base": 0.2 * factor, "rotation": 0.0497},
    }


def _delay(
    path: str, *, age: float = 0.0, dead: float = 0.0, hold: float = 0.0, lag: float = 0.0
) -> Any:
    return {
        "path": {"message": path, "values": {}},
        "setpoint_age": age,
        "dead_time": dead,
        "hold": hold,
        "lag": lag,
        "total": age + dead + hold + lag,
    }


def _variant(name: str, scale: float, *, used: bool) -> Any:
    return {
        "name": to_json(Message(name)),
        "used": used,
        "mode_damping": {"base": 0.2075 * scale},
        "gain_margin_db": 13.52 * scale,
        "phase_margin_deg": 31.84 * scale,
        "sensitivity_peak": 1.921 * scale,
        "bandwidth_hz": 23.96 * scale,
        "dynamic_stiffness": 6.724e6 * scale,
        "weakest_frequency_hz": 14.87 * scale,
        "settling_time": 0.1056 * scale,
        "residual_deviation": 4.582e-6 * scale,
        "max_force": 1730.0 * scale,
    }


def _robustness() -> Any:
    factor = [0.9 + 0.0025 * k for k in range(81)]
    residual = [4.61e-6 + 41e-6 * abs(value - 1.0) for value in factor]
    kept = [value for value, one in zip(factor, residual, strict=True) if one <= 5.1e-6]
    shares = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0]
    return {
        "monte_carlo": {
            "samples": 1013,
            "seed": 17,
            "share_met": 0.841,
            "share_in_band": 0.852,
            "quantiles": [
                {
                    "share": share,
                    "settling_time": 0.1161 + 0.023 * share**3,
                    "residual_deviation": 3.02e-6 + 3.6e-6 * share,
                }
                for share in shares
            ],
        },
        "frequency_error": {
            "factor": factor,
            "settling_time": [0.1161 if one <= 5.1e-6 else 0.1347 for one in residual],
            "residual_deviation": residual,
            "kept_from": kept[0],
            "kept_to": kept[-1],
        },
        "damping_error": {"factor": [0.3, 0.61, 1.0, 1.37, 1.7], "kept_from": 0.61, "kept_to": 1.7},
        "warnings": [],
    }


def _unsettled_robustness() -> Any:
    """No spread stated, and nothing settles anywhere."""
    found = _robustness()
    error = found["frequency_error"]
    error["settling_time"] = error["residual_deviation"] = [None for _ in error["factor"]]
    error["kept_from"] = error["kept_to"] = None
    found["damping_error"] |= {"kept_from": None, "kept_to": None}
    return {**found, "monte_carlo": None}


def _settles(nominal: float, worst: float) -> Message:
    times = (Message("time-value", time=time) for time in (nominal, worst))
    return Message("settles-on-both", **dict(zip(("nominal", "worst"), times, strict=True)))


def _comparison() -> Any:
    control = {
        "name": said("trapezoidal-in-the-loop"),
        "transfer_time": 0.1051,
        "overshoot": 0.0213,
        "peaks": {name: 0.00345 * (k + 1) for k, name in enumerate([*STATES, *OUTPUTS])},
        "max_force": 1801.0,
        "heat": 79717.0,
        "work": 3.912,
    }
    claims = [
        said(
            "claim-rectangular",
            overshoot=Message("claim-overshoot", overshoot=0.126),
            transfer=Message("claim-transfer", time=0.1692, times=3.89, least=0.04352),
        ),
        said(
            "claim-trapezoidal",
            overshoot=Message("claim-no-overshoot"),
            transfer=Message("claim-transfer", time=0.1042, times=2.39, least=0.04352),
        ),
    ]
    why_not = [
        said(
            "fed-forward-outcome",
            name=Message("control-time-optimal"),
            outcome=_settles(0.04365, 0.098),
            left=37.8e-6,
        ),
        said("recommended-outcome", outcome=_settles(0.1042, 0.1103), left=6.1e-6),
        said("why-controls-take-limits", band=5e-6, spread=0.05),
    ]
    return {
        "controls": [control],
        "claims": claims,
        "why_not_the_optimum": why_not,
    }


def _response() -> Any:
    return {
        "payload": 0.0,
        "frequency_factor": 1.0,
        "damping_factor": 1.0,
        "state": "",
        "settling_time": 0.1049,
        "residual_deviation": 4.581e-6,
        "peak_deviation": 9.46e-6,
        "mode_amplitudes": {"base": 1.67e-6},
        "peaks": {name: 0.00234 * (k + 1) for k, name in enumerate([*STATES, *OUTPUTS])},
        "max_force": 1803.0,
        "rms_force": 886.3,
        "saturated": False,
    }


def _move(move: dict[str, float]) -> Any:
    worse = _response() | {"frequency_factor": 0.948, "settling_time": 0.1056}
    return {
        "move": move,
        "setpoint": {
            "duration": 0.0999,
            "setpoint_filter": None,
            "segments": [{"duration": 0.0585, "jerk": 41.2}, {"duration": 0.0414, "jerk": -41.2}],
        },
        "response": _response(),
        "corners": [_response(), worse],
        "series": _series(0.25, REFERENCES),
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
    old = today_of(subject, subject.fastest)
    entries = [
        Entry(
            row=row,
            value=row.encode(values[row.key]),
            old=row.encode(old[row.key]) if row.key in old else "",
        )
        if row.setting is not Setting.FIXED
        else Entry(row=row, value=row.encode("set"))
        for row in rows
        if row.key in values or row.setting is Setting.FIXED
    ]
    return Export(
        control=kind.key,
        header=(),
        entries=tuple(entries),
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
        "drive": machine.drive.kind.value,
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
    for key in ("optima", "moves", "comparisons"):
        (first,) = record[key]
        record[key] = [deepcopy(first) for _ in moves]
    for move, optima, entry in zip(moves, record["optima"], record["moves"], strict=True):
        optima["move"] = entry["move"] = optima["time"]["move"] = move
    limits, loop = record["limits"], record["loop"]
    sizes = [move.get("velocity_step") or move["distance"] for move in moves]
    limits["recommended"] |= {
        "setpoint_filter": average(0.016),
        "valid_for": [{"smallest": 0.0, "largest": size} for size in sizes],
    }
    limits["move_sizes"] = [
        item | {"move": move} for move in moves for item in limits["move_sizes"]
    ]
    limits["would_bring"] = [limits["would_bring"][0] for _ in range(6)]
    kind = machine.control.kind
    loop |= {
        "kind": kind.key,
        "jerk": kind.jerk.value,
        "position_loop": machine.control.position_loop.value,
        "features": to_plain(feature_entries(kind)),
        "mode_damping": damping,
        "worst_mode_damping": damping,
        "state_feedback": dict.fromkeys(STATES, 1236.4) if kind.state_feedback else {},
        "reasons": loop["reasons"] * 4,
    }
    for variant in loop["variants"]:
        variant["mode_damping"] = damping
    (check,) = record["assessment"]["checks"]
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
