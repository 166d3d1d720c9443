"""One row of a control: a setting under the control's own name, both written and read by it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal, InvalidOperation
from enum import Enum
from functools import cache, partial
from typing import Any, TypeAlias

from mtcommission.base.errors import InputError
from mtcommission.base.messages.message import Message
from mtcommission.base.units.quantities import NUMBER
from mtcommission.base.units.symbols import read_unit

DIGITS = 4
"""Significant digits of what is typed in: a tenth of the digits by which valleys differ."""

SAME = Decimal("1e-9")
"""A number this close to a round one (relative) is that one: 1.68/1e-3 must stay 1680."""


class Setting(Enum):
    """What a control can hold: in words, the direction in which rounding is safe, its text."""

    ACCELERATION = ("acceleration", ROUND_FLOOR, "acceleration")
    RISE_TIME = ("time from standstill to rapid traverse", ROUND_CEILING, "fanuc-rise-time")
    RAPID = ("rapid traverse", ROUND_FLOOR, "limit-rapid")
    JERK = ("jerk", ROUND_FLOOR, "jerk")
    JERK_TIME = ("time of one acceleration ramp", ROUND_CEILING, "fanuc-bell-time")
    SHAPER = ("input shaper", "", "klipper-input-shaper")
    SHAPER_FREQUENCY = ("frequency of the shaper", ROUND_HALF_EVEN, "shaper-of-run")
    SHAPER_DAMPING = ("damping of the shaper", ROUND_HALF_EVEN, "shaper-of-run")
    AVERAGE = ("moving average of the setpoint", ROUND_HALF_EVEN, "filter-average")
    SECOND_AVERAGE = ("second moving average", ROUND_HALF_EVEN, "filter-second-average")
    TAP = ("weight of a tap of the setpoint filter", ROUND_HALF_EVEN, "filter-tap")
    TAP_SPACING = ("time between the taps", ROUND_HALF_EVEN, "filter-tap-spacing")
    POSITION_LOOP = ("where the position loop closes", "", "name-position-loop")
    POSITION_CYCLE = ("position cycle", ROUND_HALF_EVEN, "name-position-cycle")
    VELOCITY_CYCLE = ("velocity cycle", ROUND_HALF_EVEN, "name-velocity-cycle")
    POSITION_GAIN = ("Kv", ROUND_FLOOR, "gain-kv")
    VELOCITY_GAIN = ("Kp", ROUND_FLOOR, "gain-kp-at-axis")
    INTEGRAL_TIME = ("Tn", ROUND_CEILING, "gain-integral-time")
    REFERENCE_MODEL = ("time of the reference model", ROUND_HALF_EVEN, "gain-reference-model")
    FEEDFORWARD = ("which feed-forward acts", "", "")
    VELOCITY_FEEDFORWARD = ("weight of the velocity", ROUND_HALF_EVEN, "row-feedforward-velocity")
    FORCE_FEEDFORWARD = ("force per acceleration", ROUND_HALF_EVEN, "row-feedforward-force")
    JERK_FEEDFORWARD = ("force per jerk", ROUND_HALF_EVEN, "row-feedforward-jerk")
    REFERENCE_DELAY = ("delay of the position setpoint", ROUND_HALF_EVEN, "delay-of-reference")
    FILTERS = ("number of force filters", ROUND_HALF_EVEN, "filter-count")
    FILTER_KIND = ("kind of a force filter", "", "filter-kind")
    FILTER_FREQUENCY = ("its frequency", ROUND_HALF_EVEN, "filter-frequency")
    FILTER_DAMPING = ("its damping", ROUND_HALF_EVEN, "filter-damping")
    FILTER_WIDTH = ("its width", ROUND_HALF_EVEN, "filter-width")
    STATE_GAIN = ("gain of a state that is fed back", ROUND_HALF_EVEN, "row-state-gain")
    FIXED = ("what must be so", "", "")
    WAIT = ("wait for the slowest axis", ROUND_HALF_EVEN, "group-row-wait")
    TOGETHER = ("what axes that move together are told", ROUND_FLOOR, "group-row-{}")

    @property
    def rounding(self) -> str:
        """Which way a number may go: limits and gains down, times that soften up."""
        return self.value[1]


Key: TypeAlias = tuple[Setting, str]
"""A setting, and which one: a machining mode, the number of a filter, what of axes that move
together (PATH_ACCELERATION, ...), or ""."""

PATH_ACCELERATION: Key = (Setting.TOGETHER, "acceleration")
PATH_JERK: Key = (Setting.TOGETHER, "jerk")
AT_CORNERS: Key = (Setting.TOGETHER, "corner")
WAIT: Key = (Setting.WAIT, "")

Values: TypeAlias = Mapping[Key, float | str]
"""Settings in SI; words where there is no number."""


@dataclass(frozen=True, slots=True)
class Row:
    """A parameter of a control."""

    setting: Setting
    name: str  # as the control spells it
    _: KW_ONLY
    index: str = ""  # which one of several, see Key
    unit: str = ""  # the control's, e.g. "mm/s^2" or "0.01/s"; of several, the first one counts
    at_shaft: float = 1.0  # SI at the axis of one SI unit of it, where it counts at the motor
    digits: int = DIGITS  # significant ones
    step: float = 0.0  # whole multiples of this only, in its unit; 0: any number
    codes: Mapping[Any, str] = field(default_factory=dict)  # how it writes certain values
    meaning: Message | str = ""  # what it does, or the kind of that message; "": its setting's
    section: str = ""  # of a structured file, parts separated by "/"
    is_verified: bool = True  # whether name and unit were read in a maker's text or source file
    is_elsewhere: bool = False  # a remark in the text: set in the drive, or to be left as it is

    @property
    def text(self) -> Message | None:
        """What it does; None where the name says it."""
        of_setting: str = self.setting.value[2]
        meaning = self.meaning or of_setting.replace("{}", self.index)
        return Message(meaning) if meaning and isinstance(meaning, str) else meaning or None

    @property
    def scale(self) -> float:
        """One of its unit in SI at the axis."""
        return self.at_shaft * si_of(self.unit)

    @property
    def key(self) -> Key:
        """What it holds."""
        return self.setting, self.index

    def takes(self, value: float | str) -> bool:
        """Whether the control can hold a value here."""
        return not self.codes or value in self.codes

    def encode(self, value: float | str) -> str:
        """Return a value as it is typed, rounded to the safe side.

        Examples
        --------
        >>> kv = Row(Setting.POSITION_GAIN, "kv", unit="0.01/s", step=1)
        >>> kv.encode(31.4159), kv.decode("3141")
        ('3141', 31.41)
        """
        if self.codes:
            return self.codes[value]
        if isinstance(value, str):
            raise unreadable(f"{self.name} {value}")
        rounding = self.setting.rounding
        return type_number(
            round_number(value / self.scale, rounding, digits=self.digits, step=self.step)
        )

    def decode(self, text: str) -> float | str:
        """Return the value that the control takes from what is typed, in SI.

        Raises InputError if the control would not take it.
        """
        try:
            if self.codes:
                held: float | str = next(v for v, code in self.codes.items() if code == text)
                return held
            return float(Decimal(text)) * self.scale
        except (StopIteration, InvalidOperation):
            raise unreadable(f"{self.name} {text}") from None


@cache
def si_of(unit: str) -> float:
    """Return one of a control's unit in SI."""
    first, _, _ = unit.partition(",")
    number = NUMBER.match(first)
    symbols = read_unit(first[number.end() :] if number else first)
    return (float(number[0]) if number else 1.0) * symbols[0].si_value


