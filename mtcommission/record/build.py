"""Commissioning -> Record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version

import numpy as np
from numpy.typing import NDArray

from mtcommission import __version__
from mtcommission.assess import Assessment, assess
from mtcommission.commission import (
    Commissioning,
    MoveComparison,
)
from mtcommission.loop.response import LoopResponse
from mtcommission.loop.tuning import TunedLoop
from mtcommission.loop_choice import LoopVariant
from mtcommission.machine import Corner, Machine, Manipulator
from mtcommission.optima import Optima
from mtcommission.plant import Plant, kalman_rank
from mtcommission.record.data import describe_move, list_assumptions, list_data
from mtcommission.record.optima import finite_or_none, optimum_entry, series_entry
from mtcommission.record.schema import (
    SCHEMA,
    Alternative,
    AssessmentPart,
    Check,
    ClosedLoop,
    ComparedEntry,
    ComparisonEntry,
    ContinuousEntry,
    FedForwardEntry,
    Landscape,
    LimitsEntry,
    LimitsPart,
    LoopPart,
    ModeEntry,
    ModeLimitsEntry,
    MoveEntry,
    ObserverEntry,
    OptimaEntry,
    PlantEntry,
    Profile,
    Record,
    ResponseEntry,
    RuleResult,
    RuleStepEntry,
    RuleText,
    Segment,
    Series,
    SetpointEntry,
    SimulationPart,
    Tool,
    VariantEntry,
)
from mtcommission.setpoint import sample_setpoint
from mtcommission.trials import MoveResult

Array = NDArray[np.float64]

PLOT_STEP = 0.25e-3
"""Spacing of the samples of a response for its plot [s]; all judgements use every cycle."""

PLOT_TAIL = 0.15
"""What a plot shows after the end of the setpoint [s]."""


def build_record(
    commissioning: Commissioning, *, profile: Profile, created: str, warnings: Sequence[str]
) -> Record:
    """Return the record of a commissioning.

    Parameters
    ----------
    commissioning
        What was computed.
    profile
        Name, hash and text of the profile that it came from.
    created
        Date and time, ISO 8601.
    warnings
        Physical warnings about the profile.

    Returns
    -------
    Record
    """
    machine, plant = commissioning.machine, commissioning.plant
    return Record(
        schema=SCHEMA,
        tool=Tool(name="mtcommission", version=__version__, libraries=_library_versions()),
        created=created,
        profile=profile,
        machine={
            "name": machine.name,
            "axis": machine.axis,
            "motion": machine.motion.value,
            "source": machine.source,
            "kind": "manipulator" if isinstance(machine.mechanics, Manipulator) else "modal",
        },
        data=list_data(machine, plant, profile["text"]),
        settings=_settings_entry(commissioning),
        assumptions=list_assumptions(machine),
        warnings=list(warnings),
        plant=_plant_entry(plant),
        optima=[_optima_entry(plant, item) for item in commissioning.optima],
        limits=limits_part(commissioning),
        loop=_loop_part(commissioning),
        moves=[move_entry(plant, commissioning.tuned, result) for result in commissioning.moves],
        comparisons=[_comparison_entry(plant, item) for item in commissioning.comparisons],
        assessment=assessment_part(commissioning.assessment),
    )


def limits_part(commissioning: Commissioning) -> LimitsPart:
    """Return all about the limits, as ``limits --json`` prints it."""
    choice, best = commissioning.choice, commissioning.recommended
    return LimitsPart(
        recommended=LimitsEntry(
            acceleration=best.limits.acceleration,
            jerk=best.limits.jerk,
            jerk_time=best.limits.jerk_time,
            bound_by=choice.bound_by,
            settling_time=finite_or_none(best.settling_time),
            residual_deviation=finite_or_none(best.residual_deviation),
            peak_deviation=best.peak_deviation,
        ),
        modes=[
            ModeLimitsEntry(
                name=mode.name,
                band=mode.band,
                acceleration=mode.trial.limits.acceleration,
                jerk=mode.trial.limits.jerk,
                jerk_time=mode.trial.limits.jerk_time,
                bound_by=mode.choice.bound_by,
                settling_time=finite_or_none(mode.trial.settling_time),
                residual_deviation=finite_or_none(mode.trial.residual_deviation),
                meets_requirements=mode.trial.assessment.is_met,
            )
            for mode in commissioning.modes
        ],
        alternatives=[
            Alternative(
                name=trial.name,
                acceleration=trial.limits.acceleration,
                jerk=trial.limits.jerk,
                settling_time=finite_or_none(trial.settling_time),
                residual_deviation=finite_or_none(trial.residual_deviation),
                peak_deviation=trial.peak_deviation,
                meets_requirements=trial.assessment.is_met,
            )
            for trial in commissioning.alternatives
        ],
        rules=[
            RuleResult(
                name=trial.name,
                source=trial.source,
                acceleration=trial.limits.acceleration,
                jerk=trial.limits.jerk,
                settling_time=finite_or_none(trial.settling_time),
                residual_deviation=finite_or_none(trial.residual_deviation),
                peak_deviation=trial.peak_deviation,
                meets_requirements=trial.assessment.is_met,
            )
            for trial in commissioning.rules
        ],
        rule=_rule_text(commissioning),
        landscape=Landscape(
            acceleration=choice.acceleration.tolist(),
            jerk_time=choice.jerk_time.tolist(),
            settling_time=_plotted(choice.settling_time),
            residual_deviation=_plotted(choice.residual_deviation),
            usage=_plotted(choice.usage),
        ),
        search={"evaluations": choice.evaluations},
    )


def move_entry(plant: Plant, tuned: TunedLoop, result: MoveResult) -> MoveEntry:
    """Return one move with its limits, as ``simulate --json`` prints it."""
    setpoint, nominal = result.setpoint, result.responses[0]
    filtered = setpoint.duration - float(np.sum(setpoint.segment_durations))
    every = max(1, round(PLOT_STEP / tuned.controller.velocity_cycle))
    shown = nominal.t <= nominal.t_end + PLOT_TAIL
    shown[:] &= np.arange(len(shown)) % every == 0
    t = nominal.t[shown]
    delayed = sample_setpoint(setpoint, t - tuned.controller.reference_delay)
    now = sample_setpoint(setpoint, t)
    extra = {
        "x_ref_delayed": delayed[:, 0],
        "v_ref": now[:, 1],
        "a_ref": now[:, 2],
        "j_ref": now[:, 3],
        "deviation": nominal.deviation[shown],
        "F_set": nominal.force[shown],
    }
    return MoveEntry(
        move=describe_move(setpoint.move),
        setpoint=SetpointEntry(
            duration=setpoint.duration,
            moving_average=max(filtered, 0.0) if filtered > 1e-12 else 0.0,
            segments=[
                Segment(duration=duration, jerk=jerk)
                for duration, jerk in zip(
                    setpoint.segment_durations.tolist(),
                    setpoint.segment_jerks.tolist(),
                    strict=True,
                )
            ],
        ),
        response=_response_entry(plant, tuned.corners[0], nominal),
        corners=[
            _response_entry(plant, corner, response)
            for corner, response in zip(tuned.corners, result.responses, strict=True)
        ],
        series=series_entry(plant, t, nominal.states[shown], extra),
    )


def simulation_part(
    machine: Machine, plant: Plant, tuned: TunedLoop, results: Sequence[MoveResult]
) -> SimulationPart:
    """Return what ``simulate --json`` prints, judged like a recommendation."""
    entries = [move_entry(plant, tuned, result) for result in results]
    verdict = assess(machine, plant, tuned.corners, [result.responses for result in results])
    return SimulationPart(
        setpoint=entries[0]["setpoint"],
        response=entries[0]["response"],
        corners=entries[0]["corners"],
        moves=entries,
        assessment=assessment_part(verdict),
    )


def assessment_part(assessment: Assessment) -> AssessmentPart:
    """Return the verdict as the record holds it."""
    return AssessmentPart(
        met=assessment.is_met,
        checks=[
            Check(
                name=check.name,
                value=finite_or_none(check.value),
                limit=check.limit,
                unit=check.unit,
                met=check.is_met,
                where=check.where,
            )
            for check in assessment.checks
        ],
        obstacle=assessment.obstacle,
    )


def _settings_entry(commissioning: Commissioning) -> dict[str, float | str]:
    """Every numerical setting, with the name of its group."""
    found: dict[str, float | str] = {}
    for group, values in asdict(commissioning.settings).items():
        for name, value in values.items():
            shown = value if isinstance(value, int | float) else ", ".join(map(str, value))
            found[f"{group}.{name}"] = shown
    return found


def _plant_entry(plant: Plant) -> PlantEntry:
    return PlantEntry(
        states=list(plant.states),
        units=dict(zip(plant.signals, plant.signal_units, strict=True)),
        A=plant.A.tolist(),
        B=plant.B.tolist(),
        outputs=dict(zip(plant.outputs, plant.C.tolist(), strict=True)),
        modes=[
            ModeEntry(
                name=mode.name,
                frequency_hz=mode.frequency_hz,
                damping_ratio=mode.damping_ratio,
                tcp_gain=mode.tcp_gain,
                measured_gain=mode.measured_gain,
            )
            for mode in plant.modes
        ],
        controllability_rank=kalman_rank(plant),
        moving_mass=plant.moving_mass,
    )


def _optima_entry(plant: Plant, item: Optima) -> OptimaEntry:
    return OptimaEntry(
        move=describe_move(item.move),
        time=optimum_entry(plant, item.time),
        constrained=optimum_entry(plant, item.constrained) if item.constrained else None,
        damping=optimum_entry(plant, item.damping) if item.damping else None,
        remarks=list(item.remarks),
    )


def _rule_text(commissioning: Commissioning) -> RuleText:
    rule = commissioning.rule
    return RuleText(
        text=(
            "A rule to apply by hand: each jerk step leaves a vibration in every mode and a tail "
            "of the servo loop, both in proportion to the jerk; ramps of whole periods cancel "
            "the vibration. Of the ramps tried, the one with the shortest motion is taken."
        ),
        formula=rule.formula,
        valid_for=rule.validity,
        acceleration=rule.limits.acceleration,
        jerk=rule.limits.jerk,
        jerk_time=rule.limits.jerk_time,
        chosen=rule.chosen,
        bound_by=rule.bound_by,
        predicted_settling_time=finite_or_none(rule.predicted_settling_time),
        predicted_residual=finite_or_none(rule.predicted_residual),
        steps=[
            RuleStepEntry(
                name=step.name,
                formula=step.formula,
                value=finite_or_none(step.value),
                unit=step.unit,
            )
            for step in rule.steps
        ],
        warnings=list(rule.warnings),
    )


def _loop_part(commissioning: Commissioning) -> LoopPart:
    tuned, plant = commissioning.tuned, commissioning.plant
    controller, nominal, lifted = tuned.controller, tuned.nominal, tuned.lifted[0]
    bode = tuned.responses[0]
    gains = controller.state_gains
    return LoopPart(
        Kv=controller.position_gain,
        Kp=controller.velocity_gain,
        Tn=controller.integral_time,
        reference_delay=controller.reference_delay,
        state_feedback={
            state: float(gain) for state, gain in zip(plant.states, gains, strict=True) if gain
        },
        feedforward={
            "velocity": controller.velocity_feedforward,
            "acceleration": controller.acceleration_feedforward,
            "jerk": controller.jerk_feedforward,
            "mass": controller.feedforward_mass,
        },
        position_cycle=controller.position_cycle,
        velocity_cycle=controller.velocity_cycle,
        sensors=list(controller.sensors),
        observer=ObserverEntry(
            states=[plant.states[i] for i in controller.observer.states],
            sensors=list(controller.sensors),
            A=controller.observer.A.tolist(),
            B=controller.observer.B.tolist(),
            C=controller.observer.C.tolist(),
            L=controller.observer.L.tolist(),
        ),
        closed_loop=ClosedLoop(
            A=lifted.A.tolist(),
            B=lifted.B.tolist(),
            C=lifted.C.tolist(),
            D=lifted.D.tolist(),
            dt=lifted.dt,
            states=list(lifted.states),
            inputs=list(lifted.inputs),
            outputs=list(lifted.outputs),
        ),
        poles=[[float(pole.real), float(pole.imag)] for pole in nominal.poles],
        gain_margin_db=finite_or_none(nominal.gain_margin_db),
        phase_margin_deg=finite_or_none(nominal.phase_margin_deg),
        sensitivity_peak=nominal.sensitivity_peak,
        bandwidth_hz=finite_or_none(nominal.bandwidth_hz),
        dynamic_stiffness=nominal.dynamic_stiffness,
        weakest_frequency_hz=nominal.weakest_frequency_hz,
        mode_damping=_by_mode(plant, nominal.mode_damping),
        variants=[_variant_entry(plant, variant) for variant in commissioning.loop.variants],
        worst_corner={
            "gain_margin_db": finite_or_none(min(a.gain_margin_db for a in tuned.analyses)),
            "phase_margin_deg": finite_or_none(min(a.phase_margin_deg for a in tuned.analyses)),
            "sensitivity_peak": max(a.sensitivity_peak for a in tuned.analyses),
            "bandwidth_hz": finite_or_none(min(a.bandwidth_hz for a in tuned.analyses)),
        },
        bode=Series(
            t=bode.frequency_hz.tolist(),
            signals={
                "open_loop_db": (20 * np.log10(np.abs(bode.open_loop))).tolist(),
                "open_loop_deg": _phase_deg(bode.open_loop).tolist(),
                "closed_velocity_db": (20 * np.log10(np.abs(bode.closed_velocity_loop))).tolist(),
            },
        ),
        remarks=list(tuned.remarks),
    )


def _phase_deg(response: NDArray[np.complex128]) -> Array:
    """Unwrapped phase that starts in (-360, 0], as drive engineers draw it [degrees]."""
    phase = np.degrees(np.unwrap(np.angle(response)))
    return np.asarray(phase - 360.0 * np.ceil(phase[0] / 360.0))


def _plotted(grid: Array) -> list[list[float | None]]:
    """A grid for plots only: five digits."""
    return [[finite_or_none(float(f"{value:.5g}")) for value in row] for row in grid]


def _by_mode(plant: Plant, values: Array) -> dict[str, float]:
    return {mode.name: float(value) for mode, value in zip(plant.modes, values, strict=True)}


def _variant_entry(plant: Plant, variant: LoopVariant) -> VariantEntry:
    nominal, trial = variant.tuned.nominal, variant.trial
    force = next(check for check in trial.assessment.checks if check.name == "set force")
    return VariantEntry(
        name=variant.name,
        used=variant.is_used,
        mode_damping=_by_mode(plant, nominal.mode_damping),
        gain_margin_db=finite_or_none(nominal.gain_margin_db),
        phase_margin_deg=finite_or_none(nominal.phase_margin_deg),
        sensitivity_peak=nominal.sensitivity_peak,
        bandwidth_hz=finite_or_none(nominal.bandwidth_hz),
        dynamic_stiffness=nominal.dynamic_stiffness,
        weakest_frequency_hz=nominal.weakest_frequency_hz,
        settling_time=finite_or_none(trial.settling_time),
        residual_deviation=finite_or_none(trial.residual_deviation),
        max_force=force.value,
    )


def _comparison_entry(plant: Plant, comparison: MoveComparison) -> ComparisonEntry:
    return ComparisonEntry(
        controls=[
            ComparedEntry(
                name=control.name,
                transfer_time=finite_or_none(control.transfer_time),
                overshoot=control.overshoot,
                peaks=dict(zip(plant.signals, control.peaks.tolist(), strict=True)),
                max_force=control.max_force,
                heat=control.heat,
                work=control.work,
            )
            for control in comparison.controls
        ],
        fed_forward=[
            FedForwardEntry(
                control=name,
                payload=found.corner.payload,
                frequency_factor=found.corner.frequency_factor,
                damping_factor=found.corner.damping_factor,
                settling_time=finite_or_none(found.settling_time),
                residual_deviation=found.residual_deviation,
                peak_deviation=found.peak_deviation,
                saturated_share=found.saturated_share,
            )
            for name, rows in comparison.fed_forward
            for found in rows
        ],
        continuous=ContinuousEntry(
            settling_time=finite_or_none(comparison.continuous.settling_time),
            residual_deviation=comparison.continuous.residual_deviation,
        ),
    )


def _response_entry(plant: Plant, corner: Corner, response: LoopResponse) -> ResponseEntry:
    return ResponseEntry(
        payload=corner.payload,
        frequency_factor=corner.frequency_factor,
        damping_factor=corner.damping_factor,
        settling_time=finite_or_none(response.settling_time),
        residual_deviation=finite_or_none(response.residual_deviation),
        peak_deviation=response.peak_deviation,
        mode_amplitudes={
            mode.name: float(amplitude)
            for mode, amplitude in zip(plant.modes, response.mode_amplitudes, strict=True)
        },
        peaks=dict(zip(plant.signals, response.peaks.tolist(), strict=True)),
        max_force=response.max_force,
        rms_force=response.rms_force,
        saturated=response.saturated,
    )


def _library_versions() -> dict[str, str]:
    names = ("casadi", "ruckig", "control", "numpy", "scipy")
    return {name: version(name) for name in names}
