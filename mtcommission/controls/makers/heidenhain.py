"""HEIDENHAIN TNC: names and units as the manuals give them, the rest is marked."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from mtcommission.controls.control import Axis, Control, Corner, CornerRule
from mtcommission.controls.kind import MOVING_AVERAGE, ControlKind, FilterChoice, PositionLoop
from mtcommission.controls.row import Row, Setting, Values, at_corners, on_path
from mtcommission.controls.syntax import TABLE


def _rows(axis: Axis, _loop: Values) -> Iterator[Row]:
    length = "deg" if axis.is_rotary else "m"
    # The manual states m/s^2 for linear axes; degrees for rotary ones are inferred, and so are
    # columns for the machining modes.
    for mode in ("", "surface", "accuracy", "speed"):
        row = partial(Row, index=mode, is_verified=not (axis.is_rotary or mode))
        name, unit = f"maxAcceleration{f', {mode}' if mode else ''}", f"{length}/s^2"
        yield row(Setting.ACCELERATION, name, unit=unit, meaning=axis.say_mode(mode))
        unit = f"{length}/s^3"
        for name, said in (
            ("axPathJerk", "limit-axis-jerk"),
            ("axPathJerkHi", "limit-axis-jerk-at-rapid"),
        ):
            of_mode = f"{name}, {mode}" if mode else name
            yield row(Setting.JERK, of_mode, unit=unit, meaning=said)
    yield Row(Setting.POSITION_GAIN, "kvFactor", unit="1/s")
    yield Row(Setting.VELOCITY_FEEDFORWARD, "feedForwardFactor")


CONTROL = Control(
    kind=ControlKind(
        key="heidenhain",
        unread=(
            *("modes", "acceleration_feedforward", "jerk_feedforward", "reference_delay"),
            *("velocity_cycle", "force_filters"),
        ),
        setpoint_filters=(FilterChoice(kind=MOVING_AVERAGE, advised_cycles=0.0),),
        position_loops=(PositionLoop.CONTROL, PositionLoop.INTERPOLATED, PositionLoop.DRIVE),
        position_cycle=3e-3,
        velocity_cycle=200e-6,
        force_filters=5,
    ),
    rows=_rows,
    layout=TABLE,
    # MANUALplus 620 Technical Manual 01/2012, 6.16, pp. 502, 829, 834
    group=(
        on_path("jerk", "maxPathJerk", "m/s^3"),
        on_path("jerk", "maxPathJerkHi", "m/s^3"),
        at_corners("pathTolerance", "mm", "group-row-tolerance", is_verified=False),
    ),
    corner=CornerRule(kind=Corner.OWN, is_verified=False),  # names second-hand
    notes=("heidenhain-path", "heidenhain-filters", "heidenhain-speed-gains", "heidenhain-itnc"),
)
