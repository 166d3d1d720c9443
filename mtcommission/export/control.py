"""What a control is to an export: its rows, its syntax, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.export.choose import Chosen
from mtcommission.export.layout import Layout
from mtcommission.export.row import Row, Setting, Values
from mtcommission.export.subject import Subject
from mtcommission.export.wording import MICRO, MILLI
from mtcommission.machine.machine import FilterKind
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _Neutral:
    """A setting in neutral words."""

    name: str
    unit: Callable[[AxisUnits], str] = lambda _units: ""
    scale: float = 1.0
    digits: int = 4
    words: tuple[str, ...] = ()
    meaning: str


NEUTRAL = {
    Setting.ACCELERATION: _Neutral(
        name="acceleration", unit=lambda u: u.acceleration.si, meaning="limit-itself"
    ),
    Setting.JERK: _Neutral(name="jerk", unit=lambda u: u.jerk.si, meaning="limit-itself"),
    Setting.RAPID: _Neutral(name="rapid", unit=lambda u: u.velocity.si, meaning="limit-rapid"),
    Setting.AVERAGE: _Neutral(
        name="moving average", unit=lambda _: "ms", scale=MILLI, digits=9, meaning="filter-average"
    ),
    Setting.POSITION_LOOP: _Neutral(
        name="position loop", words=tuple(loop.value for loop in PositionLoop), meaning="loop-place"
    ),
    Setting.POSITION_CYCLE: _Neutral(
        name="position cycle", unit=lambda _: "us", scale=MICRO, digits=9, meaning="cycle-position"
    ),
    Setting.VELOCITY_CYCLE: _Neutral(
        name="velocity cycle", unit=lambda _: "us", scale=MICRO, digits=9, meaning="cycle-velocity"
    ),
    Setting.POSITION_GAIN: _Neutral(name="Kv", unit=lambda _: "1/s", meaning="gain-position"),
    Setting.VELOCITY_GAIN: _Neutral(
        name="Kp", unit=lambda u: u.damping.si, meaning="gain-kp-at-axis"
    ),
    Setting.INTEGRAL_TIME: _Neutral(
        name="Tn", unit=lambda _: "us", scale=MICRO, meaning="gain-integral-time"
    ),
    Setting.REFERENCE_MODEL: _Neutral(
        name="reference model", unit=lambda _: "us", scale=MICRO, meaning="gain-reference-model"
    ),
    Setting.VELOCITY_FEEDFORWARD: _Neutral(
        name="velocity feed-forward", meaning="row-feedforward-velocity"
    ),
    Setting.FORCE_FEEDFORWARD: _Neutral(
        name="force feed-forward", unit=lambda u: u.mass.si, meaning="row-feedforward-force"
    ),
    Setting.JERK_FEEDFORWARD: _Neutral(
        name="jerk feed-forward", unit=lambda u: f"{u.mass.si} s", meaning="row-feedforward-jerk"
    ),
    Setting.REFERENCE_DELAY: _Neutral(
        name="reference delay", unit=lambda _: "us", scale=MICRO, meaning="delay-of-reference"
    ),
    Setting.FILTERS: _Neutral(name="force filters", meaning="filter-count"),
    Setting.FILTER_KIND: _Neutral(
        name="filter {} kind", words=tuple(kind.value for kind in FilterKind), meaning="filter-kind"
    ),
    Setting.FILTER_FREQUENCY: _Neutral(
        name="filter {} frequency", unit=lambda _: "Hz", digits=5, meaning="filter-frequency"
    ),
    Setting.FILTER_DAMPING: _Neutral(name="filter {} damping", meaning="filter-damping"),
}
"""Every setting as one would say it of any control: rows of ``generic``, and of what another
control's text can only say in a remark."""


def neutral_row(
    setting: Setting, index: str, units: AxisUnits, *, is_elsewhere: bool = False
) -> Row:
    """Return the row of a setting in neutral words.

    Parameters
    ----------
    setting, index
        What it holds.
    units
        Of the axis.
    is_elsewhere
        Whether it is to be written as a remark.

    Returns
    -------
    Row
    """
    neutral = NEUTRAL[setting]
    return Row(
        setting=setting,
        index=index,
        name=neutral.name.format(index),
        unit=neutral.unit(units),
        scale=neutral.scale,
        digits=neutral.digits,
        codes={word: word for word in neutral.words},
        meaning=Message(neutral.meaning),
        is_elsewhere=is_elsewhere,
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
    missing = (key for key in loop if key not in held and key[0] in NEUTRAL)
    remarks = (neutral_row(*key, units, is_elsewhere=True) for key in missing)
    return (*kept, *remarks)
