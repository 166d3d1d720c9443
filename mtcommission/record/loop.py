"""Commissioning -> the feedback loop as the record holds it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning
from mtcommission.control_kinds.kind import ControlKind, PositionLoop
from mtcommission.loop.analysis.analysis import find_mixed_modes
from mtcommission.loop.analysis.cross_check import check_by_blocks
from mtcommission.loop.analysis.frequency import FrequencyResponse
from mtcommission.loop.analysis.quantisation import encoder_noise
from mtcommission.loop.model.controller import Controller, filter_delay
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.record.schema.loop import (
    CandidateEntry,
    ClosedLoop,
    CrossCheckEntry,
    DelayEntry,
    EncoderNoiseEntry,
    FeatureEntry,
    FeedforwardEntry,
    JerkFeedforwardEntry,
    LoopCornerEntry,
    LoopPart,
    Margins,
    ObserverEntry,
    VariantEntry,
)
from mtcommission.record.schema.values import ForceFilterEntry, Series
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.requirements.set_force import SET_FORCE
from mtcommission.study.loop_study import LoopStudy
from mtcommission.study.loop_trials import LoopTrial, LoopVariant

Array = NDArray[np.float64]

PUSH_STEP = 0.5e-3
"""Spacing of the samples of a disturbance response for its plot [s]."""


def loop_part(commissioning: Commissioning) -> LoopPart:
    """Return controller, margins, closed-loop matrices and frequency responses."""
    tuned, plant = commissioning.tuned, commissioning.plant
    controller, lifted = tuned.controller, tuned.loops[0].lifted
    machine, control = commissioning.machine, commissioning.machine.control
    return entry_of(
        LoopPart,
        *tuned.analyses[:1],
        controller,
        tuned,
        kind=control.kind.key,
        jerk=control.kind.jerk.value,
        position_loop=control.position_loop.value,
        features=feature_entries(control.kind),
        motion_force=machine.drive.motion_force,
        encoder_resolution=machine.drive.encoder_resolution,
        encoder_noise=_noise_entry(tuned, machine.drive.encoder_resolution),
        force_filters=[
            entry_of(ForceFilterEntry, item, kind=item.kind.value)
            for item in controller.force_filters
        ],
        state_feedback={
            state: float(gain)
            for state, gain in zip(plant.states, controller.state_gains, strict=True)
            if gain
        },
        feedforward=FeedforwardEntry(
            velocity=controller.velocity_feedforward,
            acceleration=controller.acceleration_feedforward,
            jerk=controller.jerk_feedforward,
            mass=controller.feedforward_mass,
        ),
        observer=entry_of(
            ObserverEntry,
            controller.observer,
            states=[plant.states[i] for i in controller.observer.states],
            sensors=controller.sensors,
        ),
        closed_loop=entry_of(ClosedLoop, lifted),
        candidates=[_candidate_entry(trial) for trial in commissioning.loop.trials],
        reasons=list(commissioning.loop.remarks),
        variants=[_variant_entry(plant, variant) for variant in commissioning.loop.variants],
        corners=_corner_entries(plant, tuned) if tuned.analyses else [],
        delays=_delay_entries(controller),
        disturbance=_disturbance_entry(commissioning.loop_study),
        jerk_feedforward=_jerk_feedforward_entries(commissioning.loop_study),
        **_judged(plant, tuned),
    )


NOT_WITHOUT_LOOP = (
    "Kv",
    "Kp",
    "Tn",
    "gain_margin_db",
    "gain_margin_up_db",
    "gain_margin_down_db",
    "phase_margin_deg",
    "sensitivity_peak",
    "bandwidth_hz",
    "dynamic_stiffness",
    "weakest_frequency_hz",
    "worst_corner",
    "cross_check",
)
"""What is null where the motor follows its setpoint."""

NO_SERIES = Series(t=[], signals={})


def _judged(plant: Plant, tuned: TunedLoop) -> dict[str, Any]:
    """Gains, poles and margins of a loop; null and empty where the motor follows its setpoint."""
    if tuned.controller.follows:
        return {
            **dict.fromkeys(NOT_WITHOUT_LOOP),
            "poles": [],
            "mode_damping": {},
            "worst_mode_damping": {},
            "bode": NO_SERIES,
            "remarks": list(tuned.remarks),
        }
    controller, nominal = tuned.controller, tuned.nominal
    mixed = find_mixed_modes(tuned.loops[0], nominal.mode_damping)
    return {
        "Kv": controller.position_gain,
        "Kp": controller.velocity_gain,
        "Tn": controller.integral_time,
        "poles": [[float(pole.real), float(pole.imag)] for pole in nominal.poles],
        "mode_damping": _by_mode(plant, nominal.mode_damping),
        "worst_corner": _worst_corner(tuned),
        "cross_check": _cross_check(tuned),
        "worst_mode_damping": _by_mode(plant, tuned.least_damping),
        "bode": _bode(tuned.responses[0]),
        "remarks": [*tuned.remarks, *(item.remark for item in mixed)],
    }


def _cross_check(tuned: TunedLoop) -> CrossCheckEntry:
    found = check_by_blocks(tuned.loops[0], tuned.responses[0].frequency_hz)
    return CrossCheckEntry(
        pole_difference=found.pole_difference,
        gain_margin_db=finite_or_none(found.gain_margin_db),
        phase_margin_deg=finite_or_none(found.phase_margin_deg),
    )


def _noise_entry(tuned: TunedLoop, resolution: float) -> EncoderNoiseEntry | None:
    if not resolution:
        return None
    found = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    return EncoderNoiseEntry(
        tool=max(noise.tool for noise in found), force=max(noise.force for noise in found)
    )


def feature_entries(kind: ControlKind) -> list[FeatureEntry]:
    """Return what a kind of control has, by its own names, with the sources."""
    return [
        FeatureEntry(
            name=name,
            # What is evidence only, such as a gain, every kind has.
            has=kind.has_jerk_limit if name == "jerk" else bool(getattr(kind, name, True)),
            parameters=feature.parameters,
            source=feature.source,
            verified=feature.is_verified,
        )
        for name, feature in kind.features.items()
    ]


def _worst_corner(tuned: TunedLoop) -> Margins:
    return Margins(
        gain_margin_db=finite_or_none(min(a.gain_margin_db for a in tuned.analyses)),
        phase_margin_deg=finite_or_none(min(a.phase_margin_deg for a in tuned.analyses)),
        sensitivity_peak=max(a.sensitivity_peak for a in tuned.analyses),
        bandwidth_hz=finite_or_none(tuned.least_bandwidth_hz),
        dynamic_stiffness=tuned.least_stiffness,
    )


def _candidate_entry(trial: LoopTrial) -> CandidateEntry:
    controller, candidate = trial.tuned.controller, trial.candidate
    return entry_of(
        CandidateEntry,
        _worst_corner(trial.tuned),
        candidate,
        Kv=controller.position_gain,
        Kp=controller.velocity_gain,
        Tn=controller.integral_time,
        state_feedback=bool(controller.state_gains.any()),
        meets_requirements=candidate.assessment.is_met,
        classic=trial.is_classic,
        used=trial.is_used,
    )


def _bode(response: FrequencyResponse) -> Series:
    return Series(
        t=response.frequency_hz.tolist(),
        signals={
            "open_loop_db": _decibel(response.open_loop),
            "open_loop_deg": _phase_deg(response.open_loop).tolist(),
            "closed_velocity_db": _decibel(response.closed_velocity_loop),
        },
    )


def _decibel(response: NDArray[np.complex128]) -> list[float]:
    return list((20 * np.log10(np.abs(response))).tolist())


def _phase_deg(response: NDArray[np.complex128]) -> Array:
    """Unwrapped phase that starts in (-360, 0], as drive engineers draw it [degrees]."""
    phase = np.degrees(np.unwrap(np.angle(response)))
    return np.asarray(phase - 360.0 * np.ceil(phase[0] / 360.0))


def _corner_entries(plant: Plant, tuned: TunedLoop) -> list[LoopCornerEntry]:
    return [
        entry_of(
            LoopCornerEntry,
            corner,
            analysis,
            mode_damping=_by_mode(plant, analysis.mode_damping),
        )
        for corner, analysis in zip(tuned.corners, tuned.analyses, strict=True)
    ]


def _delay_entries(controller: Controller) -> list[DelayEntry]:
    """Which path carries which dead time."""
    T_p, T_v = controller.position_cycle, controller.velocity_cycle
    filters = sum(filter_delay(item) for item in controller.force_filters)
    left = (1.0 - controller.jerk_feedforward) * controller.force_lag
    is_held = controller.position_loop is PositionLoop.CONTROL
    held = 0.5 * (T_p - T_v)
    position = {"dead": T_p, "hold": held}
    if controller.position_loop is PositionLoop.DRIVE:
        position = {}
    # Interpolation between two setpoints waits for the second one.
    handing_down = {"dead": T_p, "hold": held if is_held else T_p}

    def entry(
        path: Message, *, age: float = 0.0, dead: float = 0.0, hold: float = 0.0, lag: float = 0.0
    ) -> DelayEntry:
        return DelayEntry(
            path=path,
            setpoint_age=age,
            dead_time=dead,
            hold=hold,
            lag=lag,
            total=age + dead + hold + lag,
        )

    if controller.follows:
        return [entry(Message("path-position-setpoint"), dead=T_p, hold=T_p)]
    ahead = {"age": controller.reference_age, **handing_down}
    velocity = {"age": controller.velocity_age, **handing_down}
    wanted = [entry(Message("path-wanted-state"), **ahead)] if controller.state_gains.any() else []
    return [
        entry(Message("path-position-setpoint"), age=controller.reference_delay),
        entry(Message("path-position-controller"), **position),
        entry(Message("path-velocity-feed-forward"), **velocity),
        *wanted,
        entry(
            Message("path-force-feed-forward"),
            dead=T_p + T_v,
            hold=handing_down["hold"] + 0.5 * T_v,
            lag=left + filters,
        ),
        entry(
            Message("path-velocity-controller"),
            age=0.5 * T_v,
            dead=T_v,
            hold=0.5 * T_v,
            lag=controller.force_lag + filters,
        ),
    ]


def _disturbance_entry(study: LoopStudy) -> Series:
    if not study.disturbed:
        return NO_SERIES
    t = study.disturbed[0].step.t
    every = max(1, round(PUSH_STEP / (t[1] - t[0])))
    return Series(
        t=t[::every].tolist(),
        signals={
            item.name.kind: item.step.deflection[::every].tolist() for item in study.disturbed
        },
    )


def _jerk_feedforward_entries(study: LoopStudy) -> list[JerkFeedforwardEntry]:
    return [
        entry_of(JerkFeedforwardEntry, item, used=item.is_used) for item in study.jerk_feedforward
    ]


def _by_mode(plant: Plant, values: Sequence[float] | Array) -> dict[str, float]:
    return {mode.name: float(value) for mode, value in zip(plant.modes, values, strict=True)}


def _variant_entry(plant: Plant, variant: LoopVariant) -> VariantEntry:
    nominal, candidate = variant.tuned.nominal, variant.candidate
    force = candidate.assessment.check_of(SET_FORCE)
    return entry_of(
        VariantEntry,
        nominal,
        candidate,
        name=variant.name,
        used=variant.is_used,
        mode_damping=_by_mode(plant, nominal.mode_damping),
        max_force=force.value,
    )
