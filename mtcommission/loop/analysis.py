"""How good a loop is: responses over frequency, affine in its gains, poles, margins, modes.

The loop is cut at F_set. What the controller asks for is a sum over Kp, Kp/Tn, Kp Kv, Kp Kv/Tn and
the state gains; what each of them is multiplied with depends on plant, cycles, filters, sensors and
observer alone and is scanned once for all gains. Everything at the velocity cycle is exact in
z = exp(i ω T_v); a position loop that closes in the control is taken in its base band, that is, the
images of its slower sampling are left out (they lie above 1/(2 T_p) and are attenuated by the hold
and the plant). python-control gives the same to 1e-9 from ``diagram.build_open_loop`` (tested).

The grid is refined where something is read off it: at crossings and at the highest peaks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import exp, inf, nan, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.assembly import SampledLoop, discretise, discretise_disturbance
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.plant.plant import Plant, PlantMode

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

SQRT_HALF = sqrt(0.5)
"""-3 dB."""

GRID_POINTS = 800
"""Frequencies before refinement; modes get a cluster of their own (empirical: no crossing of a
shipped machine is missed, and margins do not change when doubled)."""

CLUSTER, HALF_WIDTHS, NARROWEST = 80, 4.0, 1e-3
"""Frequencies about each mode, over so many of its half-widths, at least that wide. An even number
leaves out the very resonance, where an undamped mode is infinite (empirical)."""

REFINEMENTS = 2
REFINED_POINTS = 15
"""Each refinement divides every interval of interest by so much: two leave a spacing of 0.004 %,
and what is interpolated on it is right to 1e-6. Odd, so that the middle, perhaps an undamped
resonance, is left out."""

STEADY, RIGID = 1e-10, 2
"""A pole this close to the unit circle does not decay: rounding, not damping; and how many poles a
rigid body has."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FrequencyResponse:
    """Responses over n frequencies."""

    frequency_hz: Array
    open_loop: ComplexArray  # L, loop cut at F_set
    closed_velocity_loop: ComplexArray
    """Velocity setpoint to encoder velocity, position loop open."""
    compliance: ComplexArray
    """Tool per disturbance force on the line of the drive force, all loops closed [m/N]."""


BODE = ("open_loop_db", "open_loop_deg", "closed_velocity_db")


def draw_bode(response: FrequencyResponse) -> dict[str, Array]:
    """Return what a Bode plot shows, by the names of ``BODE``; the phase begins in (-360, 0]."""
    phase = np.degrees(np.unwrap(np.angle(response.open_loop)))
    columns = (
        20.0 * np.log10(np.abs(response.open_loop)),
        phase - 360.0 * np.ceil(phase[0] / 360.0),
        20.0 * np.log10(np.abs(response.closed_velocity_loop)),
    )
    return dict(zip(BODE, columns, strict=True))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GainGrid:
    """A plant at n frequencies under all controllers that differ in their gains alone."""

    plant: Plant
    velocity_cycle: float  # T_v [s]
    omega: Array  # (n,) [rad/s]
    z: ComplexArray  # exp(i ω T_v)
    asked: ComplexArray  # force asked for, sign reversed, by gain, per set force and per force
    # of disturbance, (2, n_gains, n)
    velocity: ComplexArray  # velocity of the encoder per velocity setpoint, by Kp and Kp/Tn, (2, n)
    tool: ComplexArray  # per set force and per force of disturbance, (2, n)

    @property
    def is_damped(self) -> bool:
        """Whether only the rigid body's poles of the plant stand on the unit circle."""
        poles = np.linalg.eigvals(discretise(self.plant, self.velocity_cycle)[0])
        return int(np.sum(np.abs(poles) > 1.0 - STEADY)) <= RIGID

    def open_loop(self, controller: Controller) -> ComplexArray:
        """Return L, shape (n,)."""
        return np.asarray(_gains(controller) @ self.asked[0])

    def respond(self, controller: Controller) -> FrequencyResponse:
        """Return open and closed loop at the frequencies of the grid."""
        gains = _gains(controller)
        L, reaction = gains @ self.asked
        inner = L - gains[2:4] @ self.asked[0, 2:4]
        return FrequencyResponse(
            frequency_hz=self.omega / (2 * pi),
            open_loop=L,
            closed_velocity_loop=gains[:2] @ self.velocity / (1.0 + inner),
            compliance=self.tool[1] - self.tool[0] * reaction / (1.0 + L),
        )

    def with_filters(self, filters: tuple[ForceFilter, ...]) -> GainGrid:
        """Return the same behind more filters of the set force."""
        factor = _filtered(filters, self.z, self.velocity_cycle)
        return replace(self, asked=self.asked * factor, velocity=self.velocity * factor)


