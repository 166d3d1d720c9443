"""What a control is to an export: its rows, its syntax, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from mtcommission.control_kinds.kind import SHAPERS, PositionLoop
from mtcommission.export.choose import Chosen
from mtcommission.export.layout import Layout
from mtcommission.export.row import Key, Row, Setting, Values
from mtcommission.export.subject import Subject
from mtcommission.export.wording import MICRO, MILLI
from mtcommission.machine.control import FilterKind
from mtcommission.messages.message import Message
from mtcommission.units.axis_units import AxisUnits


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """A control and its parameters.

    Parameters
    ----------
    key
        For ``--control``.
    rows
        Its rows, given what the loop needs; of those whose setting is not there, nothing is
        written. Settings of the loop that it has no row for are written as remarks.
    layout
        Its syntax.
    shapers
        Its input shapers, each as settings.
    notes
        Sentences for the header, given the limits as typed.
    in_degrees
        Whether its angles are degrees, not radians.
    """

    key: str
    rows: Callable[[Subject, Values], Sequence[Row]]
    layout: Layout
    shapers: Callable[[Subject], Sequence[Values]] = lambda _subject: ()
    notes: Callable[[Subject, Chosen], tuple[Message, ...]] = lambda _subject, _chosen: ()
    in_degrees: bool = True


def neutral_rows(units: AxisUnits) -> dict[Setting, Row]:
    """Return every setting as one would say it of any control.

    They are the rows of ``generic``, and what another control's text can only say in a remark.

    Parameters
    ----------
    units
        Of the axis.

    Returns
    -------
    dict
        Names with a place for the number of a filter.
    """
    time = partial(Row, unit="us", scale=MICRO)
    loops: dict[float | str, str] = {loop.value: loop.value for loop in PositionLoop}
    kinds: dict[float | str, str] = {kind.value: kind.value for kind in FilterKind}
    shapers: dict[float | str, str] = {kind: kind for kind in SHAPERS}
    rows = (
        Row(Setting.ACCELERATION, "acceleration", unit=units.acceleration.si),
        Row(Setting.JERK, "jerk", unit=units.jerk.si),
        Row(Setting.AVERAGE, "moving average", unit="ms", scale=MILLI, digits=9),
        Row(Setting.SECOND_AVERAGE, "second moving average", unit="ms", scale=MILLI, digits=9),
        Row(Setting.SHAPER, "setpoint shaper", codes=shapers),
        Row(Setting.SHAPER_FREQUENCY, "shaper frequency", unit="Hz", digits=9),
        Row(Setting.SHAPER_DAMPING, "shaper damping ratio", digits=9),
        Row(Setting.TAP, "tap {}", digits=12),
        time(Setting.TAP_SPACING, "tap spacing", digits=9),
        Row(Setting.POSITION_LOOP, "position loop", codes=loops),
        time(Setting.POSITION_CYCLE, "position cycle", digits=9),
        time(Setting.VELOCITY_CYCLE, "velocity cycle", digits=9),
        Row(Setting.POSITION_GAIN, "Kv", unit="1/s"),
        Row(Setting.VELOCITY_GAIN, "Kp", unit=units.damping.si),
        time(Setting.INTEGRAL_TIME, "Tn"),
        time(Setting.REFERENCE_MODEL, "reference model"),
        Row(Setting.VELOCITY_FEEDFORWARD, "velocity feed-forward"),
        Row(Setting.FORCE_FEEDFORWARD, "force feed-forward", unit=units.mass.si),
        Row(Setting.JERK_FEEDFORWARD, "jerk feed-forward", unit=f"{units.mass.si} s"),
        time(Setting.REFERENCE_DELAY, "reference delay"),
        Row(Setting.FILTERS, "force filters"),
        Row(Setting.FILTER_KIND, "filter {} kind", codes=kinds),
        Row(Setting.FILTER_FREQUENCY, "filter {} frequency", unit="Hz", digits=5),
        Row(Setting.FILTER_DAMPING, "filter {} damping"),
        Row(Setting.FILTER_WIDTH, "filter {} width"),
    )
    return {row.setting: row for row in rows}


def say_neutrally(keys: Iterable[Key], units: AxisUnits) -> tuple[Row, ...]:
    """Return the rows of some settings in neutral words; none for what there is no word for.

    Parameters
    ----------
    keys
        Settings.
    units
        Of the axis.
    """
    rows = neutral_rows(units)
    return tuple(
        replace(rows[setting], name=rows[setting].name.format(index), index=index)
        for setting, index in keys
        if setting in rows
    )


def complete(rows: Sequence[Row], loop: Values, units: AxisUnits) -> tuple[Row, ...]:
    """Return the rows of a control with a remark for each setting that it has no row for.

    Parameters
    ----------
    rows
        What the control has.
    loop
        All settings of its loop.
    units
        Of the axis.

    Returns
    -------
    tuple of Row
        None whose setting is not there or has a value that the control cannot hold.
    """
    kept = [row for row in rows if row.key not in loop or row.takes(loop[row.key])]
    held = {row.key for row in kept}
    missing = say_neutrally((key for key in loop if key not in held), units)
    return (*kept, *(replace(row, is_elsewhere=True) for row in missing))
