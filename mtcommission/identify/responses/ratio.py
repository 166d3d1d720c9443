"""What every way of estimating a response shares: signals made ready, and its lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mtcommission.identify.measurement import Array, ComplexArray, Output

HIGHEST_SHARE = 0.3
"""Share of the sampling frequency up to which lines are kept: above it anti-alias filters act, and
what the hold of the force folds back is more than some per cent."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signals:
    """Input and output of one response, made ready.

    A position drifts and its spectrum falls by four decades, which leaks into every line; so its
    differences are transformed and the lines divided by those of a difference, which is exact.
    """

    step: float  # Of the clock [s]
    # input, output: Shape (n,); the output is the difference where it is a position.
    input: Array
    output: Array
    reference: Array | None  # Recorded excitation, shape (n,); None where there is none
    is_difference: bool  # Whether the output is a difference

    def undo(self, frequency_hz: Array, values: ComplexArray) -> ComplexArray:
        """Return a response to the output itself, shape (n_lines,)."""
        if not self.is_difference:
            return values
        lag = np.exp(2j * np.pi * frequency_hz * self.step)
        undone: ComplexArray = values / (lag - 1.0)
        return undone


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lines:
    """A response by line, and what it is worth."""

    # frequency_hz, values, coherence: Shape (n_lines,).
    frequency_hz: Array
    values: ComplexArray
    coherence: Array
    averages: float  # Independent ones
    resolution_hz: float  # Half-power width of the window [Hz]; 0 for whole periods


def prepare(
    step: float, input_: Array, output: Array, reference: Array | None, *, kind: Output
) -> Signals:
    """Return signals without their means, a position as differences."""
    is_difference = kind is Output.POSITION
    if is_difference:
        output, input_ = np.diff(output), input_[:-1]
    if reference is not None:
        reference = reference[: input_.size] - reference[: input_.size].mean()
    return Signals(
        step=step,
        input=input_ - input_.mean(),
        output=output - output.mean(),
        reference=reference,
        is_difference=is_difference,
    )