def _gains(controller: Controller) -> Array:
    """Factors of what the controller asks for, shape (4 + n_observed,)."""
    Kp, Kv, Tn = controller.velocity_gain, controller.position_gain, controller.integral_time
    gains = controller.state_gains[list(controller.observer.states)]
    return np.concatenate([[Kp, Kp / Tn, Kp * Kv, Kp * Kv / Tn], gains])


def scan(
    plants: Sequence[Plant], controller: Controller, omegas: Sequence[Array]
) -> tuple[GainGrid, ...]:
    """Return plants of the same states at frequencies of their own [rad/s], all below Nyquist.

    Of the controller its cycles, filters, sensors and observer count.
    """
    T_v, N, observer = controller.velocity_cycle, controller.cycles, controller.observer
    counts = [len(omega) for omega in omegas]
    own = np.repeat(np.arange(len(plants)), counts)
    z = np.exp(1j * np.concatenate(omegas) * T_v)
    A, B = map(np.array, zip(*(discretise(plant, T_v) for plant in plants), strict=True))
    # A disturbance on the line of the drive force enters like the force state itself.
    pushes = [discretise_disturbance(plant, T_v) for plant in plants]
    names = ("encoder", "tcp", *controller.sensors)
    rows = np.array([[plant.row(name) for name in names] for plant in plants])
    seen = rows[own] @ _resolvent(A[own], np.stack([B, pushes], axis=2)[own], z)
    encoder, tool = seen[:, 0].T, seen[:, 1].T
    rate = encoder * (1.0 - 1.0 / z) / T_v
    # The position controller's demand reaches the integral branch through the reference model.
    integral, modelled = T_v / (z - 1.0), _reference_model(controller, z)
    position = encoder
    if controller.position_loop is not PositionLoop.DRIVE:
        late = z**-N
        position = encoder * late * (1.0 - late) / (1.0 - 1.0 / z) / N
    asked = np.array([rate, integral * rate, position, integral * modelled * position])
    if observer.states:
        drives = np.column_stack([observer.B, observer.L])
        estimates = _resolvent(observer.A - observer.L @ observer.C, drives, z)
        # The observer does not know a disturbance.
        known = np.broadcast_to([[1.0, 0.0]], (z.size, 1, 2))
        told = estimates @ np.concatenate([known, seen[:, 2:]], axis=1)
        asked = np.concatenate([asked, told.transpose(1, 2, 0)])
    path = _filtered(controller.force_filters, z, T_v) / z
    asked = path * asked.swapaxes(0, 1)
    velocity = path * np.array([rate[0], integral * modelled * rate[0]])
    ends = np.cumsum(counts)
    return tuple(
        GainGrid(
            plant=plant,
            velocity_cycle=T_v,
            omega=omega,
            z=z[part],
            asked=np.ascontiguousarray(asked[:, :, part]),
            velocity=velocity[:, part],
            tool=tool[:, part],
        )
        for plant, omega, part in zip(plants, omegas, map(slice, ends - counts, ends), strict=True)
    )


