"""The feedback loop of a record."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements import SET_FORCE
from mtcommission.loop.analysis import draw_bode
from mtcommission.loop.disturbance import DisturbanceStep, EncoderNoise, worst_noise
from mtcommission.loop.model.assembly import INPUTS, CrossCheck
from mtcommission.loop.model.controller import PathDelay, list_delays
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.record.shape import entry_of, of
from mtcommission.record.values import (
    Matrix,
    Series,
    Words,
    by_mode,
)
from mtcommission.study.loops import LoopChoice, LoopTrial


@dataclass(frozen=True, slots=True, kw_only=True)
class ClosedLoop:
    """The linear nominal loop from [x_ref, v_ref, a_ref, j_ref] to the outputs."""

    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    dt: float
    states: list[str]
    inputs: list[str]
    outputs: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedforwardEntry:
    """Weights of the feed-forward [-], and the mass by which acceleration becomes force."""

    velocity: float = of("velocity_feedforward")
    acceleration: float = of("acceleration_feedforward")
    jerk: float = of("jerk_feedforward")
    mass: float = of("feedforward_mass")


@dataclass(frozen=True, slots=True, kw_only=True)
class ObserverEntry:
    """The predicting observer at the velocity cycle: x̂⁺ = A x̂ + B F_set + L (y - C x̂)."""

    states: list[str]
    sensors: list[str]
    A: Matrix
    B: list[float]
    C: Matrix
    L: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class Margins:
    """How good a loop is."""

    gain_margin_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float
    bandwidth_hz: float | None
    dynamic_stiffness: float  # least disturbance force per displacement of the tool, any frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class VariantEntry(Margins):
    """The loop without or with state feedback, each with its own best limits."""

    name: Message
    used: bool
    mode_damping: dict[str, float]
    weakest_frequency_hz: float
    settling_time: float | None = of("candidate.settling_time")
    residual_deviation: float | None = of("candidate.residual_deviation")
    max_force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopCornerEntry(Margins):
    """How good the loop is in one corner of payload and spread, the nominal machine first."""

    payload: float
    frequency_factor: float
    damping_factor: float
    state: str = ""  # as the profile names it
    mode_damping: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopPart:
    """The controller and how good its loop is; margins with the loop cut at F_set.

    From ``kind`` to ``observer`` it is all that a second program needs beside ``plant``, defined
    in docs/feedback-loop.md. Where the motor follows its setpoint there is no loop: gains, margins
    and stiffness are None, what is told of them is empty, and ``closed_loop`` still moves the axis.
    """

    kind: str
    jerk: str = of("kind.jerk")
    position_loop: str
    Kv: float | None = of("position_gain")
    Kp: float | None = of("velocity_gain")
    Tn: float | None = of("integral_time")
    reference_model_time: float
    reference_delay: float
    reference_age: float  # of the setpoint from which the wanted state is taken
    velocity_age: float  # of the one from which the wanted velocity is taken
    state_feedback: dict[str, float]
    feedforward: FeedforwardEntry
    position_cycle: float
    velocity_cycle: float
    force_lag: float
    motion_force: float  # bound of F_set
    force_filters: list[ForceFilter]
    encoder_resolution: float  # 0: not stated; then encoder_noise is None
    encoder_noise: EncoderNoise | None
    sensors: list[str]
    observer: ObserverEntry
    closed_loop: ClosedLoop
    poles: Matrix  # real and imaginary part each
    gain_margin_db: float | None  # the smaller of the two
    gain_margin_up_db: float | None  # by how much the gain may rise; None: by any amount
    gain_margin_down_db: float | None
    phase_margin_deg: float | None
    sensitivity_peak: float | None
    bandwidth_hz: float | None
    dynamic_stiffness: float | None
    weakest_frequency_hz: float | None
    mode_damping: dict[str, float]
    reasons: list[Words]  # why this loop is used
    variants: list[VariantEntry]
    worst_corner: Margins | None
    worst_mode_damping: dict[str, float]
    corners: list[LoopCornerEntry]
    cross_check: CrossCheck | None  # by python-control, from the same blocks
    delays: list[PathDelay]
    # The tool's displacement per newton after a step of force, by loop.
    disturbance: Series
    bode: Series
    remarks: list[Words]  # which rule chose what
    warnings: list[Words]  # what is poor about the loop; part of the record's warnings, too


PUSH_STEP = 0.5e-3
"""Spacing of the samples of a disturbance response for its plot [s]."""

NOT_WITHOUT_LOOP = (
    *("Kv", "Kp", "Tn", "gain_margin_db", "gain_margin_up_db", "gain_margin_down_db"),
    *("phase_margin_deg", "sensitivity_peak", "bandwidth_hz", "dynamic_stiffness"),
    *("weakest_frequency_hz", "worst_corner", "cross_check"),
)
"""What is None where the motor follows its setpoint."""

NO_SERIES = Series(t=[], signals={})


def loop_part(
    machine: Machine,
    plant: Plant,
    loop: LoopChoice,
    tuned: TunedLoop,
    disturbed: Mapping[str, DisturbanceStep],
) -> LoopPart:
    """Return controller, margins, closed-loop matrices and frequency responses."""
    controller, control, outputs = tuned.controller, machine.control, tuned.loops[0].outputs
    resolution = machine.drive.encoder_resolution
    gains = zip(plant.states, controller.state_gains.tolist(), strict=True)
    return entry_of(
        LoopPart,
        *tuned.analyses[:1],
        controller,
        tuned,
        control,
        machine.drive,
        position_loop=control.position_loop,
        encoder_noise=worst_noise(tuned.loops, resolution) if resolution else None,
        state_feedback={state: gain for state, gain in gains if gain},
        feedforward=controller,
        observer=entry_of(
            ObserverEntry,
            controller.observer,
            controller,
            states=[plant.states[i] for i in controller.observer.states],
        ),
        closed_loop=entry_of(
            ClosedLoop,
            tuned.loops[0].lifted,
            tuned.loops[0],
            inputs=INPUTS,
            outputs=[f"{name}[{i}]" for i in range(controller.cycles) for name in outputs],
        ),
        reasons=loop.remarks,
        variants=[_variant_entry(plant, variant) for variant in loop.variants],
        corners=[
            entry_of(LoopCornerEntry, corner, a, mode_damping=by_mode(plant, a.mode_damping))
            for corner, a in zip(tuned.corners, tuned.analyses, strict=bool(tuned.analyses))
        ],
        delays=list_delays(controller),
        disturbance=_disturbance(disturbed),
        **_judged(plant, tuned),
    )


def _judged(plant: Plant, tuned: TunedLoop) -> dict[str, Any]:
    """Poles and margins of a loop; None and empty where the motor follows its setpoint."""
    if tuned.controller.follows:
        empty = {"poles": [], "mode_damping": {}, "worst_mode_damping": {}, "bode": NO_SERIES}
        return dict.fromkeys(NOT_WITHOUT_LOOP) | empty
    from mtcommission.loop.model.diagram import check_by_blocks  # python-control: 0.3 s

    nominal, response = tuned.nominal, tuned.responses[0]
    drawn = draw_bode(response)
    return {
        "poles": np.stack([nominal.poles.real, nominal.poles.imag], axis=1),
        "mode_damping": by_mode(plant, nominal.mode_damping),
        "worst_corner": _worst_corner(tuned),
        "cross_check": check_by_blocks(tuned.loops[0], response.frequency_hz),
        "worst_mode_damping": by_mode(plant, tuned.least_damping),
        "bode": entry_of(Series, t=response.frequency_hz, signals=_lists(drawn, drawn.values())),
    }


def _worst_corner(tuned: TunedLoop) -> Margins:
    return entry_of(
        Margins,
        gain_margin_db=min(a.gain_margin_db for a in tuned.analyses),
        phase_margin_deg=min(a.phase_margin_deg for a in tuned.analyses),
        sensitivity_peak=max(a.sensitivity_peak for a in tuned.analyses),
        bandwidth_hz=tuned.least_bandwidth_hz,
        dynamic_stiffness=tuned.least_stiffness,
    )


def _variant_entry(plant: Plant, variant: LoopTrial) -> VariantEntry:
    nominal = variant.tuned.nominal
    return entry_of(
        VariantEntry,
        variant,
        nominal,
        mode_damping=by_mode(plant, nominal.mode_damping),
        max_force=variant.candidate.assessment.check_of(SET_FORCE).value,
    )


def _disturbance(disturbed: Mapping[str, DisturbanceStep]) -> Series:
    if not disturbed:
        return NO_SERIES
    t = next(iter(disturbed.values())).t
    every = max(1, round(PUSH_STEP / (t[1] - t[0])))
    steps = [step.deflection[::every] for step in disturbed.values()]
    return entry_of(Series, t=t[::every], signals=_lists(disturbed, steps))


def _lists(names: Iterable[str], columns: Iterable[NDArray[np.float64]]) -> dict[str, list[float]]:
    return {name: column.tolist() for name, column in zip(names, columns, strict=True)}
