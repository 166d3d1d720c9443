"""Limits of the machining modes as a control takes them, each judged with its own band."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.export.rounding import Coding, Typed, type_limits
from mtcommission.export.subject import Subject, for_mode


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
    """

    name: str
    band: float
    typed: Typed | None


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
    for mode in subject.record["limits"]["modes"]:
        typed = None
        if mode["meets_requirements"]:
            typed = type_limits(for_mode(subject, mode), coding)
            typed = typed if typed.verdict.assessment.is_met else None
        found.append(TypedMode(name=mode["name"], band=mode["band"], typed=typed))
    return tuple(found)
