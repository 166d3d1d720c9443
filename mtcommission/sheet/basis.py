"""For what the verdict holds, and on what it rests: control, reserve, measured and assumed data."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.machine.checks import OF_LOOP, mark_assumed, name_control, say_loop
from mtcommission.record.machine import say_assumed
from mtcommission.record.moves import DampingErrorEntry, FrequencyErrorEntry
from mtcommission.sheet.tables import show

if TYPE_CHECKING:
    from mtcommission.record.read_back import AxisRecord
    from mtcommission.record.record import Record

Row = tuple[str, str]

MARKED = (
    *("control.", "requirements.reserve", "requirements.payload (least)"),
    *("requirements.frequency_spread", "requirements.damping_spread"),
)
"""Beginnings of the keys that other rows of page 1 mark, or that the largest payload stands for."""


def find_number(record: Record, key: str) -> float | None:
    """Return a number of the profile [SI]; None where the record does not state it."""
    values = (item.value for item in record.data if item.key == key)
    value = next(values, None)
    return float(value) if isinstance(value, float | int) else None


def find_band(record: Record) -> float | None:
    """Return the permitted TCP deviation [m or rad]; None where the record does not state it."""
    return find_number(record, "requirements.tcp_deviation")


def is_assumed(record: AxisRecord, key: str) -> bool:
    """Return whether a key, or one that begins so, was not stated by anybody."""
    return any(item.is_assumed for item in record.data if item.key.startswith(key))


def holds_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return for which moves, frequencies, damping ratios and payloads all is kept."""
    text, error = words.text, record.robustness
    rows = [
        (text("basis-sizes"), _sizes(record, words)),
        (text("frequencies"), _spread(record, "frequency", error.frequency_error, words)),
        (text("basis-damping"), _spread(record, "damping", error.damping_error, words)),
    ]
    low, high = (
        find_number(record, f"requirements.payload ({end})") or 0.0 for end in ("least", "largest")
    )
    if high > low:
        said = text("payload-from-to", low=show(low, words, "kg"), high=show(high, words, "kg"))
        rows.append((text("payload"), _marked(record, "requirements.payload", said, words)))
    return tuple(rows)


def basis_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return the control and its loop, the reserve, and what the encoder's steps do."""
    text, loop = words.text, record.loop
    reserve = {
        name: find_number(record, f"requirements.reserve.{name}") or 0.0
        for name in ("band", "force")
    }
    said = _marked(record, "requirements.reserve", text("reserve-kept", **reserve), words)
    rows = [(text("control"), _control(record, words)), (text("name-reserve"), said)]
    if loop.encoder_noise is not None:
        steps = text(
            "encoder-steps",
            resolution=show(loop.encoder_resolution, words, "m"),
            tool=show(loop.encoder_noise.tool, words, "m"),
            force=show(loop.encoder_noise.force, words, "N"),
        )
        rows.append((words.name("encoder"), steps))
    return tuple(rows)


def data_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return where the machine data come from: stated, measured, and assumed."""
    text, part, source = words.text, record.identified, words.say(record.machine.source)
    assumed = assumed_rows(record, words)
    if part is None:
        return ((text("basis-data"), text("measured-nothing", source=source)), *assumed)
    modes = ", ".join(mode.name for mode in part.modes)
    measured = text("measured-modes", modes=modes, date=part.created[:10])
    return ((text("basis-data"), source), (text("measured"), measured), *assumed)


def assumed_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return the other values that nobody stated, in one row; nothing where all were."""
    others = [item for item in record.data if not item.key.startswith(MARKED)]
    said = say_assumed(others, record.plant.units, words)
    return ((words.text("basis-assumed"), "; ".join(said)),) if said else ()


def kept_sentence(record: Record, words: Catalogue) -> str:
    """Return between which frequency errors every requirement is kept, as a sentence."""
    kept = _kept_ends(record.robustness.frequency_error, words)
    return words.text("kept-between", **kept) if kept else words.text("kept-nowhere")


def _control(record: Record, words: Catalogue) -> str:
    loop = record.loop
    name = _marked(record, "control.kind", name_control(loop.kind, words), words)
    keys = [item.key for item in record.data if item.key in OF_LOOP]
    assumed = [key for key in keys if is_assumed(record, key)]
    place = "" if record.machine.follows else loop.position_loop
    said = say_loop(place, loop.position_cycle, loop.velocity_cycle, words)
    return f"{name}; {mark_assumed(said, keys, assumed, words)}"


def _spread(
    record: Record, kind: str, error: FrequencyErrorEntry | DampingErrorEntry, words: Catalogue
) -> str:
    """The spread that was asked for, and the range in which all is kept."""
    key, kept = f"requirements.{kind}_spread", _kept_ends(error, words)
    spread, said = find_number(record, key), words.text("spread-none")
    if spread:
        said = _marked(record, key, words.text("spread", spread=spread), words)
    where = words.text("all-kept-between", **kept) if kept else words.text("not-kept-nominally")
    return f"{said}; {where}"


def _kept_ends(error: FrequencyErrorEntry | DampingErrorEntry, words: Catalogue) -> dict[str, str]:
    """Both ends of the range that is kept; empty if not even the profile's own values are."""
    low, high = error.kept_from, error.kept_to
    if low is None or high is None:
        return {}
    shown = {}
    for name, end, tried in (("low", low, error.factor[0]), ("high", high, error.factor[-1])):
        value = words.format.signed_percent(end - 1.0)
        # Beyond the last one tried nothing is known.
        shown[name] = words.text("at-least", value=value) if end == tried else value
    return shown


def _sizes(record: Record, words: Catalogue) -> str:
    """For which sizes of move the limits hold, the worst of them, and what that costs."""
    text, f, limits = words.text, words.format, record.limits

    def shown(move: dict[str, float], size: float) -> str:
        return f.axis(size, "m/s" if "velocity_step" in move else "m")

    moves, sizes = [item.move for item in record.moves], limits.recommended.valid_for
    own = ", ".join(shown(move, item.largest) for move, item in zip(moves, sizes, strict=True))
    if any(item.smallest > 0.0 for item in sizes):
        return text("sizes-listed", moves=own)
    said = [text("sizes-every", moves=own)]
    units = {check.name: check.unit for check in record.assessment.checks}
    for worst in limits.recommended.worst_sizes:
        if worst.bound is not None:  # else only some sizes were looked at
            at, unit = shown(moves[worst.move - 1], worst.size), units[worst.requirement]
            found, bound = f.quantity(worst.value, unit), f.quantity(worst.bound, unit)
            said.append(text("sizes-worst", residual=found, size=at, bound=bound))
    alone, together = limits.listed_only, limits.recommended.settling_time
    if alone and alone.settling_time and together and together > alone.settling_time:
        said.append(text("sizes-cost", cost=f.quantity(together - alone.settling_time, "s")))
    return "; ".join(said)


def _marked(record: Record, key: str, shown: str, words: Catalogue) -> str:
    """A value, and that nobody stated it where that is so."""
    return words.text("assumed", value=shown) if is_assumed(record, key) else shown