def lay_grids(plants: Sequence[Plant], controller: Controller) -> tuple[GainGrid, ...]:
    """Return plants of the same states from 0.1 Hz to the Nyquist frequency of the velocity cycle.

    With a cluster of frequencies about each mode.
    """
    nyquist = pi / controller.velocity_cycle
    omegas = []
    for plant in plants:
        parts = [np.geomspace(2 * pi * 0.1, 0.999 * nyquist, GRID_POINTS)]
        for mode in plant.modes:
            width = HALF_WIDTHS * max(mode.damping_ratio, NARROWEST)
            parts.append(mode.natural_frequency * (1.0 + np.linspace(-width, width, CLUSTER)))
        omega = np.unique(np.concatenate(parts))
        omegas.append(omega[(omega > 0.0) & (omega < nyquist)])
    return scan(plants, controller, omegas)


def complete(grids: Sequence[GainGrid], controller: Controller) -> tuple[FrequencyResponse, ...]:
    """Return open and closed loops, finest where margins, the bandwidth and the peaks are read."""
    plants, found = [grid.plant for grid in grids], [grid.respond(controller) for grid in grids]
    for _ in range(REFINEMENTS):
        finer = scan(plants, controller, [_refine(item) for item in found])
        found = [_merge(*pair, controller) for pair in zip(found, finer, strict=True)]
    return tuple(found)


def _resolvent(A: Array, drives: Array, z: ComplexArray) -> ComplexArray:
    """(zI - A)^-1 drives at each frequency, shape (n_frequencies, n, n_drives)."""
    matrices = z[:, None, None] * np.eye(A.shape[-1]) - A
    drives = np.broadcast_to(drives, (z.size, *drives.shape[-2:]))
    return np.asarray(np.linalg.solve(matrices, drives))


def _filtered(
    filters: tuple[ForceFilter, ...], z: ComplexArray, velocity_cycle: float
) -> ComplexArray:
    """Filters of the set force by the bilinear transform, which is how they are sampled."""
    s, path = 2.0 / velocity_cycle * (z - 1.0) / (z + 1.0), np.ones_like(z)
    for item in filters:
        numerator, denominator = filter_polynomials(item)
        path = path * np.polyval(numerator, s) / np.polyval(denominator, s)
    return path


def _reference_model(controller: Controller, z: ComplexArray) -> ComplexArray:
    """First-order lag at the velocity cycle through which the integral sees its setpoint."""
    if not controller.reference_model_time:
        return np.ones_like(z)
    share = 1.0 - exp(-controller.velocity_cycle / controller.reference_model_time)
    return np.asarray(share / (z - 1.0 + share))


def _refine(found: FrequencyResponse) -> Array:
    """Frequencies evenly between those between which something is read [rad/s]."""
    L, omega = found.open_loop, 2 * pi * found.frequency_hz
    here, there = L[:-1], L[1:]
    marked = (here.imag * there.imag < 0.0) & (np.minimum(here.real, there.real) < 0.0)
    for level in (np.log(np.abs(L)), np.abs(found.closed_velocity_loop) - SQRT_HALF):
        marked |= level[:-1] * level[1:] < 0.0
    for size in (1.0 / np.abs(1.0 + L), np.abs(found.compliance)):
        peak = int(np.argmax(size))
        marked[max(peak - 1, 0) : peak + 1] = True
    low, high = omega[:-1][marked, None], omega[1:][marked, None]
    share = np.arange(1, REFINED_POINTS) / REFINED_POINTS
    return np.asarray((low + share * (high - low)).ravel())


