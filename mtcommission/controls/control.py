"""A control: what it has, its rows, its syntax, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from math import ceil, inf
from typing import Any, NoReturn

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import LINEAR, AxisUnits
from mtcommission.controls.kind import LOW_PASS, NOTCH, SHAPERS, ControlKind, PositionLoop
from mtcommission.controls.row import AT_CORNERS, Key, Row, Setting, Values
from mtcommission.controls.syntax import Layout
from mtcommission.controls.wording import show_value

LETTERS = "XYZABCUVW"
"""Axis letters in the order in which controls number them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """What the rows of a control need to know of an axis and its recommendation."""

    name: str  # as the profile gives it
    kind: ControlKind  # what the control has
    units: AxisUnits
    is_rotary: bool
    follows: bool  # whether the motor follows its setpoint
    shaft: float | None  # motion of the axis per angle of the motor [m/rad]; None: not stated
    position_cycle: float  # [s]
    acceleration: float  # the recommended one [m/s²]
    bands: Mapping[str, float]  # what each machining mode is judged by [m]
    state_units: Mapping[str, str]  # of the plant
    has_own_filter: bool  # whether the control can be set to the run's setpoint filter
    mode_name: str  # of the mode that a setpoint excites most
    corner_velocity: Callable[[Sequence[str]], float]
    """The step of velocity that keeps the band behind whichever of some shapers [m/s]."""

    @property
    def small_unit(self) -> str:
        """Unit of a position that most controls have."""
        return "deg" if self.is_rotary else "mm"

    @property
    def identifier(self) -> str:
        """Its name as part of an identifier."""
        kept = "".join(sign if sign.isascii() and sign.isalnum() else "_" for sign in self.name)
        return kept if kept[:1].isalpha() else f"Axis_{kept}"

    def letter(self, allowed: str, control: str) -> str:
        """Return its letter, or raise an error that says which letters the control has."""
        letter = self.name[:1].upper()
        if letter not in tuple(allowed):
            letters = tuple(allowed)
            _refuse("export-other-letter", control=control, letters=letters, axis_name=self.name)
        return letter

    def require_linear(self, control: str) -> None:
        """Raise an error where the axis turns."""
        if self.is_rotary:
            _refuse("export-linear-only", control=control)

    def cycles(self, unit: float) -> int:
        """Return the position cycle in whole units of time, at least one; ``unit`` in s."""
        return max(1, ceil(self.position_cycle / unit - 1e-9))

    def acceleration_row(self, name: str, meaning: str = "", **more: Any) -> Row:
        """Return a row of the acceleration in the small unit."""
        unit = f"{self.small_unit}/s^2"
        return Row(Setting.ACCELERATION, name, unit=unit, meaning=meaning, **more)

    def jerk_row(self, name: str, meaning: str, *, section: str = "") -> Row:
        """Return a row of the jerk in the small unit."""
        unit = f"{self.small_unit}/s^3"
        return Row(Setting.JERK, name, unit=unit, meaning=meaning, section=section)

    def rows_at_shaft(
        self, setting: Setting, name: str, unit: str, meaning: str, **more: Any
    ) -> Iterator[Row]:
        """Yield the row of a gain or a mass at the motor's shaft, where its travel is stated."""
        if self.shaft:
            shaft = self.shaft**-2
            yield Row(setting, name, unit=unit, at_shaft=shaft, meaning=meaning, **more)

    def say_mode(self, mode: str) -> Message:
        """Return what a column of limits is for: a machining mode with its band."""
        if mode not in self.bands:
            return Message("way-recommended")
        band = show_value(self.bands[mode], self.units.length.si)
        return Message("limit-of-mode", mode=Message(f"machining-{mode}"), band=band)


def _refuse(kind: str, **values: Any) -> NoReturn:
    raise InputError.at("--control", Message(kind, **values))


@dataclass(frozen=True, slots=True, kw_only=True)
class Typed:
    """What the control makes of the typed numbers, and what that does."""

    values: Values  # [SI]
    acceleration: float  # [m/s²]
    is_met: bool  # whether all requirements are


class Corner(Enum):
    """What a control does at a corner, s = cos(α/2) of the change of direction."""

    STEP = "step"  # each axis may step its velocity by so much
    JUNCTION = "junction"  # v² = q s/(1 - s), told by the speed at 90 degrees
    DEVIATION = "deviation"  # the same with q = a d: d is told, a the axes' own along the change
    ARC = "arc"  # rounds it within a tolerance, v² <= a R
    OWN = "own"  # rounds it within a tolerance in a way that is not simulated


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerRule:
    """What a control does at corners."""

    kind: Corner
    is_verified: bool = True
    share: float = 1.0  # of the acceleration limit that an arc may use [-]
    least: float = 0.0  # that the control can be told; below, it is told nothing [SI]
    most: float = inf


