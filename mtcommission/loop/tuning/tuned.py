"""A controller closed on the machine in every corner, and whether its margins suffice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mtcommission.loop.analysis.analysis import LoopAnalysis, analyse_loop
from mtcommission.loop.analysis.frequency import (
    BlockResponses,
    FrequencyResponse,
    complete_response,
    frequency_response,
    scan_blocks_on_grid,
)
from mtcommission.loop.model.assembly import SampledLoop, build_loop
from mtcommission.loop.model.controller import Controller
from mtcommission.machine.machine import Machine
from mtcommission.machine.variations import Corner, corners, vary
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, build_plant


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
    ``state_feedback.add_state_feedback``; each is tried."""
    least_integral_share: float = 0.5
    """Kp Kv / Tn over that of the classic rule, at least: what friction or a cutting force
    displaces, summed over time, is the reciprocal (design choice)."""
    longest_integral_time: float = 0.12
    """Tn beyond it is not proposed, but by the classic rule [s]: engineers type 5 to 120 ms, the
    longest on soft axes (Yaskawa)."""
    largest_fraction: float = 4.0
    """Where Kp begins, as a multiple of the symmetrical optimum (empirical: margins end the search
    before)."""
    reduction: float = 0.85  # from one try of Kp to the next, until the margins hold [-]
    force_noise: float = 0.05
    """Standard deviation of the unknown force of the drive that the observer assumes, relative to
    F_max [-] (empirical, like the two below: they set its bandwidth, not the accuracy of the
    loop)."""
    mode_noise: float = 0.01
    """Likewise of the force on each mode, relative to F_max [-]; without it the observer itself
    rings at the frequencies at which the encoder stands still."""
    position_noise: float = 1e-7  # standard deviation of the encoder error [m]


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
    remarks: tuple[Message, ...]  # what was chosen, by which rule, and what could not be done
    warnings: tuple[Message, ...] = ()  # what is poor about the loop; belongs beside the verdict

    @property
    def model(self) -> Any:
        """The nominal loop as a ``control.StateSpace``, see ``build_model``."""
        from mtcommission.loop.model import diagram  # python-control takes a second

        plant, lifted = self.loops[0].plant, self.loops[0].lifted
        if self.controller.follows:
            return diagram.as_followed_model(lifted.A, lifted.B, lifted.C, lifted.D, dt=lifted.dt)
        return diagram.build_model(plant, self.controller, model=plant)

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


def corner_plants(machine: Machine) -> CornerPlants:
    """Return the plant of a nominal machine in every corner; its requirements hold the ranges."""
    places = corners(machine)
    return CornerPlants(
        corners=places, plants=tuple(build_plant(vary(machine, corner)) for corner in places)
    )


def close_loop(
    bench: CornerPlants, controller: Controller, scanned: Sequence[BlockResponses] = ()
) -> TunedLoop:
    """Return the controller on the machine in every corner, analysed.

    ``scanned``: plant and observer over frequency, where these are known already.
    """
    scanned = scanned or [scan_blocks_on_grid(plant, controller) for plant in bench.plants]
    closed = [
        _close_on(plant, controller, complete_response(controller, known), model=bench.model)
        for plant, known in zip(bench.plants, scanned, strict=True)
    ]
    return _gather(bench, controller, closed)


def close_beside(tuned: TunedLoop, machine: Machine, place: Corner) -> TunedLoop:
    """Return a loop with one machine more behind its corners, under the same controller.

    ``machine`` is the nominal one, ``place`` where the machine that is added differs from it.
    """
    plant, model = build_plant(vary(machine, place)), tuned.loops[0].plant
    response = frequency_response(plant, tuned.controller)
    closed = _close_on(plant, tuned.controller, response, model=model)
    return replace(
        tuned,
        corners=(*tuned.corners, place),
        loops=(*tuned.loops, closed.loop),
        responses=(*tuned.responses, closed.response),
        analyses=(*tuned.analyses, closed.analysis),
    )


def close_within_margins(
    bench: CornerPlants,
    controller: Controller,
    scanned: Sequence[BlockResponses] = (),
    *,
    settings: TuningSettings,
) -> TunedLoop | None:
    """Return the loop as ``close_loop`` does, or None where a corner lacks the margins."""
    tuned = close_loop(bench, controller, scanned)
    within = all(has_margins(item, settings=settings) for item in tuned.analyses)
    return tuned if within else None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Closed:
    """The loop in one corner."""

    loop: SampledLoop
    response: FrequencyResponse
    analysis: LoopAnalysis


def _close_on(
    plant: Plant, controller: Controller, response: FrequencyResponse, *, model: Plant
) -> _Closed:
    loop = build_loop(plant, controller, model=model)
    return _Closed(loop=loop, response=response, analysis=analyse_loop(loop, response))


def _gather(bench: CornerPlants, controller: Controller, closed: Sequence[_Closed]) -> TunedLoop:
    return TunedLoop(
        controller=controller,
        corners=bench.corners,
        loops=tuple(item.loop for item in closed),
        responses=tuple(item.response for item in closed),
        analyses=tuple(item.analysis for item in closed),
        remarks=(),
    )


def has_margins(analysis: LoopAnalysis, *, settings: TuningSettings) -> bool:
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
