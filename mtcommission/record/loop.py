"""Commissioning -> the feedback loop as the record holds it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mtcommission.commission import Commissioning
from mtcommission.control_kinds.kind import ControlKind, PositionLoop
from mtcommission.loop.analysis import FrequencyResponse, find_mixed_modes
from mtcommission.loop.disturbance import EncoderNoise, encoder_noise
from mtcommission.loop.model.assembly import INPUTS
from mtcommission.loop.model.controller import Controller, filter_delay
from mtcommission.loop.model.diagram import check_by_blocks
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant
from mtcommission.record.data import by_mode
from mtcommission.record.schema.loop import (
    CandidateEntry,
    ClosedLoop,
    DelayEntry,
    FeatureEntry,
    FeedforwardEntry,
    LoopCornerEntry,
    LoopPart,
    Margins,
    ObserverEntry,
    VariantEntry,
)
from mtcommission.record.schema.values import Series
from mtcommission.record.shape import entry_of, finite_or_none
from mtcommission.requirements.set_force import SET_FORCE
from mtcommission.study.loops import LoopStudy, LoopTrial

PUSH_STEP = 0.5e-3
"""Spacing of the samples of a disturbance response for its plot [s]."""

NOT_WITHOUT_LOOP = (
    *("Kv", "Kp", "Tn", "gain_margin_db", "gain_margin_up_db", "gain_margin_down_db"),
    *("phase_margin_deg", "sensitivity_peak", "bandwidth_hz", "dynamic_stiffness"),
    *("weakest_frequency_hz", "worst_corner", "cross_check"),
)
"""What is None where the motor follows its setpoint."""

NO_SERIES = Series(t=[], signals={})


def loop_part(found: Commissioning) -> LoopPart:
    """Return controller, margins, closed-loop matrices and frequency responses."""
    tuned, plant, machine = found.tuned, found.plant, found.machine
    controller, control, outputs = tuned.controller, machine.control, tuned.loops[0].outputs
    gains = zip(plant.states, controller.state_gains.tolist(), strict=True)
    return entry_of(
        LoopPart,
        *tuned.analyses[:1],
        controller,
        tuned,
        control,
        machine.drive,
        jerk=control.kind.jerk,
        position_loop=control.position_loop,
        features=feature_entries(control.kind),
        encoder_noise=_noise(tuned, machine.drive.encoder_resolution),
        state_feedback={state: gain for state, gain in gains if gain},
        feedforward=FeedforwardEntry(
            velocity=controller.velocity_feedforward,
            acceleration=controller.acceleration_feedforward,
            jerk=controller.jerk_feedforward,
            mass=controller.feedforward_mass,
        ),
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
        candidates=[_candidate_entry(trial) for trial in found.loop.trials],
        reasons=found.loop.remarks,
        variants=[_variant_entry(plant, variant) for variant in found.loop.variants],
        corners=[
            entry_of(LoopCornerEntry, corner, a, mode_damping=by_mode(plant, a.mode_damping))
            for corner, a in zip(tuned.corners, tuned.analyses, strict=bool(tuned.analyses))
        ],
        delays=_delay_entries(controller),
        disturbance=_disturbance(found.loop_study),
        jerk_feedforward=found.loop_study.jerk_feedforward,
        **_judged(plant, tuned),
    )


def _judged(plant: Plant, tuned: TunedLoop) -> dict[str, Any]:
    """Gains, poles and margins of a loop; None and empty where the motor follows its setpoint."""
    if tuned.controller.follows:
        empty = {"poles": [], "mode_damping": {}, "worst_mode_damping": {}, "bode": NO_SERIES}
        return dict.fromkeys(NOT_WITHOUT_LOOP) | empty
    controller, nominal = tuned.controller, tuned.nominal
    mixed = find_mixed_modes(tuned.loops[0], nominal.mode_damping)
    return {
        "Kv": controller.position_gain,
        "Kp": controller.velocity_gain,
        "Tn": controller.integral_time,
        "poles": np.stack([nominal.poles.real, nominal.poles.imag], axis=1),
        "mode_damping": by_mode(plant, nominal.mode_damping),
        "worst_corner": _worst_corner(tuned),
        "cross_check": check_by_blocks(tuned.loops[0], tuned.responses[0].frequency_hz),
        "worst_mode_damping": by_mode(plant, tuned.least_damping),
        "bode": _bode(tuned.responses[0]),
        "remarks": [*tuned.remarks, *(item.remark for item in mixed)],
    }


def _noise(tuned: TunedLoop, resolution: float) -> EncoderNoise | None:
    """What the steps of the encoder do in the worst corner; None: they are not stated."""
    if not resolution:
        return None
    found = [encoder_noise(loop, resolution=resolution) for loop in tuned.loops]
    tool, force = max(noise.tool for noise in found), max(noise.force for noise in found)
    return EncoderNoise(tool=tool, force=force)


def feature_entries(kind: ControlKind) -> list[FeatureEntry]:
    """Return what a kind of control has, by its own names, with the sources."""
    return [
        entry_of(
            FeatureEntry,
            feature,
            name=name,
            # What is evidence only, such as a gain, every kind has.
            has=kind.has_jerk_limit if name == "jerk" else bool(getattr(kind, name, True)),
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
        trial,
        _worst_corner(trial.tuned),
        candidate,
        Kv=controller.position_gain,
        Kp=controller.velocity_gain,
        Tn=controller.integral_time,
        state_feedback=bool(controller.state_gains.any()),
        meets_requirements=candidate.assessment.is_met,
    )


def _variant_entry(plant: Plant, variant: LoopTrial) -> VariantEntry:
    nominal, candidate = variant.tuned.nominal, variant.candidate
    return entry_of(
        VariantEntry,
        variant,
        nominal,
        candidate,
        mode_damping=by_mode(plant, nominal.mode_damping),
        max_force=candidate.assessment.check_of(SET_FORCE).value,
    )


def _bode(response: FrequencyResponse) -> Series:
    phase = np.degrees(np.unwrap(np.angle(response.open_loop)))
    signals = {
        "open_loop_db": _decibel(response.open_loop),
        # In (-360, 0] at its start, as drive engineers draw it.
        "open_loop_deg": (phase - 360.0 * np.ceil(phase[0] / 360.0)).tolist(),
        "closed_velocity_db": _decibel(response.closed_velocity_loop),
    }
    return Series(t=response.frequency_hz.tolist(), signals=signals)


def _decibel(response: NDArray[np.complex128]) -> list[float]:
    return list((20 * np.log10(np.abs(response))).tolist())


def _disturbance(study: LoopStudy) -> Series:
    if not study.disturbed:
        return NO_SERIES
    t = next(iter(study.disturbed.values())).t
    every = max(1, round(PUSH_STEP / (t[1] - t[0])))
    steps = {name: step.deflection for name, step in study.disturbed.items()}
    return Series(
        t=t[::every].tolist(),
        signals={name: deflection[::every].tolist() for name, deflection in steps.items()},
    )


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
