"""Poles, margins and bandwidth of a loop, and where a mode and the servo mix."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from mtcommission.loop.analysis.frequency import SQRT_HALF, FrequencyResponse
from mtcommission.loop.model.assembly import SampledLoop
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, PlantMode

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopAnalysis:
    """How good a loop is, whatever its setpoint; margins with the loop cut at F_set."""

    is_stable: bool  # all poles of the lifted loop lie inside the unit circle
    poles: ComplexArray  # of the lifted loop, ln(z)/T_p [1/s], without dead times (z = 0)
    gain_margin_up_db: float  # by how much the gain may rise; inf if by any amount
    gain_margin_down_db: float  # by how much it may fall
    phase_margin_deg: float  # least over all crossings of the unit circle; inf without one
    sensitivity_peak: float  # max |1/(1 + L)| [-]
    bandwidth_hz: float  # -3 dB of the closed velocity loop [Hz]
    dynamic_stiffness: float  # least disturbance force per tool displacement [N/m] ...
    weakest_frequency_hz: float  # ... and where [Hz]
    mode_damping: Array
    """The least damping ratio of the pole that each mode has turned into and of all pairs that hold
    at least ``NOTABLE_SHARE`` of the mode: what of it rings longest, (n_modes,) [-]."""

    @property
    def gain_margin_db(self) -> float:
        """The smaller of both gain margins."""
        return min(self.gain_margin_up_db, self.gain_margin_down_db)


def analyse_loop(loop: SampledLoop, response: FrequencyResponse) -> LoopAnalysis:
    """Return poles, margins and bandwidth of a loop with its ``frequency_response``.

    Source: Åström & Hägglund, Advanced PID Control, 2006, ch. 4 (margins, sensitivity peak).
    """
    found = share_out(loop)
    weakest = int(np.argmax(np.abs(response.compliance)))
    up, down = _gain_margins_db(response.open_loop)
    return LoopAnalysis(
        is_stable=found.radius < 1.0 - STEADY,
        poles=found.poles,
        gain_margin_up_db=up,
        gain_margin_down_db=down,
        phase_margin_deg=_phase_margin_deg(response.open_loop),
        sensitivity_peak=float(np.max(1.0 / np.abs(1.0 + response.open_loop))),
        bandwidth_hz=_bandwidth_hz(response),
        dynamic_stiffness=1.0 / float(np.abs(response.compliance[weakest])),
        weakest_frequency_hz=float(response.frequency_hz[weakest]),
        mode_damping=_mode_damping(loop.plant, found.poles, found.shares, loop.lifted.dt),
    )


DEAD_TIME_RADIUS = 1e-3
"""Lifted poles inside this circle are dead times: at 2 ms they decay in 0.3 ms (empirical)."""

NOTABLE_SHARE = 0.1
"""A pair of poles that holds less of a mode than this is not counted as the mode's (empirical)."""

STEADY = 1e-10
"""A pole this close to the unit circle does not decay: rounding, not damping."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleShares:
    """Closed-loop poles, and how much of each is each mode."""

    radius: float  # largest magnitude of a pole in the z plane [-]
    poles: ComplexArray  # in the s plane, dead times left out, (n_poles,) [1/s]
    shares: Array  # participation of each mode in each pole, (n_modes, n_poles) [-]


def share_out(loop: SampledLoop) -> PoleShares:
    """Return the closed-loop poles and the participation of the plant's modes in them."""
    own, dt = loop.own_size, loop.lifted.dt  # the setpoint that is kept behind it has no dynamics
    parts = tuple(eig(loop.lifted.A[:own, :own], left=True, right=True))
    z, left, right = (np.asarray(part, dtype=np.complex128) for part in parts)
    alive = np.abs(z) > DEAD_TIME_RADIUS
    return PoleShares(
        radius=float(np.max(np.abs(z))),
        poles=np.asarray(np.log(z[alive]) / dt, dtype=np.complex128),
        shares=_participation(loop, left[:, alive], right[:, alive]),
    )


