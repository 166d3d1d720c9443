"""The feedback loop of a record, and all that a page needs to run it again with other values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import MOVING_AVERAGE
from mtcommission.limits.requirements import SET_FORCE, Yields, bounded_states, requirements_of
from mtcommission.loop.analysis import draw_bode
from mtcommission.loop.disturbance import DisturbanceStep, EncoderNoise, encoder_noise, worst_noise
from mtcommission.loop.model.assembly import (
    INPUTS,
    CrossCheck,
    SampledLoop,
    as_state_space,
    build_loop,
)
from mtcommission.loop.model.controller import Controller, PathDelay, list_delays
from mtcommission.loop.respond import OUTPUTS
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.control import ForceFilter, shortest_ramp
from mtcommission.machine.machine import Corner, Machine, vary
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.moves import InCorner, Series, by_mode
from mtcommission.record.shape import Matrix, Words, entry_of, finite_or_none, of
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.loops import LoopChoice
from mtcommission.study.rules import TodaysValues

PUSH_STEP = 0.5e-3
"""Spacing of the samples of a disturbance response for its plot [s]."""

NOT_WITHOUT_LOOP = (
    *("Kv", "Kp", "Tn", "gain_margin_db", "gain_margin_up_db", "gain_margin_down_db"),
    *("phase_margin_deg", "sensitivity_peak", "bandwidth_hz", "dynamic_stiffness"),
    *("gain_margin_hz", "phase_margin_hz"),
    *("weakest_frequency_hz", "worst_corner"),
)
"""What is None where the motor follows its setpoint."""

NO_SERIES = Series(t=[], signals={})


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
    gain_margin_hz: float | None  # where the smaller one is
    phase_margin_deg: float | None
    phase_margin_hz: float | None
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
    cross_check: CrossCheck | None  # by python-control, from the same blocks; None: not made
    delays: list[PathDelay]
    # The tool's displacement per newton after a step of force, by loop.
    disturbance: Series
    bode: Series
    remarks: list[Words]  # which rule chose what
    warnings: list[Words]  # what is poor about the loop; part of the record's warnings, too

    @property
    def shortest_ramp(self) -> float:
        """Below which length a ramp of acceleration is a step to the drive [s]."""
        return shortest_ramp(self.jerk, self.position_cycle, self.velocity_cycle)


def loop_part(
    machine: Machine,
    plant: Plant,
    loop: LoopChoice,
    disturbed: Mapping[str, DisturbanceStep],
    *,
    cross_check: CrossCheck | None = None,
) -> LoopPart:
    """Return controller, margins, closed-loop matrices and frequency responses."""
    tuned = loop.tuned
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
            as_state_space(tuned.loops[0]),
            inputs=INPUTS,
            outputs=[f"{name}[{i}]" for i in range(controller.cycles) for name in outputs],
        ),
        reasons=loop.remarks,
        variants=[
            entry_of(
                VariantEntry,
                one,
                one.tuned.nominal,
                mode_damping=by_mode(plant, one.tuned.nominal.mode_damping),
                max_force=one.candidate.assessment.check_of(SET_FORCE).value,
            )
            for one in loop.variants
        ],
        corners=[
            entry_of(LoopCornerEntry, corner, a, mode_damping=by_mode(plant, a.mode_damping))
            for corner, a in zip(tuned.corners, tuned.analyses, strict=bool(tuned.analyses))
        ],
        delays=list_delays(controller),
        disturbance=_disturbance(disturbed),
        cross_check=cross_check,
        **_judged(plant, tuned),
    )


def _judged(plant: Plant, tuned: TunedLoop) -> dict[str, Any]:
    """Poles and margins of a loop; None and empty where the motor follows its setpoint."""
    if tuned.controller.follows:
        empty = {"poles": [], "mode_damping": {}, "worst_mode_damping": {}, "bode": NO_SERIES}
        return dict.fromkeys(NOT_WITHOUT_LOOP) | empty
    nominal, response = tuned.nominal, tuned.responses[0]
    drawn = draw_bode(response)
    return {
        "poles": np.stack([nominal.poles.real, nominal.poles.imag], axis=1),
        "mode_damping": by_mode(plant, nominal.mode_damping),
        "worst_corner": Margins(
            gain_margin_db=finite_or_none(min(a.gain_margin_db for a in tuned.analyses)),
            phase_margin_deg=finite_or_none(min(a.phase_margin_deg for a in tuned.analyses)),
            sensitivity_peak=max(a.sensitivity_peak for a in tuned.analyses),
            bandwidth_hz=finite_or_none(tuned.least_bandwidth_hz),
            dynamic_stiffness=tuned.least_stiffness,
        ),
        "worst_mode_damping": by_mode(plant, tuned.least_damping),
        "bode": entry_of(Series, t=response.frequency_hz, signals=drawn),
    }


def _disturbance(disturbed: Mapping[str, DisturbanceStep]) -> Series:
    if not disturbed:
        return NO_SERIES
    t = next(iter(disturbed.values())).t
    every = max(1, round(PUSH_STEP / (t[1] - t[0])))
    steps = {name: step.deflection[::every] for name, step in disturbed.items()}
    return entry_of(Series, t=t[::every], signals=steps)


@dataclass(frozen=True, slots=True, kw_only=True)
class SampledEntry:
    """The nominal loop at the velocity cycle, for whoever closes it on other machines.

    X over ``states``: the plant's first, F_set at ``pending``, what the position cycle hands down
    from ``held`` on. X⁺ = ``cycle`` X in a velocity cycle; after ``cycles`` of these the states
    from ``held`` on become ``by_state`` X, X from before them, plus ``by_setpoint`` times (x_ref,
    v_ref, a_ref, j_ref) at that time, then one position cycle earlier, and so on. Where the motor
    follows, what is handed down are its position, velocity, acceleration and jerk.
    """

    follows: bool
    velocity_cycle: float
    cycles: int
    reference_delay: float
    states: list[str]
    pending: int
    held: int
    cycle: Matrix
    by_state: Matrix
    by_setpoint: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedModeEntry:
    """Where a mode stands in the plant; payload p divides its terms by 1 + p ``payload_share``."""

    deflection: int
    rate: int
    payload_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SignalEntry:
    """A row over the plant's states whose largest magnitude counts, from t_e + τ on or always."""

    name: str
    unit: str
    row: list[float]
    less: int | None  # less that derivative of the delayed setpoint, 0: position; None: as it is
    is_after: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedPlantEntry:
    """The nominal plant, and what payload, frequency and damping change in it.

    The force moves the state ``velocity`` by 1/(``moving_mass`` + payload); where the motor
    follows, the last state is its acceleration and B the jerk's. ``signals``: the motor's force,
    then each that a check of the same name bounds.
    """

    A: Matrix
    B: list[float]
    tcp: list[float]
    signals: list[SignalEntry]
    position: int
    velocity: int
    moving_mass: float
    modes: list[VariedModeEntry]


