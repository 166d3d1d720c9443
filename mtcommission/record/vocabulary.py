"""What a record's words, names and numbers may be, beyond the form of each.

Printers look a word up, take a signal by its name and divide by a time: what is not there, or is
nothing, would be met somewhere inside.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass

from mtcommission.control_kinds.kind import (
    FEATURES,
    FIR,
    MOVING_AVERAGE,
    SHAPERS,
    TWO_AVERAGES,
    PositionLoop,
)
from mtcommission.control_kinds.kinds import KINDS as CONTROL_KINDS
from mtcommission.machine.control import FilterKind
from mtcommission.machine.machine import DriveKind, Motion
from mtcommission.messages.message import Message
from mtcommission.plant.kinds import KINDS as PLANT_KINDS
from mtcommission.record.schema.identified import MeasuredResponseEntry
from mtcommission.record.schema.limits import (
    Alternative,
    Landscape,
    LimitsEntry,
    ListedEntry,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleResult,
    RuleText,
    TodayEntry,
)
from mtcommission.record.schema.loop import (
    CandidateEntry,
    FeatureEntry,
    LoopCornerEntry,
    LoopPart,
    VariantEntry,
)
from mtcommission.record.schema.machine import MachineEntry, PlantEntry
from mtcommission.record.schema.moves import MoveEntry, ResponseEntry
from mtcommission.record.schema.optima import BandEntry, OptimumEntry, RobustEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.robustness import FrequencyErrorEntry
from mtcommission.record.schema.values import ForceFilterEntry, SetpointFilterEntry
from mtcommission.record.schema.what_if import (
    KnownLimitsEntry,
    NeedsEntry,
    SampledEntry,
    WhatIfPart,
)

JERKS = ("limit", "time", "none")
"""How a control limits the jerk."""

WORDS: Mapping[type, Mapping[str, Sequence[str]]] = {
    MachineEntry: {
        "motion": [motion.value for motion in Motion],
        "drive": [kind.value for kind in DriveKind],
        "kind": list(PLANT_KINDS),
    },
    LoopPart: {
        "kind": list(CONTROL_KINDS),
        "jerk": JERKS,
        "position_loop": [place.value for place in PositionLoop],
    },
    WhatIfPart: {"jerk": JERKS},
    SetpointFilterEntry: {"kind": (MOVING_AVERAGE, TWO_AVERAGES, FIR, *SHAPERS)},
    ForceFilterEntry: {"kind": [kind.value for kind in FilterKind]},
    FeatureEntry: {"name": FEATURES},
    OptimumEntry: {"kind": ("time", "damping")},
    ModeLimitsEntry: {"name": ("surface", "accuracy", "speed")},
    KnownLimitsEntry: {"name": ("today", "recommended")},
}
"""What each word of an entry may be."""

LOOPS = ("without-state-feedback", "with-state-feedback", "loop-in-use")
"""Whose answer to a disturbance there may be."""

LIMITS = ("acceleration", "jerk", "settling_time")

ABOVE_ZERO: Mapping[type, Sequence[str]] = {
    PlantEntry: ("moving_mass",),
    OptimumEntry: ("f_max", "t_f"),
    BandEntry: ("t_f", "band"),
    RobustEntry: ("t_f", "band"),
    LimitsEntry: (*LIMITS, "jerk_time"),
    CandidateEntry: ("settling_time", "dynamic_stiffness"),
    RuleText: ("acceleration", "jerk", "jerk_time"),
    LoopPart: ("position_cycle", "velocity_cycle", "motion_force"),
    SampledEntry: ("velocity_cycle", "cycles"),
    NeedsEntry: ("tcp_deviation", "motion_force"),
    **dict.fromkeys((Alternative, RuleResult, ListedEntry), LIMITS),
    KnownLimitsEntry: ("acceleration", "jerk"),
    TodayEntry: ("acceleration", "jerk_time"),
    Landscape: ("acceleration", "jerk_time"),
    MoveSizesEntry: ("acceleration", "own", "size"),
    FrequencyErrorEntry: ("factor",),
    MeasuredResponseEntry: ("frequency_hz", "curve_hz"),
}
"""Numbers, and arrays of them, by which something is divided, or whose logarithm is drawn."""

LEAST = 1e-30
"""Of such a number: far below anything that a run writes, far above what overflows when divided."""

SIZES = ("velocity_step", "distance")
"""One of them says what a move is."""

REFERENCES = ("x_ref_delayed", "v_ref", "a_ref", "j_ref", "deviation", "F_set")
"""Signals of a simulated move beside those of the plant."""

FORCE_LIMITS = ("drive.max_force", "drive.max_acceleration")
"""Key of the datum that bounds F_set, of an axis with a drive and of a motor that follows."""

BODE = ("open_loop_db", "open_loop_deg", "closed_velocity_db")


def walk(key: str, value: object) -> Iterator[tuple[str, object]]:
    """Yield every entry in a record, with its key.

    Parameters
    ----------
    key
        Of the value; "" for the record.
    value
        An entry, or what holds some.

    Yields
    ------
    str, object
    """
    if is_dataclass(value):
        yield key, value
        for field in fields(value):
            below = f"{key}.{field.name}" if key else field.name
            yield from walk(below, getattr(value, field.name))
    elif isinstance(value, Mapping):
        for name, inner in value.items():
            yield from walk(f"{key}.{name}", inner)
    elif isinstance(value, list) and value and not isinstance(value[0], float):
        for i, inner in enumerate(value, start=1):
            yield from walk(f"{key}[{i}]", inner)


def find_unknown_words(record: Record) -> Iterator[Message]:
    """Yield each word that is none of those it may be."""
    for key, entry in walk("", record):
        for name, words in WORDS.get(type(entry), {}).items():
            got = getattr(entry, name)
            if got not in words:
                yield _unknown(f"{key}.{name}", got, words)
    for name in record.loop.disturbance.signals:
        if name not in LOOPS:
            yield _unknown("loop.disturbance.signals", name, LOOPS)


def _unknown(key: str, got: str, words: Sequence[str]) -> Message:
    return Message("record-word-unknown", key=key, got=got, words=", ".join(words))


def find_too_small(record: Record) -> Iterator[Message]:
    """Yield each number that is next to nothing, or less, where something is divided by it."""
    for key, entry in walk("", record):
        for name in ABOVE_ZERO.get(type(entry), ()):
            value = getattr(entry, name)
            got = min(value, default=LEAST) if isinstance(value, list) else value
            if got is not None and not got >= LEAST:
                yield Message("record-too-small", key=f"{key}.{name}", got=got, least=LEAST)


def find_missing_names(record: Record) -> Iterator[Message]:
    """Yield where a signal, a state, a mode or the size of a move is missing."""
    for key, names, needed in _named(record):
        missing = [name for name in needed if name not in names]
        if missing:
            yield Message("record-names-missing", key=key, names=", ".join(missing))
    bounds = [datum.value for datum in record.data if datum.key in FORCE_LIMITS]
    if not any(not isinstance(bound, str) and bound > 0.0 for bound in bounds):
        yield Message("record-names-missing", key="data", names=" / ".join(FORCE_LIMITS))
    for key, move in _moves(record):
        if sum(name in move for name in SIZES) != 1:
            yield Message("record-move-of-no-size", key=key)


def _named(record: Record) -> Iterator[tuple[str, Mapping[str, object], Sequence[str]]]:
    """Key, what has names there, and the names that there must be."""
    plant, loop, follows = record.plant, record.loop, record.machine.follows
    signals = [*plant.states, *plant.outputs]
    modes = [mode.name for mode in plant.modes]
    yield "plant.units", plant.units, signals
    for key, entry in walk("", record):
        match entry:
            case MoveEntry():
                yield f"{key}.series.signals", entry.series.signals, [*REFERENCES, *signals]
            case OptimumEntry():
                yield f"{key}.series.signals", entry.series.signals, ["F_set", *signals]
                yield f"{key}.peaks", entry.peaks, signals
            case ResponseEntry():
                yield f"{key}.mode_amplitudes", entry.mode_amplitudes, modes
                yield f"{key}.peaks", entry.peaks, signals
            case VariantEntry() | LoopCornerEntry():
                yield f"{key}.mode_damping", entry.mode_damping, modes
    if not follows:
        yield "loop.bode.signals", loop.bode.signals, BODE
        yield "loop.worst_mode_damping", loop.worst_mode_damping, modes


def _moves(record: Record) -> Iterator[tuple[str, Mapping[str, float]]]:
    for key, entry in walk("", record):
        move = getattr(entry, "move", None)
        if isinstance(move, Mapping):
            yield f"{key}.move", move
        if isinstance(entry, WhatIfPart):
            for number, each in enumerate(entry.moves, start=1):
                yield f"{key}.moves[{number}]", each