def _participation(loop: SampledLoop, left: ComplexArray, right: ComplexArray) -> Array:
    """How much of each closed-loop pole is each plant mode, shape (n_modes, n_poles).

    Participation factors |w_i v_i| / |w v| of deflection and rate. The observer counts by its
    error x̂ - x instead of x̂, so that its own poles, which the plant never feels (separation
    principle), have no share in any mode.

    Source: Pérez-Arriaga, Verghese & Schweppe, IEEE Trans. PAS-101 (1982), participation factors.
    """
    plant = loop.plant
    norm = np.abs(np.sum(np.conj(left) * right, axis=0))
    place = {name: i for i, name in enumerate(loop.states)}
    shares = np.zeros((len(plant.modes), right.shape[1]))
    for k, mode in enumerate(plant.modes):
        for state in (mode.deflection, mode.rate):
            row = left[state]
            estimate = place.get(f"observer.{plant.states[state]}")
            if estimate is not None:
                row = row + left[estimate]
            shares[k] += np.abs(row * right[state])
    return np.asarray(shares / np.maximum(norm, np.finfo(np.float64).tiny))


def _mode_damping(plant: Plant, poles: ComplexArray, shares: Array, dt: float) -> Array:
    """The least damping ratio of the poles that are each mode's, shape (n_modes,)."""
    upper, near, chosen = _assign(plant, poles, shares, dt)
    ratio = -near.real / np.abs(near)
    found = np.take_along_axis(ratio, chosen[:, None], axis=1)[:, 0]
    # Both poles of a pair hold the same share.
    part = 2.0 * shares[:, upper] / np.sum(shares, axis=1, keepdims=True)
    counts = (part >= NOTABLE_SHARE) & (poles[upper].imag > 0.0)
    return np.asarray(np.minimum(found, np.where(counts, ratio, inf).min(axis=1)))


def mode_poles(loop: SampledLoop) -> ComplexArray:
    """Return the closed-loop pole that each mode of the plant has turned into, (n_modes,) [1/s]."""
    found = share_out(loop)
    _, near, chosen = _assign(loop.plant, found.poles, found.shares, loop.lifted.dt)
    return np.asarray(np.take_along_axis(near, chosen[:, None], axis=1)[:, 0])


def _assign(
    plant: Plant, poles: ComplexArray, shares: Array, dt: float
) -> tuple[NDArray[np.int64], ComplexArray, NDArray[np.int64]]:
    """Poles that count, each unfolded towards each mode, and the one that each mode has become.

    That is the pole with the largest share of the mode per distance from the mode's own
    pole: where mode and servo mix, the share alone may jump to the servo's pole. One pole of each
    conjugate pair takes part, and each mode gets a pair of its own. Real poles, whose shares
    are large and of opposite sign, count only where too few pairs are left.
    """
    upper = np.flatnonzero(poles.imag > 0.0)
    if upper.size < len(shares):
        upper = np.flatnonzero(poles.imag >= 0.0)
    near = np.array([[unfold(pole, mode, dt) for pole in poles[upper]] for mode in plant.modes])
    own = np.array([[mode.pole] for mode in plant.modes])
    distance = np.abs(near - own) / np.abs(own)
    claim = np.maximum(shares[:, upper], LEAST_SHARE) / np.maximum(distance, LEAST_SHARE)
    chosen = np.argmax(claim, axis=1)
    if len(np.unique(chosen)) < len(chosen):
        # Loads as long as a loop is tuned; where each mode claims another pole it finds the same.
        from scipy.optimize import linear_sum_assignment

        _, chosen = linear_sum_assignment(-np.log(claim))
    return upper, near, np.asarray(chosen)


LEAST_SHARE = 1e-9
"""Keeps a logarithm finite where a mode has no share in a pole, or is left where it was."""


def unfold(pole: complex, mode: PlantMode, dt: float) -> complex:
    """Return the pole with the frequency nearest to the mode's that looks alike every ``dt``.

    Sampling at the position cycle ``dt`` [s] folds frequencies above 1/(2 T_p).
    """
    wanted = mode.pole.imag
    turn = 2 * pi / dt
    alike = [
        complex(pole.real, sign * pole.imag + turn * round((wanted - sign * pole.imag) / turn))
        for sign in (1.0, -1.0)
    ]
    return min(alike, key=lambda item: abs(item.imag - wanted))


