"""The limits that a refined profile leads to, beside those of the record."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.errors import ComputationError
from mtcommission.messages.message import Message
from mtcommission.profile.read import parse_profile
from mtcommission.record.record import Record


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Acceleration and jerk, and the settling time of the slowest move in the worst corner [SI].

    ``settling_time`` None: not settled. ``met``: whether all requirements are.
    """

    acceleration: float
    jerk: float
    settling_time: float | None
    met: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NewLimits:
    """Old beside new; ``new`` None where ``failure`` says why there are none."""

    old: Limits
    new: Limits | None
    failure: Message | None


def find_new_limits(record: Record, profile: str) -> NewLimits:
    """Return what ``run`` recommends for a refined profile, beside what the record recommends."""
    from mtcommission.commission import commission  # half of what verify would load

    best = record.limits.recommended
    old = Limits(
        acceleration=best.acceleration,
        jerk=best.jerk,
        settling_time=best.settling_time,
        met=record.assessment.met,
    )
    try:
        found = commission(parse_profile(profile, where="--refine"))
    except ComputationError as error:
        return NewLimits(old=old, new=None, failure=Message("verify-no-limits", why=str(error)))
    chosen = found.recommended
    return NewLimits(
        old=old,
        new=Limits(
            acceleration=chosen.limits.acceleration,
            jerk=chosen.limits.jerk,
            settling_time=chosen.settling_time,
            met=chosen.assessment.is_met,
        ),
        failure=None,
    )
