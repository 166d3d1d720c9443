"""What a fit says of one state of the machine: estimates with standard errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.identify.fit.lines import Lines
from mtcommission.identify.fit.projection import Poles, predict
from mtcommission.identify.measurement import (
    Array,
    ComplexArray,
    FrequencyResponse,
    Sensor,
    Spectrum,
)
from mtcommission.machine.identified import Estimate, MeasuredMode


@dataclass(frozen=True, slots=True, kw_only=True)
class FittedMode:
    """A mode with common poles."""

    frequency_hz: Estimate  # f [Hz]
    damping_ratio: Estimate  # ζ [-]
    # Residue in each response, in their order, polarity put right [1/kg; 1/(kg m²) on a rotary
    # axis; - for a base-excited one].
    gains: tuple[Estimate, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedResponse:
    """What a fit says of one response."""

    response: FrequencyResponse  # As measured
    is_used: NDArray[np.bool_]  # Which of its lines were fitted, shape (n_lines,)
    lines: Lines  # As the fit took them, with their standard errors
    polarity: int  # -1 where the sensor or the force counts the other way round, else 1
    inverse_mass: Estimate  # b = 1/m, polarity put right [1/kg]
    # Whether b stands for the mass that the force moves; else for what lies below the band.
    has_rigid_body: bool
    delay: Estimate  # tau [s]
    lag: Estimate | None  # T [s]; None where none shows
    # poles, gains: Of the model, as measured.
    poles: Poles
    gains: Array
    place: int  # Which of the poles' delays and lags are its own

    def model(self, frequency_hz: Array) -> ComplexArray:
        """Return the model's response, as measured with its polarity, shape (n,)."""
        derivative = self.response.output.derivative
        own = self.poles, self.gains
        return predict(frequency_hz, *own, place=self.place, derivative=derivative)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fitted:
    """One state of the machine: common poles, and each response."""

    responses: tuple[FittedResponse, ...]  # In the order given
    modes: tuple[FittedMode, ...]  # By frequency
    drag: Estimate  # c = viscous friction by mass [1/s]
    band_hz: tuple[float, float]  # Lowest and highest line that was fitted [Hz]
    # Weighted rms of the residuals by the noise that the coherence tells; 1 = as good as that.
    misfit: float
    model_error: float  # Share of |H| that the model misses beyond noise [-]
    notes: tuple[Message, ...] = ()  # What was chosen, left out and doubtful

    def has(self, sensor: Sensor) -> bool:
        """Return whether one of the responses shows a sensor."""
        return any(one.response.sensor is sensor for one in self.responses)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FittedSpectrum:
    """The peaks of a spectrum."""

    spectrum: Spectrum  # As measured
    is_used: NDArray[np.bool_]  # Which of its lines were fitted
    # By frequency, with their shares at the tool; two within the window's width show as one.
    modes: tuple[MeasuredMode, ...]
    density: Array  # The model on the fitted lines

    @property
    def power(self) -> float:
        """Its largest density."""
        return float(self.spectrum.density[self.is_used].max())
