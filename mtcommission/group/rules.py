"""How controls slow down at corners: what they are told, by kind of control."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import cos, inf, pi, sin, sqrt

from mtcommission.group.corner import CornerSpeed


class Corner(Enum):
    """What a control does at a corner."""

    STEP = "step"  # each axis may step its velocity by so much
    JUNCTION = "junction"  # the speed of an arc that is not driven: v² = q s/(1 - s), s = cos(α/2)
    ARC = "arc"  # rounds it within a tolerance


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerRule:
    """The rule of a kind of control, and where it was read."""

    kind: Corner
    name: str  # of its parameter in the control; "" where none is known
    source: str
    is_verified: bool = True
    share: float = 1.0  # of the acceleration limit that an arc may use [-]


LINUXCNC_SHARE = sqrt(0.75)
"""The blend keeps 0.866 of the acceleration for the arc, the rest for along it."""

RULES = {
    "sinumerik": CornerRule(
        kind=Corner.ARC,
        name="G642, G643: MD33100 COMPRESS_POS_TOL, SD42465 SMOOTH_CONTUR_TOL",
        source="SINUMERIK Basic Functions 01/2015, B1 4.3 p. 193; that it is an arc (?)",
        is_verified=False,
    ),
    "fanuc": CornerRule(
        kind=Corner.STEP,
        name="No. 1783",
        source="FANUC Series 0i Connection Manual B-63833EN-1/02, 7 p. 354",
    ),
    "twincat": CornerRule(
        kind=Corner.ARC,
        name="#set paramVertexSmoothing(2; 2; radius)#",
        source="TwinCAT TF5100 NCI, parabolic smoothing; an arc is taken for the parabola",
        is_verified=False,
    ),
    "isg": CornerRule(
        kind=Corner.ARC,
        name="#CONTOUR MODE, PATH_DEV (?)",
        source="names second-hand",
        is_verified=False,
    ),
    "heidenhain": CornerRule(
        kind=Corner.STEP,
        name="pathTolerance (?)",
        source="names second-hand",
        is_verified=False,
    ),
    "linuxcnc": CornerRule(
        kind=Corner.ARC,
        name="G64 P",
        source="LinuxCNC 5c41560e, blendmath.c",
        share=LINUXCNC_SHARE,
    ),
    "klipper": CornerRule(
        kind=Corner.JUNCTION,
        name="square_corner_velocity",
        source="Klipper 84104bbb, toolhead.py",
    ),
}
"""By kind of control; the others are taken to let the velocity step."""

PLAIN = CornerRule(kind=Corner.STEP, name="", source="assumed", is_verified=False)


def rule_of(kind: str) -> CornerRule:
    """Return the rule of a kind of control."""
    return RULES.get(kind, PLAIN)


def largest_step(speeds: tuple[CornerSpeed, ...]) -> float:
    """Return by how much the velocity of an axis may step at any of the corners [m/s]."""
    return min((2.0 * sin(0.5 * one.angle) * one.speed for one in speeds), default=inf)


def junction_speed(speeds: tuple[CornerSpeed, ...]) -> float:
    """Return the speed at 90 degrees whose rule keeps the speed at every corner [m/s].

    v² = q s/(1 - s) with s = cos(α/2), so that the speed at 90 degrees tells q.
    """
    square = cos(0.25 * pi)
    found = []
    for one in speeds:
        s = cos(0.5 * one.angle)
        found.append(one.speed * sqrt((1.0 - s) / s * square / (1.0 - square)))
    return min(found, default=inf)


def value_of(rule: CornerRule, speeds: tuple[CornerSpeed, ...]) -> float:
    """Return what the control is told: a velocity [m/s], or the tolerance of arcs [m]."""
    if rule.kind is Corner.ARC:
        return max((one.arc.deviation for one in speeds), default=0.0)
    return (junction_speed if rule.kind is Corner.JUNCTION else largest_step)(speeds)
