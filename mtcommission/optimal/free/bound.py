"""The time that given multipliers prove to be needed, safe against rounding.

Where modes nearly coincide, or hardly turn during the move, the multipliers are large against σ
and ∫|σ| loses digits. It is summed in the machine's extended precision (64 bits on x86; elsewhere
perhaps only double), so that the allowance for rounding stays far below the accuracy wanted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mtcommission.optimal.free.dual import DualPoint
from mtcommission.optimal.free.mesh import ROUNDOFF
from mtcommission.optimal.free.moments import MomentProblem

Array = NDArray[np.float64]
Extended = NDArray[np.longdouble]

EXTENDED_ROUNDOFF = float(np.finfo(np.longdouble).eps)
TINY = float(np.finfo(np.float64).tiny)
LOWERINGS = 50
"""Attempts to lower the bound below the span; two or three are usual."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SwitchingIntegral:
    """∫_0^T |σ| with what rounding may have taken from it."""

    value: np.longdouble  # The integral, in extended precision [s] or [s²]
    allowance: float  # Bound of its error
    end_value: float  # |σ(T)|


def prove_bound(point: DualPoint, *, span: float) -> float:
    """Return a time before which no admissible force reaches the target, whatever c is.

    Source: docs/optimal-control.md, section 2.
    """
    problem, bound = point.mesh.problem, point.bound
    doubt = point.doubt + 2.0 * ROUNDOFF * span
    bound -= min(2.0 * doubt / max(point.end_value, 1e-300) + ROUNDOFF * bound, 0.5 * bound)
    for attempt in range(LOWERINGS):
        inside = point.zeros[point.zeros < bound]
        integral = integrate_switching(
            problem, point.multipliers, np.concatenate((inside, (bound,)))
        )
        excess = float(integral.value - span) + integral.allowance + doubt
        if excess <= 0.0:
            return bound * (1.0 - 4.0 * ROUNDOFF)
        step = excess / max(integral.end_value, ROUNDOFF * integral.allowance)
        bound -= min((1.0 + attempt) * step + ROUNDOFF * bound, 0.5 * bound)
    return 0.0


def integrate_switching(
    problem: MomentProblem, multipliers: Array, ends: Array
) -> SwitchingIntegral:
    """Return ∫|σ| from 0 over the zeros to the last end.

    The allowance counts, in units of half the roundoff, |p| τ for the product p τ as far as e^{pτ}
    is still there, 6 for e^{pτ} - 1 and its division by p, and one for each term of a sum; and,
    since a zero that is off by δ hides |σ'| δ², σ²/|σ'| at each of them.
    """
    t, rates = ends.astype(np.longdouble), problem.rates.astype(np.clongdouble)
    less_one = np.expm1(np.multiply.outer(t, rates))
    grown = less_one + 1.0
    weights = problem.weights(multipliers)
    constant = problem.constant(multipliers)
    polynomial = (0.5 * t - constant) * t if problem.degree else t
    primitive = polynomial - (less_one @ (weights / rates)).real
    value = (t - constant if problem.degree else 1.0) - (grown @ weights).real
    slope = problem.degree - (grown[:-1] @ (rates * weights)).real
    # A slope below |σ|/τ says that the zero is known to its own size only: then it hides τ |σ|.
    least = np.maximum(np.abs(value[:-1]) / t[:-1], TINY)
    hidden = value[:-1] ** 2 / np.maximum(np.abs(slope), least)
    # Double precision will do for the sizes of errors.
    tau, decay = ends[:, np.newaxis], np.exp(np.multiply.outer(ends, problem.rates.real))
    modal = (6.0 + problem.size) * np.minimum(tau, (1.0 + decay) / problem.magnitudes)
    modal += tau * decay
    terms = modal.dot(problem.amplitudes(multipliers))
    terms += (2.0 + problem.size) * (problem.target_integrals(ends) + abs(constant) * ends)
    return SwitchingIntegral(
        value=abs(primitive[0]) + np.add.reduce(np.abs(primitive[1:] - primitive[:-1])),
        allowance=EXTENDED_ROUNDOFF * sum(terms.tolist()) + 2.0 * float(np.add.reduce(hidden)),
        end_value=abs(float(value[-1])),
    )