@dataclass(frozen=True, slots=True, kw_only=True)
class NoisyCornerEntry(InCorner):
    """A corner, and what the steps of the encoder add there either way."""

    tool_noise: float = of("tool")
    force_noise: float = of("force")


@dataclass(frozen=True, slots=True, kw_only=True)
class StateEntry:
    """The plant in a state in which it was measured, and the loop around it."""

    name: str
    plant: VariedPlantEntry
    loop: SampledEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitEntry:
    """A requirement; ``of_listed``: smaller moves than the listed ones need not keep it."""

    name: str
    unit: str
    limit: float
    of_listed: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedsEntry:
    """What moves are judged by; None: not stated. ``every_size``: smaller moves count, too."""

    checks: list[LimitEntry]
    tcp_deviation: float
    contour_feed: float | None
    motion_force: float
    static_load: float
    every_size: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLimitsEntry:
    """Limits to begin with; ``loop`` where it is another one, ``states``: in each state."""

    name: str
    acceleration: float
    jerk: float
    setpoint_filter: SetpointFilter | None
    loop: SampledEntry | None
    states: list[StateEntry] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class WhatIfPart:
    """All that it takes to run other limits, moves and machines through the loop again."""

    jerk: str
    loop: SampledEntry
    plant: VariedPlantEntry
    corners: list[NoisyCornerEntry]
    moves: list[Move]
    requirements: NeedsEntry
    limits: list[KnownLimitsEntry]
    force_filters: list[ForceFilter]
    states: list[StateEntry] = field(default_factory=list)
    averages: list[float] | None  # least and longest moving average; None: the control has none


