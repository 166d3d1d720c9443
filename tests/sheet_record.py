"""Records of runs: of the example machines as they are, and some with the numbers that tests quote,
made up so that a misplaced one is noticed.

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
from mtcommission.export.write import type_in
from mtcommission.limits.requirements import RESIDUAL_DEVIATION, SET_FORCE
from mtcommission.machine.profile.read import profile_text_hash
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.record.limits import limits_answer
from mtcommission.record.record import Record
from mtcommission.record.shape import dump_json, find_checksum, to_entry, to_plain
from mtcommission.sheet import content

Json = dict[str, Any]

HOSTILE = '<script>alert("1")</script> #set text(red) [bold]x[/bold] $x_1$ \\u{41} &amp; ÄÖÜß µ'
"""Markup of every printer at once, 80 characters or so, with umlauts."""

LONG = "Fräs- und Bohrwerk mit Portal, Werkstückmanipulator Ä Ö Ü ß & <b>x</b> Nr. 12345-67890"
WORD = "Donaudampfschifffahrtsgesellschaftskapitänsmützenhalterungsschraubensicherungsblech"
"""Names as long as a profile may make them, one of them a single word."""


@cache
def _ran(text: str) -> str:
    """The record of a profile's run, and what ``limits`` would print; computed once by all
    processes of a session."""
    session = os.environ.get("PYTEST_XDIST_TESTRUNUID", str(os.getpid()))
    name = f"mtcommission-{session}-{profile_text_hash(text.encode())[:12]}"
    file = Path(tempfile.gettempdir()) / f"{name}.json"
    with FileLock(file.with_suffix(".lock")):
        if not file.exists():
            profile = file.with_suffix(".toml")
            profile.write_text(text, "utf-8")
            found = mtcommission.run(profile)
            made = mtcommission.make_record(found), limits_answer(found)
            file.write_text(json.dumps([json.loads(dump_json(one)) for one in made]), "utf-8")
    return file.read_text("utf-8")


def run_of(text: str) -> tuple[Json, Json]:
    """The record of a profile's run, and what ``limits`` would print."""
    record, answer = json.loads(_ran(text))
    return record, answer


def shipped_record(name: str) -> Json:
    """The record of an example machine, as ``run`` writes it."""
    return run_of(read_shipped(name).text)[0]


def said(kind: str, **values: Value) -> Any:
    """What the program says, as a record holds it."""
    return to_json(Message(kind, **values))


