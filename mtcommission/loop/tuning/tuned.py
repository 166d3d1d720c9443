"""A controller closed on the machine in every corner, and whether its margins suffice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.analysis import (
    FrequencyResponse,
    GainGrid,
    LoopAnalysis,
    analyse_loop,
    complete,
    lay_grids,
)
from mtcommission.loop.model.assembly import SampledLoop, as_state_space, build_loop
from mtcommission.loop.model.controller import INTERPOLATED, Controller
from mtcommission.machine.machine import NOMINAL, Corner, Machine, corners, vary
from mtcommission.machine.plant.plant import Plant, build_plant


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningSettings:
    """What a tuned loop must reach, and how its observer sees noise."""

    gain_margin_db: float = 6.0  # in every corner; Åström & Hägglund recommend 6 ... 14 dB
    phase_margin_deg: float = 30.0  # in every corner; they recommend 30 ... 60 degrees
    sensitivity_peak: float = 2.0  # in every corner [-]; they recommend 1.2 ... 2.0
    position_ratios: tuple[float, ...] = (0.0625, 0.125, 0.25, 0.5)  # Kv m / Kp that are tried [-]
    integral_ratios: tuple[float, ...] = (4.0, 8.0, 12.0)
    """Tn Kp / m that are tried [-]; Tn is never shorter than by the classic rule, and no longer
    than engineers type (Yaskawa: 40 ms at 50 Hz is a ratio of 12.6, 120 ms at 20 Hz one of 15)."""
    mode_weights: tuple[float, ...] = (1.0, 10.0)
    """Weights of the squared vibration of the tool against the squared force, see
    ``gains.feedback_gains``; each is tried."""
    least_integral_share: float = 0.5
    """Kp Kv / Tn over that of the classic rule, at least: what friction or a cutting force
    displaces, summed over time, is the reciprocal (design choice)."""
    longest_integral_time: float = 0.12
    """Tn beyond it is not proposed, but by the classic rule [s]: engineers type 5 to 120 ms, the
    longest on soft axes (Yaskawa)."""
    largest_fraction: float = 4.0
    """Where Kp begins, as a multiple of the symmetrical optimum (empirical: margins end the search
    before)."""
    reduction: float = 0.85  # from one try of a gain to the next, until the margins hold [-]
    force_noise: float = 0.05
    """Standard deviation of the unknown force of the drive that the observer assumes, relative to
    F_max [-] (empirical, like the two below: they set its bandwidth, not the accuracy of the
    loop)."""
    mode_noise: float = 0.01
    """Likewise of the force on each mode, relative to F_max [-]; without it the observer itself
    rings at the frequencies at which the encoder stands still."""
    position_noise: float = 1e-7  # standard deviation of the encoder error [m]


TUNING = TuningSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """How gains and filters are looked for, and what is worth a word."""

    least: float = 0.001
    """Below a thousandth of the symmetrical optimum, or of what was given, a gain is given up
    (empirical)."""
    bisections: int = 5  # between the first gain with the margins and the one before: 0.5 %
    closer: float = 0.995
    """Share of a gain that is tried next where the exact response misses the margins: the grid is
    coarser, which costs half a per cent or two (empirical)."""
    close_tries: int = 3
    """How often; then it is sought like the gain on the grid (empirical: one loop in a hundred)."""
    near: float = 2.0**0.5  # shapes near a good one: half a step of the coarse set, which doubles
    notch_places: tuple[float, ...] = (0.9, 1.0, 1.1)
    """Frequency of the notches tried, over that of the resonance."""
    notch_widths: tuple[float, ...] = (0.2, 0.5)  # damping of their denominators
    notch_depth: float = 0.3
    """Damping of their numerators over that. Deeper or narrower ones miss a resonance that is off
    by some per cent, and cost more phase below it (empirical)."""
    low_passes: tuple[float, ...] = (1.5, 3.0)
    """Frequency of the low-passes tried, over that at which the sensitivity peaks (empirical)."""
    low_pass_damping: float = 0.7  # the flattest pass band (Butterworth: 1/sqrt 2)
    worth: float = 1.03
    """A filter is worth its place if Kp and dynamic stiffness rise by 3 % (design choice: an entry
    more that brings less is not worth typing)."""
    most_filters: int = 2  # that are suggested: each costs phase (design choice)
    softened: float = 0.5
    """Filters that leave less than this share of the bandwidth are warned about (empirical)."""
    undamped: float = 0.5
    """And modes that keep less than this share of their own damping (empirical)."""


SEARCH = SearchSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """What a loop is beside its Kp; the defaults are the classic rule."""

    position_ratio: float = 0.25  # Kv m / Kp [-]; 1/4: speed loop damping 1
    integral_ratio: float = 4.0  # Tn Kp / m [-]; 4: Yaskawa's lower bound for the speed loop
    mode_weight: float = 0.0
    """Of the state feedback, see ``feedback_gains`` [-]; 0: none."""


CLASSIC = Shape()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CornerPlants:
    """The machine as it is in every corner."""

    corners: tuple[Corner, ...]
    """The nominal machine first, which is what the controller believes in."""
    plants: tuple[Plant, ...]  # likewise

    @property
    def model(self) -> Plant:
        """The nominal plant."""
        return self.plants[0]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TunedLoop:
    """A controller in every corner of the machine."""

    controller: Controller  # with every gain resolved
    corners: tuple[Corner, ...]  # the nominal machine first
    loops: tuple[SampledLoop, ...]  # one for each corner, like responses and analyses
    responses: tuple[FrequencyResponse, ...]
    analyses: tuple[LoopAnalysis, ...]
    shape: Shape = CLASSIC  # how it was built
    remarks: tuple[Message, ...] = ()  # what was chosen, by which rule, what could not be done
    warnings: tuple[Message, ...] = ()  # what is poor about the loop; belongs beside the verdict

    @property
    def plant(self) -> Plant:
        """The nominal plant."""
        return self.loops[0].plant

    @property
    def model(self) -> Any:
        """The nominal loop as a ``control.StateSpace``, see ``build_model``."""
        from mtcommission.loop.model import diagram  # python-control takes a second

        if self.controller.follows:
            return diagram.as_open_loop_model(as_state_space(self.loops[0]))
        return diagram.build_model(self.plant, self.controller, model=self.plant)

    @property
    def nominal(self) -> LoopAnalysis:
        """Analysis of the nominal machine."""
        return self.analyses[0]

    @property
    def least_bandwidth_hz(self) -> float:
        """Bandwidth in the worst corner [Hz]."""
        return min(analysis.bandwidth_hz for analysis in self.analyses)

    @property
    def least_stiffness(self) -> float:
        """Dynamic stiffness in the worst corner [N/m]."""
        return min(analysis.dynamic_stiffness for analysis in self.analyses)

    @property
    def least_damping(self) -> tuple[float, ...]:
        """Damping ratio of each mode in its worst corner."""
        return tuple(map(float, np.min([item.mode_damping for item in self.analyses], axis=0)))

    @property
    def keeps_margins(self) -> bool:
        """Whether the loop has the margins in every corner."""
        return all(map(has_margins, self.analyses))


def corner_plants(machine: Machine) -> CornerPlants:
    """Return the plant of a nominal machine in every corner; its requirements hold the ranges."""
    places = corners(machine)
    return CornerPlants(
        corners=places, plants=tuple(build_plant(vary(machine, corner)) for corner in places)
    )


def describe_corner(corner: Corner) -> tuple[Message, ...]:
    """Return what makes a corner, e.g. payload 100 kg and frequencies × 0.95."""
    if corner == NOMINAL:
        return (Message("place-nominal"),)
    parts = [Message("place-state", name=corner.state)] if corner.state else []
    parts.append(Message("place-payload", payload=corner.payload))
    if corner.frequency_factor != 1.0:
        parts.append(Message("place-frequencies", factor=corner.frequency_factor))
    if corner.damping_factor != 1.0:
        parts.append(Message("place-damping", factor=corner.damping_factor))
    return tuple(parts)


def close_loop(
    bench: CornerPlants, controller: Controller, grids: Sequence[GainGrid] = ()
) -> TunedLoop:
    """Return the controller in every corner, analysed; ``grids``: where they are known already."""
    grids = grids or lay_grids(bench.plants, controller)
    loops = tuple(build_loop(plant, controller, model=bench.model) for plant in bench.plants)
    responses = complete(grids, controller)
    return TunedLoop(
        controller=controller,
        corners=bench.corners,
        loops=loops,
        responses=responses,
        analyses=tuple(map(analyse_loop, loops, responses)),
    )


def close_beside(tuned: TunedLoop, machine: Machine, place: Corner) -> TunedLoop:
    """Return a loop with one corner more, ``place``, of the nominal machine behind its own."""
    plants = tuned.plant, build_plant(vary(machine, place))
    beside = CornerPlants(corners=(tuned.corners[0], place), plants=plants)
    added = close_loop(beside, tuned.controller)
    names = ("corners", "loops", "responses", "analyses")
    both: dict[str, Any] = {
        name: (*getattr(tuned, name), getattr(added, name)[1]) for name in names
    }
    return replace(tuned, **both)


def has_margins(analysis: LoopAnalysis, *, settings: TuningSettings = TUNING) -> bool:
    """Return whether one loop is stable with the required margins."""
    return (
        analysis.is_stable
        and analysis.gain_margin_db >= settings.gain_margin_db
        and analysis.phase_margin_deg >= settings.phase_margin_deg
        and analysis.sensitivity_peak <= settings.sensitivity_peak
    )


def describe_margins(analyses: Sequence[LoopAnalysis]) -> Message:
    """Return the worst margins over some corners; a loop that is unstable in one has none."""
    if not all(analysis.is_stable for analysis in analyses):
        return Message("loop-without-margins")
    return Message(
        "loop-margins",
        gain=min(analysis.gain_margin_db for analysis in analyses),
        phase=min(analysis.phase_margin_deg for analysis in analyses),
        peak=max(analysis.sensitivity_peak for analysis in analyses),
    )


def follow(machine: Machine, bench: CornerPlants) -> TunedLoop:
    """Return an open-loop axis, whose motor follows the setpoint, in every corner of the machine.

    Between two setpoints it moves by the cubic that has position and velocity of both, so that no
    impulse gets lost, wherever in a cycle the acceleration steps. It has no gains, responses and
    analyses: there is no loop whose margins could be told.
    """
    control = machine.control
    controller = Controller(
        position_loop=PositionLoop.DRIVE,
        position_gain=0.0,
        velocity_gain=0.0,
        integral_time=inf,
        velocity_feedforward=1.0,
        acceleration_feedforward=1.0,
        jerk_feedforward=0.0,
        feedforward_mass=machine.mechanics.moving_mass,
        force_lag=0.0,
        reference_delay=INTERPOLATED * control.position_cycle,
        velocity_cycle=control.velocity_cycle,
        cycles=round(control.position_cycle / control.velocity_cycle),
        state_gains=np.zeros(bench.model.order),
        follows=True,
    )
    return TunedLoop(
        controller=controller,
        corners=bench.corners,
        loops=tuple(build_loop(plant, controller, model=bench.model) for plant in bench.plants),
        responses=(),
        analyses=(),
        remarks=(Message("loop-motor-follows", delay=controller.reference_delay),),
    )