UNKNOWN_CORNER = CornerRule(kind=Corner.STEP, is_verified=False)
"""No rule was read: each axis is taken to step its velocity."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """A control and its parameters."""

    kind: ControlKind
    rows: Callable[[Axis, Values], Iterable[Row]]
    """Given the loop's settings. Of rows whose setting is not there, nothing is written; settings
    that it has no row for are written as remarks."""
    layout: Layout
    shapers: tuple[str, ...] = ()  # tried where the run's filter is none of the control's
    notes: tuple[str, ...] = ()  # sentences for the header, by the kinds of their messages
    notes_of: Callable[[Axis, Typed], Iterable[Message]] = lambda _axis, _typed: ()
    """Those that depend on the axis, or on what is typed in."""
    names_axes: bool = False  # whether its names tell the axis: several stand in one text as it is
    axis_in_group: tuple[Row, ...] = ()  # what an axis is told where it moves with others
    group: tuple[Row, ...] = ()  # what the path of axes that move together is told
    axes_hold: tuple[str, ...] = ("acceleration", "jerk")
    """Limits of the axes that it keeps along the path, too: those of the path are ceilings then."""
    corner: CornerRule = UNKNOWN_CORNER

    @property
    def key(self) -> str:
        """For ``--control``."""
        return self.kind.key

    def place_of(self, key: Key) -> Row | None:
        """Return what a value of axes that move together is called; None: it has no place."""
        rows = (row for row in (*self.axis_in_group, *self.group) if row.key == key)
        return next(rows, None)

    @property
    def corner_name(self) -> str:
        """What it calls its value at corners, "(?)" where that was not read; "" without one."""
        row = self.place_of(AT_CORNERS)
        return f"{row.name}{'' if row.is_verified else ' (?)'}" if row else ""


OF_GROUP = {Setting.WAIT: "wait", Setting.TOGETHER: "path {}"}
"""What axes that move together are told, in neutral words."""


def neutral_rows(units: AxisUnits) -> dict[Setting, Row]:
    """Return every setting as one would say it of any control.

    They are the rows of ``generic``, and what another control's text can only say in a remark;
    their names have a place for the number of a filter.
    """
    time = partial(Row, unit="ms")
    loops = {loop.value: loop.value for loop in PositionLoop}
    kinds = {kind: kind for kind in (NOTCH, LOW_PASS)}
    shapers = {kind: kind for kind in SHAPERS}
    rows = (
        Row(Setting.ACCELERATION, "acceleration", unit=units.acceleration.si),
        Row(Setting.JERK, "jerk", unit=units.jerk.si),
        Row(Setting.AVERAGE, "moving average", unit="ms", digits=9),
        Row(Setting.SECOND_AVERAGE, "second moving average", unit="ms", digits=9),
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


def is_neutral(row: Row) -> bool:
    """Return whether a row is named by what it is, not as a control spells it."""
    if row.setting is Setting.STATE_GAIN:  # no product feeds states back
        return True
    named = {setting: one.name for setting, one in neutral_rows(LINEAR).items()} | OF_GROUP
    return row.setting in named and row.name == named[row.setting].format(row.index)


def name_row(row: Row, words: Catalogue) -> str:
    """Return what a row is called: as the control spells it, or what it is in the user's words."""
    if not is_neutral(row):
        return row.name
    setting = row.setting.name.lower().replace("_", "-")
    return words.text("neutral-name", setting=setting, name=row.name, number=row.index)


def say_neutrally(keys: Iterable[Key], units: AxisUnits) -> tuple[Row, ...]:
    """Return the rows of some settings in neutral words; none for what there is no word for."""
    rows = neutral_rows(units)
    return tuple(
        replace(rows[setting], name=rows[setting].name.format(index), index=index)
        for setting, index in keys
        if setting in rows
    )


def complete(rows: Iterable[Row], loop: Values, units: AxisUnits) -> tuple[Row, ...]:
    """Return the rows of a control with a remark for each setting of its loop that has no row.

    Rows go whose setting has a value that the control cannot hold.
    """
    kept = [row for row in rows if row.key not in loop or row.takes(loop[row.key])]
    held = {row.key for row in kept}
    missing = say_neutrally((key for key in loop if key not in held), units)
    return (*kept, *(replace(row, is_elsewhere=True) for row in missing))
