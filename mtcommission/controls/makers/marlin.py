"""Marlin."""

from __future__ import annotations

from collections.abc import Mapping
from math import sqrt

from mtcommission.base.messages.message import Message
from mtcommission.controls.control import (
    Axis,
    Control,
    Corner,
    CornerRule,
    Typed,
    acceleration_row,
    letter_of,
    require_linear,
)
from mtcommission.controls.kind import EARLIER, FilterChoice, read
from mtcommission.controls.makers.stepping import (
    DAMPING_STEP,
    FREQUENCY_STEP,
    PRINTER,
    USUAL_CORNER,
    make_up,
    of_corner,
    say_shaper,
    sends_steps,
    written,
)
from mtcommission.controls.row import Row, Setting, Values, fixed
from mtcommission.controls.syntax import G_CODE

MARLIN_SOURCE = "Marlin: M493, M494, M593, ft_types.h"

ADDRESSES = {MARLIN_SOURCE: "github.com/MarlinFirmware/Marlin (00317b4d, 02249df2, 03b25180)"}
"""Where each source was read, November 2026."""

MARLIN_SHAPERS: Mapping[str, str] = {
    "marlin_zv": "1",
    "marlin_mzv": "8",
    "marlin_zvd": "2",
    "marlin_zvdd": "3",
    "marlin_zvddd": "4",
    "marlin_ei": "5",
    "marlin_2hump_ei": "6",
    "marlin_3hump_ei": "7",
}
"""Values of M493 C."""

MARLIN = sends_steps(
    "marlin",
    MARLIN_SOURCE,
    largest_acceleration=PRINTER,
    setpoint_filters=tuple(
        FilterChoice(
            kind=shaper,
            least_frequency_hz=20.0,
            most_frequency_hz=500.0,
            least_damping=0.01,
            most_damping=0.25,
        )
        for shaper, code in MARLIN_SHAPERS.items()
    ),
    features={
        "acceleration": read(EARLIER, "M201 [mm/s^2]", "M204 for print and travel (?)."),
        "jerk": read(
            MARLIN_SOURCE,
            note="None; profiles of order 5 or 6 as build options, up to 1.875 times the "
            "acceleration. What Marlin calls jerk is a step of velocity.",
        ),
        "setpoint_filters": read(
            MARLIN_SOURCE,
            "M593 X/Y F [Hz] D; M493 C, A [Hz], I 0.01..0.25; M494 [s]",
            "ZV, or with FT motion ZV to ZVDDD, EI, 2HEI, 3HEI, MZV per axis, 10 or 20 to 500 Hz; "
            "its EI family is the classical one (shaping.cpp at 195278e4). FT motion rounds the "
            "first copy's delay to whole samples of 1 ms and repeats it, which is simulated; M593 "
            "delays steps by timer ticks and is not offered.",
        ),
        "position_cycle": read(
            MARLIN_SOURCE,
            "FTM_FS",
            "FT motion computes at 1000 Hz unless the build says otherwise; the steps in between "
            "are evenly spaced.",
        ),
    },
)

USUAL = ("marlin_zv", "marlin_zvd")
"""Shapers that are tried where the run's filter is none of the control's."""

JUNCTION_DEVIATIONS = (1e-5, 3e-4)
"""What Marlin takes as M205 J [m]; it refuses any other and keeps the old one
(M200-M205.cpp at 5ec63799)."""


def _marlin(axis: Axis, _loop: Values) -> list[Row]:
    require_linear(axis, "Marlin")
    letter = letter_of(axis, "XYZ", "Marlin")
    of_mode = say_shaper(axis)
    return [
        acceleration_row(axis, f"M201 {letter}"),
        *_marlin_corner(axis, letter),
        fixed("M493 S", "1", "marlin-fixed-time"),
        Row(
            Setting.SHAPER,
            f"M493 {letter} C",
            codes={kind: MARLIN_SHAPERS[kind] for kind in MARLIN_SHAPERS},
            meaning="marlin-shaper",
        ),
        Row(
            Setting.SHAPER_FREQUENCY,
            f"M493 {letter} A",
            unit="Hz",
            step=FREQUENCY_STEP,
            meaning=of_mode,
        ),
        Row(Setting.SHAPER_DAMPING, f"M493 {letter} I", step=DAMPING_STEP, meaning=of_mode),
    ]


def _marlin_corner(axis: Axis, letter: str) -> list[Row]:
    """By junction deviation; by the step of velocity where J would be below what M205 takes."""
    if not axis.follows:
        return []
    if deviation := _junction_deviation(axis):
        said = Message("marlin-corner")
        return [fixed("M205 J", f"{1e3 * deviation:.3g}", said, unit="mm")]
    corner, said = min(axis.corner_velocity(USUAL), USUAL_CORNER), Message("marlin-step")
    return [fixed(f"M205 {letter}", f"{1e3 * corner:.3g}", said, unit="mm/s")]


def _junction_deviation(axis: Axis) -> float:
    """J = v² (sqrt(2) - 1)/a of a right angle that keeps the band [m]; 0: below what M205 takes."""

    def deviation(velocity: float) -> float:
        return velocity**2 * (sqrt(2.0) - 1.0) / written(axis)

    least, most = JUNCTION_DEVIATIONS
    if deviation(axis.corner_velocity(USUAL)) < least:
        return 0.0
    return min(max(least, deviation(USUAL_CORNER)), most)


def _marlin_notes(axis: Axis, typed: Typed) -> tuple[Message, ...]:
    least, _ = JUNCTION_DEVIATIONS
    by_least = sqrt(least * written(axis) / (sqrt(2.0) - 1.0))
    fits = axis.follows and _junction_deviation(axis)
    bound = "marlin-corner-bound" if fits else "marlin-step-bound"
    return (
        Message("marlin-jerk"),
        *make_up(axis, typed),
        *of_corner(axis, bound, USUAL, least=1e3 * by_least),
        Message("marlin-build"),
        Message("marlin-grid"),
    )


GROUP = (Row(Setting.TOGETHER, "M205 J", index="corner", unit="mm", meaning="group-row-deviation"),)

CONTROL = Control(
    kind=MARLIN,
    rows=_marlin,
    layout=G_CODE,
    names_axes=True,
    shapers=USUAL,
    notes_of=_marlin_notes,
    group=GROUP,
    corner=CornerRule(
        kind=Corner.DEVIATION,
        source="Marlin 5ec63799, planner.cpp: junction deviation",
        least=JUNCTION_DEVIATIONS[0],
        most=JUNCTION_DEVIATIONS[1],
    ),
)
