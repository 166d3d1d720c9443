"""An axis as measured: its states, its modes over all of them, and what is in doubt."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.identify.fit.fitted import Fitted
from mtcommission.identify.fit.peaks import FittedSpectrum
from mtcommission.identify.measurement import (
    Evidence,
    FreeVibration,
    FrequencyResponse,
    Input,
    Spectrum,
)
from mtcommission.machine.identified import Estimate, MeasuredMode
from mtcommission.messages.message import Message

NOT_DESCRIBED = "identify-not-described"
"""Kind of the message of a fit that misses what was measured."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """What was found in one state of the machine."""

    name: str  # Position, payload or level where a file names it, else the files
    modes: tuple[MeasuredMode, ...]  # By frequency
    moving_mass: Estimate | None  # None without a rigid body in the band
    # delay, lag: None without phase; no lag where none shows.
    delay: Estimate | None
    lag: Estimate | None
    result: Fitted | FittedSpectrum | FreeVibration  # Where the modes come from


@dataclass(frozen=True, slots=True, kw_only=True)
class IdentifiedMode:
    """A mode over all states; the intervals hold the states."""

    name: str  # For the profile
    # frequency_hz, damping_ratio, measured_gain, tcp_gain: Middle of the states, with a standard
    # error of at least a quarter of their range.
    frequency_hz: Estimate
    damping_ratio: Estimate
    measured_gain: Estimate | None
    tcp_gain: Estimate | None
    # For each state, which of its modes it is; None where it was not seen.
    seen: tuple[int | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """What the corners must hold."""

    # frequency, damping: Relative [-].
    frequency: float
    damping: float
    because: tuple[Message, Message]  # For frequency and for damping
    apart: bool  # Whether each state is judged by itself, so that no spread need span them


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Identified:
    """An axis as measured."""

    evidence: Evidence  # From which it comes
    states: tuple[State, ...]  # In the order of the files
    modes: tuple[IdentifiedMode, ...]  # By frequency
    # moving_mass, delay, lag: Over all states; None where nothing tells.
    moving_mass: Estimate | None
    delay: Estimate | None
    lag: Estimate | None
    spread: Spread  # Of frequencies and damping
    warnings: tuple[Message, ...]  # What was chosen, left out, doubtful or not known

    @property
    def measurements(self) -> tuple[FrequencyResponse | Spectrum | FreeVibration, ...]:
        """Everything that was measured, in the order of the files within each kind."""
        evidence = self.evidence
        return (*evidence.responses, *evidence.spectra, *evidence.vibrations)

    @property
    def rotary(self) -> bool:
        """Whether lengths are angles."""
        return any(one.rotary for one in self.measurements)

    @property
    def fits(self) -> tuple[Fitted, ...]:
        """The states that have responses."""
        return tuple(one.result for one in self.states if isinstance(one.result, Fitted))

    @property
    def doubt(self) -> Message | None:
        """Why the model does not describe what was measured; None where it does."""
        notes = [note for fit in self.fits for note in fit.notes]
        return next((note for note in notes if note.kind == NOT_DESCRIBED), None)

    @property
    def is_base_excited(self) -> bool:
        """Whether no force was measured anywhere, only accelerations."""
        inputs = {one.response.input for fit in self.fits for one in fit.responses}
        return inputs == {Input.ACCELERATION} or not inputs
