"""Klipper."""

from __future__ import annotations

from functools import partial

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import (
    Axis,
    Control,
    Corner,
    CornerRule,
    Typed,
    letter_of,
    require_linear,
)
from mtcommission.controls.kind import SHAPERS, FilterChoice, read
from mtcommission.controls.makers.stepping import (
    DAMPING_STEP,
    FREQUENCY_STEP,
    PRINTER,
    USUAL_CORNER,
    make_up,
    of_corner,
    say_shaper,
    sends_steps,
)
from mtcommission.controls.row import Row, Setting, Values, fixed
from mtcommission.controls.syntax import CONFIG

KLIPPER_SOURCE = "Klipper at 84104bbb: Config_Reference, input_shaper, kin_shaper.c"

ADDRESSES = {KLIPPER_SOURCE: "github.com/Klipper3d/klipper"}
"""Where each source was read, November 2026."""

KLIPPER_SHAPERS = SHAPERS[:6]

MOST_DAMPING = {"ei": 0.4, "2hump_ei": 0.3, "3hump_ei": 0.2}
"""Largest damping ratios that Klipper takes, where it is not 0.99."""

KLIPPER = sends_steps(
    "klipper",
    KLIPPER_SOURCE,
    largest_acceleration=PRINTER,
    setpoint_filters=tuple(
        FilterChoice(kind=shaper, most_damping=MOST_DAMPING.get(shaper, 0.99))
        for shaper in KLIPPER_SHAPERS
    ),
    features={
        "acceleration": read(
            KLIPPER_SOURCE,
            "[printer] max_accel (z: max_z_accel) [mm/s^2]",
            "minimum_cruise_ratio lowers the velocity of short moves.",
        ),
        "jerk": read(KLIPPER_SOURCE, note="None; square_corner_velocity is a step of velocity."),
        "modes": read(KLIPPER_SOURCE, note="None; by macro."),
        "setpoint_filters": read(
            KLIPPER_SOURCE,
            "[input_shaper] shaper_type_x, shaper_freq_x [Hz], damping_ratio_x",
            "One shaper per axis. Damping at most 0.99, ei 0.4, 2hump_ei 0.3, 3hump_ei 0.2. The EI "
            "family as of 2025-09-16 (5da026a3), 3hump_ei as of 2026-03-31 (0d1445a7); earlier "
            "ones were the classical EI. mzv(n, t) and ei(v_tol) of 2026 are not offered.",
        ),
        "reference_delay": read(
            KLIPPER_SOURCE, note="None; pulses are centred, so a shaper's delay is not one."
        ),
    },
)

USUAL = ("zv", "zvd")
"""Shapers that are tried where the run's filter is none of the control's."""


def _klipper(axis: Axis, _loop: Values) -> list[Row]:
    require_linear(axis, "Klipper")
    letter = letter_of(axis, "XYZ", "Klipper").lower()
    row = partial(Row, section="input_shaper", is_verified=letter != "z")
    of_mode = say_shaper(axis)
    return [
        Row(
            Setting.ACCELERATION,
            "max_accel",
            unit="mm/s^2",
            meaning="klipper-tool-head",
            section="printer",
        ),
        *_klipper_corner(axis),
        row(
            Setting.SHAPER,
            f"shaper_type_{letter}",
            codes=dict(zip(KLIPPER_SHAPERS, KLIPPER_SHAPERS, strict=True)),
        ),
        row(
            Setting.SHAPER_FREQUENCY,
            f"shaper_freq_{letter}",
            unit="Hz",
            step=FREQUENCY_STEP,
            meaning=of_mode,
        ),
        row(Setting.SHAPER_DAMPING, f"damping_ratio_{letter}", step=DAMPING_STEP, meaning=of_mode),
    ]


def _klipper_corner(axis: Axis) -> list[Row]:
    """Klipper's default, or less where that leaves the band."""
    if not axis.follows:
        return []
    corner = f"{1e3 * min(axis.corner_velocity(USUAL), USUAL_CORNER):.3g}"
    said = Message("klipper-corner")
    return [fixed("square_corner_velocity", corner, said, unit="mm/s", section="printer")]


def _klipper_notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    return (
        Message("klipper-no-jerk"),
        *make_up(axis, typed),
        *of_corner(axis, "klipper-corner-bound", USUAL),
        Message("klipper-cruise"),
        Message("klipper-shaper"),
        *(
            (Message("klipper-three-humps"),)
            if typed.values.get((Setting.SHAPER, "")) == "3hump_ei"
            else ()
        ),
    )


GROUP = (
    Row(
        Setting.TOGETHER,
        "max_accel",
        index="acceleration",
        unit="mm/s^2",
        meaning="klipper-tool-head",
        section="printer",
    ),
    Row(
        Setting.TOGETHER,
        "square_corner_velocity",
        index="corner",
        unit="mm/s",
        meaning="group-row-speed",
        section="printer",
    ),
)

CONTROL = Control(
    kind=KLIPPER,
    rows=_klipper,
    layout=CONFIG,
    shapers=USUAL,
    notes_of=_klipper_notes,
    names_axes=True,
    group=GROUP,
    axes_hold=(),
    corner=CornerRule(kind=Corner.JUNCTION, source="Klipper 84104bbb, toolhead.py"),
)
