"""Limits of the machining modes as a control takes them, each judged with its own band."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.export.rounding import Coding, Typed, type_limits
from mtcommission.export.subject import Subject, for_mode
from mtcommission.export.wording import name_mode, show_value
from mtcommission.messages.message import Message


@dataclass(frozen=True, slots=True, kw_only=True)
class TypedMode:
    """The limits of a machining mode.

    Parameters
    ----------
    name
        surface, accuracy or speed.
    band
        Largest deviation of the tool [m].
    typed
        None where no limits meet the band: then nothing may be typed in for this mode.
    attainable
        Least band that could be met instead [m]; None if it is not known.
    """

    name: str
    band: float
    typed: Typed | None
    attainable: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Values:
    """Everything that an export types in.

    Parameters
    ----------
    recommended
        The recommendation.
    modes
        Empty for a control that knows no machining modes.
    """

    recommended: Typed
    modes: tuple[TypedMode, ...]

    @property
    def left_out(self) -> tuple[TypedMode, ...]:
        """Machining modes whose band no limits meet."""
        return tuple(mode for mode in self.modes if mode.typed is None)

    @property
    def meets_requirements(self) -> bool:
        """Whether all that the control would need meets its requirements."""
        return self.recommended.verdict.assessment.is_met and not self.left_out


def explain_left_out(subject: Subject, mode: TypedMode) -> Message:
    """Return why a mode is left out, with its band and the one that could be met."""
    band, attainable = (
        None if value is None else show_value(value, subject.length, in_degrees=True)
        for value in (mode.band, mode.attainable)
    )
    name = name_mode(mode.name)
    if attainable:
        return Message("export-no-limits-but", mode=name, band=band, attainable=attainable)
    return Message("export-no-limits-within", mode=name, band=band)


def type_modes(subject: Subject, coding: Coding) -> tuple[TypedMode, ...]:
    """Return the limits of every machining mode of the record as typed.

    Parameters
    ----------
    subject
        The axis in the loop that is judged.
    coding
        How the control stores limits.

    Returns
    -------
    tuple of TypedMode
    """
    found = []
    for mode in subject.record.limits.modes:
        typed = None
        if mode.meets_requirements:
            typed = type_limits(for_mode(subject, mode), coding)
            typed = typed if typed.verdict.assessment.is_met else None
        found.append(
            TypedMode(name=mode.name, band=mode.band, typed=typed, attainable=mode.attainable)
        )
    return tuple(found)