def _merge(one: FrequencyResponse, finer: GainGrid, controller: Controller) -> FrequencyResponse:
    other = finer.respond(controller)
    names = [item.name for item in fields(FrequencyResponse)]
    both = {name: np.concatenate([getattr(one, name), getattr(other, name)]) for name in names}
    order = np.argsort(both["frequency_hz"], kind="stable")
    return FrequencyResponse(**{name: values[order] for name, values in both.items()})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LoopAnalysis:
    """How good a loop is, whatever its setpoint; margins with the loop cut at F_set."""

    is_stable: bool  # all poles of the lifted loop lie inside the unit circle
    poles: ComplexArray  # of the lifted loop, ln(z)/T_p [1/s], without dead times (z = 0)
    gain_margin_up_db: float  # by how much the gain may rise; inf if by any amount
    gain_margin_down_db: float  # by how much it may fall
    gain_margin_hz: float  # where the less of both is [Hz]; nan where there is none
    phase_margin_deg: float  # least over all crossings of the unit circle; inf without one
    phase_margin_hz: float  # where [Hz]
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
    up, down, gain_hz = _gain_margins(response)
    phase_margin, phase_hz = _phase_margin(response)
    return LoopAnalysis(
        is_stable=found.radius < 1.0 - STEADY,
        poles=found.poles,
        gain_margin_up_db=up,
        gain_margin_down_db=down,
        gain_margin_hz=gain_hz,
        phase_margin_deg=phase_margin,
        phase_margin_hz=phase_hz,
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoleShares:
    """Closed-loop poles, and how much of each is each mode."""

    radius: float  # largest magnitude of a pole in the z plane [-]
    poles: ComplexArray  # in the s plane, dead times left out, (n_poles,) [1/s]
    shares: Array  # participation of each mode in each pole, (n_modes, n_poles) [-]


def share_out(loop: SampledLoop) -> PoleShares:
    """Return the closed-loop poles and the participation of the plant's modes in them."""
    parts = tuple(eig(loop.lifted.A, left=True, right=True))
    z, left, right = (np.asarray(part, dtype=np.complex128) for part in parts)
    alive = np.abs(z) > DEAD_TIME_RADIUS
    return PoleShares(
        radius=float(np.max(np.abs(z))),
        poles=np.asarray(np.log(z[alive]) / loop.lifted.dt, dtype=np.complex128),
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
    wanted, turn = mode.pole.imag, 2 * pi / dt
    both = [part + turn * round((wanted - part) / turn) for part in (pole.imag, -pole.imag)]
    return complex(pole.real, min(both, key=lambda part: abs(part - wanted)))


def _gain_margins(response: FrequencyResponse) -> tuple[float, float, float]:
    """How much the gain may rise and fall until L passes through -1 [dB], and where the less [Hz].

    inf and nan if it never does. Crossings of the negative real axis are interpolated on the
    refined grid, where ``control.stability_margins`` agrees to 3e-7 (tested).
    """
    L, f = response.open_loop, response.frequency_hz
    cuts = np.flatnonzero(L[:-1].imag * L[1:].imag < 0.0)
    share = L[cuts].imag / (L[cuts].imag - L[cuts + 1].imag)
    real = L[cuts].real + share * (L[cuts + 1].real - L[cuts].real)
    place = (f[cuts] + share * (f[cuts + 1] - f[cuts]))[real < 0.0]
    level = -20.0 * np.log10(-real[real < 0.0])
    up, down = level[level >= 0.0], -level[level < 0.0]
    at = float(place[np.argmin(np.abs(level))]) if level.size else nan
    return float(np.min(up, initial=inf)), float(np.min(down, initial=inf)), at


def _phase_margin(response: FrequencyResponse) -> tuple[float, float]:
    """Least angle of L from -1 on the unit circle [deg], and where [Hz]; inf and nan: none."""
    L, f = response.open_loop, response.frequency_hz
    level = np.log(np.abs(L))
    cuts = np.flatnonzero(level[:-1] * level[1:] < 0.0)
    if not cuts.size:
        return inf, nan
    share = level[cuts] / (level[cuts] - level[cuts + 1])
    phase = np.abs(np.angle(-L[cuts]) + share * np.angle(L[cuts + 1] / L[cuts]))
    least = int(np.argmin(phase))
    place = f[cuts] + share * (f[cuts + 1] - f[cuts])
    return float(np.degrees(phase[least])), float(place[least])


def _bandwidth_hz(response: FrequencyResponse) -> float:
    """Where the closed velocity loop falls below -3 dB for the first time [Hz]."""
    closed, f = np.abs(response.closed_velocity_loop), response.frequency_hz
    below = np.flatnonzero(closed < SQRT_HALF)
    if not below.size:
        return inf
    i = int(below[0])
    if i == 0:
        return float(f[0])
    share = (closed[i - 1] - SQRT_HALF) / (closed[i - 1] - closed[i])
    return float(f[i - 1] + share * (f[i] - f[i - 1]))