def what_if_part(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    limits: MotionLimits,
    today: TodaysValues | None,
) -> WhatIfPart:
    """Return what a page needs to answer for other limits, moves and machines.

    The values now in the control first, where they are stated and their loop is stable.
    """
    controller, control = tuned.controller, machine.control
    given = limits.setpoint_filter or control.setpoint_filter
    recommended = entry_of(
        KnownLimitsEntry, limits, name="recommended", setpoint_filter=given, loop=None, states=[]
    )
    known = [recommended]
    if today is not None and today.judged is not None:
        in_own = bool(today.stated)
        own = build_loop(plant, today.controller, model=plant) if in_own else None
        now = entry_of(
            KnownLimitsEntry,
            today.limits,
            name="today",
            setpoint_filter=today.today.setpoint_filter,
            loop=_sampled_entry(own) if own else None,
            states=list(_states(machine, plant, today.controller)) if in_own else [],
        )
        known.insert(0, now)
    average = control.kind.find_filter(MOVING_AVERAGE)
    return WhatIfPart(
        jerk=control.kind.jerk.value,
        loop=_sampled_entry(tuned.loops[0]),
        plant=_plant_entry(machine, plant),
        states=list(_states(machine, plant, controller)),
        corners=[
            entry_of(
                NoisyCornerEntry,
                corner,
                encoder_noise(loop, resolution=machine.drive.encoder_resolution),
            )
            for corner, loop in zip(tuned.corners, tuned.loops, strict=True)
        ],
        moves=list(machine.moves),
        requirements=entry_of(
            NeedsEntry,
            machine.requirements,
            machine.drive,
            checks=[
                LimitEntry(
                    name=item.key,
                    unit=item.unit(machine, plant),
                    limit=item.bound(machine),
                    of_listed=item.yields is Yields.MINIMISED,
                )
                for item in requirements_of(machine)
            ],
        ),
        limits=known,
        force_filters=list(controller.force_filters),
        averages=list(average.times(controller.position_cycle)) if average else None,
    )


def _sampled_entry(loop: SampledLoop) -> SampledEntry:
    return entry_of(SampledEntry, loop.controller, loop, pending=loop.integrator + 1)


def _plant_entry(machine: Machine, plant: Plant) -> VariedPlantEntry:
    inertia, radius = machine.mechanics.inertia_ratio, machine.requirements.payload_radius
    one_more = np.array([1.0])  # kg: the share is linear in the payload
    return entry_of(
        VariedPlantEntry,
        plant,
        tcp=plant.row("tcp"),
        signals=list(_signals(machine, plant)),
        modes=[
            VariedModeEntry(
                deflection=mode.deflection,
                rate=mode.rate,
                payload_share=1.0 / inertia(mode.name, one_more, radius)[0] - 1.0,
            )
            for mode in plant.modes
        ],
    )


def _states(machine: Machine, model: Plant, controller: Controller) -> Iterator[StateEntry]:
    for state in machine.states:
        own = vary(machine, Corner(state=state.name))
        plant = build_plant(own)
        loop = _sampled_entry(build_loop(plant, controller, model=model))
        yield StateEntry(name=state.name, plant=_plant_entry(own, plant), loop=loop)


def _signals(machine: Machine, plant: Plant) -> Iterator[SignalEntry]:
    force = plant.states[plant.force]
    row = plant.row(force).tolist()
    yield SignalEntry(name=force, unit=plant.unit(force), row=row, less=None, is_after=False)
    for requirement, swing in bounded_states(machine, plant):
        yield SignalEntry(
            name=requirement.key,
            unit=requirement.unit(machine, plant),
            row=swing.signal.row[OUTPUTS:].tolist(),
            less=swing.signal.less,
            is_after=swing.is_after,
        )