def on_json(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of records as one of records in JSON."""

    @wraps(function)
    def call(*values: Any, **named: Any) -> Any:
        return function(*map(_read, values), **{key: _read(value) for key, value in named.items()})

    return call


def own_export(record: Json) -> Any:
    """The export for a record's own control; for one and the same record written only once."""
    return _own_export(json.dumps(record))


@cache
def _own_export(record: str) -> Any:
    return on_json(type_in)(json.loads(record))


def _with_export(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of a record and its export as one of a record in JSON."""

    def call(record: Json, *values: Any, **named: Any) -> Any:
        return on_json(function)(record, own_export(record), *values, **named)

    return call


compose, print_html, print_pdf = map(
    _with_export, (content.compose, content.print_html, content.print_pdf)
)


def _read(value: Any) -> Any:
    is_record = isinstance(value, dict) and "checksum" in value
    return to_entry(to_plain(value), Record) if is_record else value


def example_record() -> Json:
    """One move, all requirements met; sealed as a run does it."""
    record = shipped_record("milling-manipulator")
    _quote(record)
    return {**record, "checksum": find_checksum(record)}


def _quote(record: Json) -> None:
    """What the tests speak of."""
    speed = {"velocity_step": 0.102}
    limits, loop, (move,), (optima,) = (
        record[key] for key in ("limits", "loop", "moves", "optima")
    )
    record |= {
        "profile": {"name": "mill.toml", "sha256": "0123456789abcdef" * 4, "text": "schema = 1\n"},
        "assumptions": [said("assumption-linear")],
        "warnings": [said("loop-unseen-modes", modes="rotation")],
        "what_if": None,
        "data": [
            _datum("control.kind", "state-space", "") | {"source": said("source-default")},
            _datum("plant.base_mass", 451.0, "kg"),
            _datum("drive.max_force", 2010.0, "N"),
            _datum("moves[1].velocity_step", 0.102, "m/s"),
            _datum("requirements.tcp_deviation", 5.1e-6, "m"),
            _datum("requirements.frequency_spread", 0.052, "-"),
            _datum("requirements.reserve.band", 0.93, "-"),
            _datum("requirements.reserve.force", 0.97, "-"),
            _datum("requirements.peaks.v_phi", 0.0053, "SI"),
        ],
    }
    record["machine"]["source"] = "Table 1"
    mode = {"name": "base", "frequency_hz": 50.03, "damping_ratio": 0.0301}
    record["plant"]["modes"] = [record["plant"]["modes"][0] | mode]
    (check, *_) = record["assessment"]["checks"]
    record["assessment"]["checks"] = [check | {"value": 4.582e-6, "limit": 5.1e-6, "reserve": 0.93}]
    move["move"] = optima["move"] = optima["time"]["move"] = speed
    move["response"] |= {
        "residual_deviation": 4.581e-6,
        "peak_deviation": 9.46e-6,
        "mode_amplitudes": {"base": 1.67e-6},
    }
    limits["recommended"] |= {
        "settling_time": 0.1056,
        "residual_deviation": 4.582e-6,
        "peak_deviation": 9.47e-6,
        "acceleration": 2.41,
        "jerk": 41.2,
        "jerk_time": 0.0585,
        "setpoint_filter": None,
        "bound_by": said("bound-by-requirements", requirements=RESIDUAL_DEVIATION.message),
        "valid_for": [{"smallest": 0.0, "largest": 0.102}],
    }
    limits["recommended"]["worst_sizes"] = limits["recommended"]["worst_sizes"][:1]
    limits["warnings"] = loop["warnings"] = record["robustness"]["warnings"] = []
    for sizes in limits["move_sizes"]:
        sizes["move"] = speed
    loop |= {
        "Kv": 42.79,
        "motion_force": 2010.0,
        "mode_damping": {"base": 0.2075},
        "worst_mode_damping": {"base": 0.2075},
        "force_filters": [
            {"kind": "notch", "natural_frequency": 452.0, "damping": 0.1, "width": 0.8}
        ],
    }
    record["robustness"]["frequency_error"] |= {"kept_from": 0.99, "kept_to": 1.01}
    record["robustness"]["damping_error"] |= {"kept_from": 0.61}


UNKNOWN = (
    *("settling_time", "residual_deviation", "kept_from", "kept_to", "full_from"),
    *("damping", "listed_only"),
)
"""What may be null, wherever it stands but in the loop."""


def _forget(item: Any, *, is_unknown: bool = False) -> Any:
    if isinstance(item, list):
        return [_forget(one, is_unknown=is_unknown) for one in item]
    if is_unknown:
        return None
    if isinstance(item, dict):
        return {key: _forget(value, is_unknown=key in UNKNOWN) for key, value in item.items()}
    return item


def unsettled_record() -> Json:
    """Nothing settles, nothing is met, and every null is null."""
    record = example_record()
    for part in ("limits", "moves", "optima", "robustness"):
        record[part] = _forget(record[part])
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
        | {"limits": {"acceleration": 0.9, "jerk": 11.0, "setpoint_filter": None}}
    ]
    check = missed | {"name": "settling time", "value": None, "reserve": 1.0, "met": False}
    record["assessment"] = {
        "met": False,
        "checks": [check | {"where": said("place", parts=(place,))}],
        "obstacle": "settling time",
    }
    return record


def five_moves_record() -> Json:
    """Five moves with bounded optima, nine corners, long and hostile names everywhere, numbers of
    every size."""
    record = example_record()
    moves = [
        {"velocity_step": 0.102},
        {"distance": 0.0203, "max_velocity": 0.504},
        {"distance": 0.105},
        {"velocity_step": 0.0506},
        {"distance": 0.00107, "dwell": 0.2},
    ]
    _repeat(record, moves)
    limits, loop = record["limits"], record["loop"]
    names = [WORD, LONG, HOSTILE, "mode<script>"]
    damping = {name: 0.12345 * 10.0**-k for k, name in enumerate(names)}
    record["machine"] |= {"name": HOSTILE, "source": f"{WORD} {LONG} {LONG}"}
    record["profile"] |= {"name": HOSTILE, "text": f"# {HOSTILE}\n{WORD * 4}\n" * 9}
    record["warnings"] = [f"{LONG} {WORD} {HOSTILE}"] * 4
    record["assumptions"] = loop["remarks"] = [HOSTILE]
    mode = record["plant"]["modes"][0]
    record["plant"]["modes"] = [
        mode | {"name": name, "frequency_hz": 10.0**k, "tcp_gain": -1.2345e-7 * 10.0**k}
        for k, name in enumerate(names)
    ]
    for item in (loop, *loop["variants"]):
        item["mode_damping"] = damping
    loop["poles"] = [[-(10.0**k), 10.0**k * (k % 2)] for k in range(-3, 24)]
    for move, optima in zip(record["moves"], record["optima"], strict=True):
        move["response"]["mode_amplitudes"] = damping
        move["corners"] = [
            move["response"] | {"payload": 1234.5 * k, "max_force": 1.2345e9} for k in range(9)
        ]
        optima["constrained"] = deepcopy(optima["time"]) | {"limits": {"v_phi": 0.0053}}
    limits["rules"] = [
        limits["rules"][0] | {"name": f"{LONG} {k}", "source": WORD} for k in range(5)
    ]
    for item in limits["alternatives"]:
        item["name"] = HOSTILE
    sizes = [move.get("velocity_step") or move["distance"] for move in moves]
    limits["recommended"] |= {
        "acceleration": 1.23456789e-5,
        "jerk": 9.87654321e12,
        "bound_by": HOSTILE,
        "valid_for": [{"smallest": size, "largest": size} for size in sizes],
        "worst_sizes": [],
    }
    limits["listed_only"] = None
    record["data"] += [
        _datum(f"plant.{WORD}_{k}", 10.0 ** (3 * k - 30), "N s/m") | {"source": LONG}
        for k in range(21)
    ]
    return record


def _repeat(record: Json, moves: list[dict[str, float]]) -> None:
    """The first move's entries for each of some moves."""
    for key in ("optima", "moves"):
        record[key] = [deepcopy(record[key][0]) for _ in moves]
    for move, optima, entry in zip(moves, record["optima"], record["moves"], strict=True):
        optima["move"] = entry["move"] = optima["time"]["move"] = move


def rotary_record() -> Json:
    """A rotary table with one mode."""
    record = shipped_record("rotary-table") | {"what_if": None}
    return record | {"checksum": find_checksum(record)}


def _datum(key: str, value: float | str, unit: str) -> Any:
    return {"key": key, "value": value, "unit": unit, "source": "Table 1"}


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
    record["assessment"] |= {"met": False, "obstacle": check["name"]}
    check |= {"value": 1.3 * check["limit"], "met": False}
    record["limits"]["attainable"] = [
        {
            "requirement": name,
            "limit": limit,
            "value": 1.3 * limit,
            "unit": unit,
            "limits": {"acceleration": 0.9, "jerk": 11.0, "setpoint_filter": None},
            "together_with": [],
        }
        for name, limit, unit in (("residual deviation", 5e-6, "m"), ("settling time", 0.1, "s"))
    ]
    return record