def _gain_margins_db(open_loop: ComplexArray) -> tuple[float, float]:
    """How much the gain may rise and fall until L passes through -1; inf if it never does.

    Crossings of the negative real axis are interpolated on the refined grid, where
    ``control.stability_margins`` agrees to 3e-7 (tested).
    """
    here, there = open_loop[:-1], open_loop[1:]
    cuts = here.imag * there.imag < 0.0
    here, there = here[cuts], there[cuts]
    share = here.imag / (here.imag - there.imag)
    real = here.real + share * (there.real - here.real)
    level = -20.0 * np.log10(-real[real < 0.0])
    up, down = level[level >= 0.0], -level[level < 0.0]
    return float(np.min(up, initial=inf)), float(np.min(down, initial=inf))


def _phase_margin_deg(open_loop: ComplexArray) -> float:
    """Smallest distance of L from -1 on the unit circle, as an angle; inf without crossing."""
    level = np.log(np.abs(open_loop))
    cuts = np.flatnonzero(level[:-1] * level[1:] < 0.0)
    share = level[cuts] / (level[cuts] - level[cuts + 1])
    turn = np.angle(open_loop[cuts + 1] / open_loop[cuts])
    phase = np.angle(-open_loop[cuts]) + share * turn
    return float(np.degrees(np.min(np.abs(phase), initial=inf)))


def _bandwidth_hz(response: FrequencyResponse) -> float:
    """Where the closed velocity loop falls below -3 dB for the first time [Hz]."""
    closed = np.abs(response.closed_velocity_loop)
    below = np.flatnonzero(closed < SQRT_HALF)
    if not below.size:
        return inf
    i = int(below[0])
    if i == 0:
        return float(response.frequency_hz[0])
    low, high = response.frequency_hz[i - 1], response.frequency_hz[i]
    share = (closed[i - 1] - SQRT_HALF) / (closed[i - 1] - closed[i])
    return float(low + share * (high - low))


CLEARLY_LESS = 0.8
"""Shown damping below this share of that of a larger part is worth a sentence (empirical)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Swing:
    """One pair of closed-loop poles as part of a mode."""

    frequency_hz: float  # |s| / (2 π), where the mode sees it [Hz]
    damping_ratio: float  # [-]
    share: float  # participation of the mode in both poles, relative to that in all [-]


@dataclass(frozen=True, slots=True, kw_only=True)
class MixedMode:
    """A mode whose shown damping ratio does not tell all."""

    name: str
    shown: Swing
    """The pair whose damping ratio is shown as the mode's: the least damped of those that hold a
    notable part of it."""
    larger: Swing  # the pair that holds most of it

    @property
    def remark(self) -> Message:
        """What belongs beside the shown damping ratio."""
        return Message(
            "loop-mixed-mode",
            mode=self.name,
            shown_frequency=self.shown.frequency_hz,
            shown_share=self.shown.share,
            larger_share=self.larger.share,
            larger_frequency=self.larger.frequency_hz,
            larger_damping=self.larger.damping_ratio,
        )


def find_mixed_modes(loop: SampledLoop, damping: Array) -> tuple[MixedMode, ...]:
    """Return the modes that ring mostly in another pair of poles, and there clearly more damped.

    ``damping``: the ratio that is shown for each mode, from ``analyse_loop``, shape (n_modes,) [-].
    """
    closed, found = share_out(loop), []
    for mode, row, ratio in zip(loop.plant.modes, closed.shares, damping, strict=True):
        swings = [
            Swing(
                frequency_hz=abs(near) / (2 * pi),
                damping_ratio=-near.real / abs(near),
                share=2.0 * float(share / np.sum(row)),
            )
            for pole, share in zip(closed.poles, row, strict=True)
            if pole.imag > 0.0
            for near in [unfold(pole, mode, loop.lifted.dt)]
        ]
        shown = min(swings, key=lambda item: abs(item.damping_ratio - ratio), default=None)
        larger = max(swings, key=lambda item: item.share, default=None)
        if shown and larger and shown.damping_ratio < CLEARLY_LESS * larger.damping_ratio:
            found.append(MixedMode(name=mode.name, shown=shown, larger=larger))
    return tuple(found)