doubted = partial(Row, is_verified=False)
"""A row whose name or unit was not read in a maker's text."""


def fixed(
    name: str, text: str, meaning: Message | str = "", *, unit: str = "", section: str = ""
) -> Row:
    """Return a row that must be just so for the others to act as they were simulated."""
    codes, key = {"set": text}, Setting.FIXED
    return Row(key, name, index=name, unit=unit, codes=codes, meaning=meaning, section=section)


def at_corners(name: str, unit: str, meaning: str, **more: Any) -> Row:
    """Return the row of what axes that move together are told for corners."""
    return Row(Setting.TOGETHER, name, index="corner", unit=unit, meaning=meaning, **more)


def on_path(limit: str, name: str, unit: str, meaning: str = "", **more: Any) -> Row:
    """Return the row of a limit of their path: "acceleration" or "jerk"."""
    return Row(Setting.TOGETHER, name, index=limit, unit=unit, meaning=meaning, **more)


def unreadable(row: str) -> InputError:
    """Return the fault of a row that nothing can be made of."""
    return InputError.at("export", Message("export-unreadable", row=row))


def round_number(
    value: float, rounding: str, *, digits: int = DIGITS, step: float = 0.0
) -> Decimal:
    """Return the number with few significant digits at, below or above a value.

    Examples
    --------
    >>> round_number(1.68 / 1e-3, ROUND_FLOOR), round_number(47.0888, ROUND_FLOOR)
    (Decimal('1680'), Decimal('47.08'))
    >>> round_number(23.3601, ROUND_CEILING), round_number(47.0888, ROUND_CEILING, step=2)
    (Decimal('23.37'), Decimal('48'))
    """
    if not value:
        return Decimal(0)
    slack = {ROUND_FLOOR: SAME, ROUND_CEILING: -SAME}.get(rounding, Decimal(0))
    exact = Decimal(value) * (1 + slack)
    quantum = Decimal(str(step)) if step else Decimal(1).scaleb(exact.adjusted() - digits + 1)
    return (exact / quantum).to_integral_value(rounding) * quantum


def type_number(number: Decimal) -> str:
    """Return a number as it is typed: no exponent, no zeros behind the point.

    Examples
    --------
    >>> type_number(Decimal("1.680E+3")), type_number(Decimal("47.0800"))
    ('1680', '47.08')
    """
    text = format(number, "f")
    return text.rstrip("0").rstrip(".") if "." in text else text
