"""Where a mode and the servo mix, so that no closed-loop pole is the mode's alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from mtcommission.loop.analysis.analysis import Array, ComplexArray, share_out, unfold
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.messages.message import Message
from mtcommission.plant.plant import PlantMode

CLEARLY_LESS = 0.8
"""Shown damping below this share of that of a larger part is worth a sentence (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Swing:
    """One pair of closed-loop poles as part of a mode."""

    frequency_hz: float  # |s| / (2 π) [Hz]
    damping_ratio: float  # [-]
    share: float  # participation of the mode in the pair, relative to that in all poles [-]


@dataclass(frozen=True, slots=True, kw_only=True)
class MixedMode:
    """A mode whose shown damping ratio does not tell all."""

    name: str
    shown: Swing
    """The pair whose damping ratio is shown as the mode's: the least damped of those that hold a
    notable part of it."""
    larger: Swing  # the pair that holds most of it


def find_mixed_modes(loop: SampledLoop, damping: Array) -> tuple[MixedMode, ...]:
    """Return the modes that ring mostly in another pair of poles, and there clearly more damped.

    Empty where the shown ratios tell all. ``loop``: of one corner; ``damping``: damping ratio shown
    for each mode, from ``analyse_loop``, shape (n_modes,) [-].

    Examples
    --------
    >>> from mtcommission.loop.tuning.tuning import tune_loop
    >>> from mtcommission.profile.shipped import read_shipped
    >>> tuned = tune_loop(read_shipped("rotary-table").machine)
    >>> find_mixed_modes(tuned.loops[0], tuned.nominal.mode_damping)
    ()
    """
    closed = share_out(loop)
    found = []
    for mode, row, ratio in zip(loop.plant.modes, closed.shares, damping, strict=True):
        swings = _swings(closed.poles, row / np.sum(row), mode, loop.lifted.dt)
        shown = min(swings, key=lambda item: abs(item.damping_ratio - ratio), default=None)
        larger = max(swings, key=lambda item: item.share, default=None)
        if shown and larger and shown.damping_ratio < CLEARLY_LESS * larger.damping_ratio:
            found.append(MixedMode(name=mode.name, shown=shown, larger=larger))
    return tuple(found)


def explain_mixing(mixed: Sequence[MixedMode]) -> tuple[Message, ...]:
    """Return one remark for each mode from ``find_mixed_modes``."""
    return tuple(
        Message(
            "loop-mixed-mode",
            mode=item.name,
            shown_frequency=item.shown.frequency_hz,
            shown_share=item.shown.share,
            larger_share=item.larger.share,
            larger_frequency=item.larger.frequency_hz,
            larger_damping=item.larger.damping_ratio,
        )
        for item in mixed
    )


def _swings(poles: ComplexArray, shares: Array, mode: PlantMode, dt: float) -> list[Swing]:
    """Conjugate pairs, at the frequency where the mode sees them, with its share in both poles."""
    pairs = [(unfold(p, mode, dt), s) for p, s in zip(poles, shares, strict=True) if p.imag > 0.0]
    return [
        Swing(
            frequency_hz=abs(pole) / (2 * pi),
            damping_ratio=-pole.real / abs(pole),
            share=2.0 * float(share),
        )
        for pole, share in pairs
    ]
