"""What changed between two records: machine and requirements, limits, result, loop."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mtcommission.errors import Fault, InputError
from mtcommission.messages.message import Message
from mtcommission.record.schema import Quantity, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.machine_part import datum, datum_name
from mtcommission.sheet.model import Column, Paragraph, Section, Table, Tone
from mtcommission.sheet.verdict_part import move_title

SAME = 1e-6
"""Relative difference below which two results are the same: the search rounds far above it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One thing before and after.

    Parameters
    ----------
    name
        What it is.
    before, after
        As printed.
    change
        The difference, in words or per cent.
    is_changed
        Whether there is one.
    """

    name: str
    before: str
    after: str
    change: str
    is_changed: bool


def differences(before: Record, after: Record, f: Formatter) -> Section:
    """Return what changed from one record to another of the same kind of axis.

    Parameters
    ----------
    before, after
        Records; ``after`` is the one whose sheet is printed.
    f
        Formatter.

    Returns
    -------
    Section

    Raises
    ------
    InputError
        If one axis is linear and the other rotary.
    """
    motions = (before["machine"]["motion"], after["machine"]["motion"])
    if motions[0] != motions[1]:
        message = f"got a {motions[0]} axis, must be {motions[1]} like the record to be printed"
        raise InputError([Fault(where="--compare", message=Message("verbatim", text=message))])
    text, profile = f.labels, before["profile"]
    inputs = [change for change in _inputs(before, after, f) if change.is_changed]
    sources = text.compared_with.format(
        machine=before["machine"]["name"],
        axis=before["machine"]["axis"],
        created=before["created"],
        name=profile["name"],
        hash=profile["sha256"],
    )
    return Section(
        key="differences",
        heading=text.differences_heading,
        blocks=(
            Paragraph(text=sources, tone=Tone.NOTE),
            _table(text.changed_inputs, inputs, f)
            if inputs
            else Paragraph(text=text.no_changed_inputs),
            _table(text.changed_limits, _limits(before, after, f), f),
            _table(text.changed_result, _result(before, after, f), f),
            _table(text.changed_loop, _loop(before, after, f), f),
        ),
    )


def _table(caption: str, changes: Iterable[Change], f: Formatter) -> Table:
    text, rows = f.labels, list(changes)
    return Table(
        caption=caption,
        columns=(
            Column(head=text.quantity, width=2.0),
            Column(head=text.before, width=1.4, is_number=True),
            Column(head=text.after, width=1.4, is_number=True),
            Column(head=text.change, is_number=True),
        ),
        rows=tuple((row.name, row.before, row.after, row.change) for row in rows),
        strong_rows=tuple(i for i, row in enumerate(rows) if row.is_changed),
    )


def _inputs(before: Record, after: Record, f: Formatter) -> list[Change]:
    text = f.labels
    rows = [
        _words(name, before["machine"][key], after["machine"][key], f)
        for name, key in (
            (text.machine_row, "name"),
            (text.axis_row, "axis"),
            (text.source, "source"),
        )
    ]
    old = {item["key"]: item for item in before["data"]}
    new = {item["key"]: item for item in after["data"]}
    # In the order of the sheet, then what has gone.
    named = new | {key: item for key, item in old.items() if key not in new}
    rows += [
        _datum_change(item, (old.get(key), new.get(key)), (before, after), f)
        for key, item in named.items()
    ]
    tools = (before["tool"]["version"], after["tool"]["version"])
    return [*rows, _words(text.version, *tools, f)]


def _datum_change(
    named: Quantity,
    items: tuple[Quantity | None, Quantity | None],
    records: tuple[Record, Record],
    f: Formatter,
) -> Change:
    shown = [
        f.labels.not_stated if item is None else datum(item, record["plant"]["units"], f)
        for item, record in zip(items, records, strict=True)
    ]
    name = datum_name(named, f)
    before, after = (None if item is None else item["value"] for item in items)
    if isinstance(before, float | int) and isinstance(after, float | int):
        return _numbers(name, (before, after), (shown[0], shown[1]), f)
    return _words(name, shown[0], shown[1], f)


def _limits(before: Record, after: Record, f: Formatter) -> list[Change]:
    text = f.labels
    old, new = before["limits"]["recommended"], after["limits"]["recommended"]
    length = motion_unit("m", rotary=f.rotary)
    return [
        _quantity(
            text.acceleration, (old["acceleration"], new["acceleration"]), f"{length}/s^2", f
        ),
        _quantity(text.jerk, (old["jerk"], new["jerk"]), f"{length}/s^3", f),
        _quantity(text.jerk_time, (old["jerk_time"], new["jerk_time"]), "s", f),
        _words(text.bound_by_column, text.say(old["bound_by"]), text.say(new["bound_by"]), f),
    ]


def _result(before: Record, after: Record, f: Formatter) -> list[Change]:
    text, parts = f.labels, (before["assessment"], after["assessment"])
    old, new = before["limits"]["recommended"], after["limits"]["recommended"]
    length, force = motion_unit("m", rotary=f.rotary), after["plant"]["units"]["F"]
    verdicts = [text.yes if part["met"] else text.no for part in parts]
    rows = [
        _words(text.verdict_met, verdicts[0], verdicts[1], f),
        _settling(text.settling_time, (old["settling_time"], new["settling_time"]), f),
        _quantity(text.residual, (old["residual_deviation"], new["residual_deviation"]), length, f),
        _quantity(text.peak_deviation, (old["peak_deviation"], new["peak_deviation"]), length, f),
    ]
    moves = zip(before["moves"], after["moves"], before["optima"], after["optima"], strict=False)
    for number, (was, now, reference, optimum) in enumerate(moves, start=1):
        titles = [move_title(move["move"], number, f) for move in (was, now)]
        if titles[0] != titles[1]:
            rows.append(_words(text.move.format(number=number), titles[0], titles[1], f))
            continue
        settled = (was["response"]["settling_time"], now["response"]["settling_time"])
        forces = (was["response"]["max_force"], now["response"]["max_force"])
        times = (reference["time"]["t_f"], optimum["time"]["t_f"])
        rows += [
            _settling(f"{titles[1]}: {text.settling_time}, {text.nominal}", settled, f),
            _quantity(f"{titles[1]}: {text.max_force}, {text.nominal}", forces, force, f),
            _quantity(f"{titles[1]}: {text.time_optimal}, {text.final_time}", times, "s", f),
        ]
    return rows


def _loop(before: Record, after: Record, f: Formatter) -> list[Change]:
    text, old, new = f.labels, before["loop"], after["loop"]
    damping = motion_unit("N s/m", rotary=f.rotary)
    both = (old, new)
    rows = [
        _quantity(text.name("Kv"), (old["Kv"], new["Kv"]), "1/s", f),
        _quantity(text.name("Kp"), (old["Kp"], new["Kp"]), damping, f),
        _quantity(text.name("Tn"), (old["Tn"], new["Tn"]), "s", f),
        _quantity(text.reference_delay, (old["reference_delay"], new["reference_delay"]), "s", f),
    ]
    feedback = [text.yes if part["state_feedback"] else text.no for part in both]
    rows.append(_words(text.state_feedback_used, feedback[0], feedback[1], f))
    for name, key, show in (
        (text.gain_margin, "gain_margin_db", f.decibel),
        (text.phase_margin, "phase_margin_deg", f.degree),
    ):
        margins = [part["worst_corner"].get(key) for part in both]
        row = _words(f"{name}, {text.worst_corner}", show(margins[0]), show(margins[1]), f)
        rows.append(row)
    bandwidths = (old["bandwidth_hz"], new["bandwidth_hz"])
    return [*rows, _quantity(text.bandwidth, bandwidths, "Hz", f)]


def _settling(name: str, values: tuple[float | None, float | None], f: Formatter) -> Change:
    return _maybe(name, values, (f.settling(values[0]), f.settling(values[1])), f)


def _quantity(
    name: str, values: tuple[float | None, float | None], unit: str, f: Formatter
) -> Change:
    return _maybe(name, values, (f.quantity(values[0], unit), f.quantity(values[1], unit)), f)


def _maybe(
    name: str, values: tuple[float | None, float | None], shown: tuple[str, str], f: Formatter
) -> Change:
    before, after = values
    if before is None or after is None:
        return _words(name, shown[0], shown[1], f)
    return _numbers(name, (before, after), shown, f)


def _numbers(
    name: str, values: tuple[float, float], shown: tuple[str, str], f: Formatter
) -> Change:
    before, after = values
    if abs(after - before) <= SAME * max(abs(before), abs(after)):
        return _words(name, shown[1], shown[1], f)
    # There is no share of nothing, and none across a change of sign.
    share = f.signed_percent(after / before - 1.0) if before * after > 0.0 else f.labels.changed
    return Change(name=name, before=shown[0], after=shown[1], change=share, is_changed=True)


def _words(name: str, before: str, after: str, f: Formatter) -> Change:
    is_changed = before != after
    change = f.labels.changed if is_changed else f.labels.unchanged
    return Change(name=name, before=before, after=after, change=change, is_changed=is_changed)
