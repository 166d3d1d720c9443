"""Profile tables -> Machine: where "left out" gets its meaning."""

from __future__ import annotations

from math import inf

from mtcommission.control_kinds.kinds import KINDS
from mtcommission.machine.machine import (
    Control,
    DampingOptimal,
    Drive,
    Machine,
    Modes,
    Motion,
    Move,
    Peak,
    Positioning,
    Requirements,
    Reserve,
    StateFeedback,
    StateGain,
    TcpSensor,
    Today,
    VelocityStep,
    Weight,
)
from mtcommission.profile.model import (
    ControlTable,
    DampingOptimalTable,
    MoveTable,
    ProfileTable,
    RequirementsTable,
    TodayTable,
    closes_in,
    cycle_of,
)

MODE_BANDS = (0.4, 1.0, 4.0)
"""Default bands of surface, accuracy and speed in units of tcp_deviation (interface)."""

ASSUMED = {
    "requirements": ("frequency_spread", "damping_spread", "reserve"),
    "control": ("kind", "position_loop", "position_cycle", "velocity_cycle"),
}
"""Keys whose defaults decide about limits; left out, they are assumptions."""


def build_machine(table: ProfileTable) -> Machine:
    """Return the machine of a validated profile.

    Parameters
    ----------
    table
        Validated, so everything here must succeed.

    Returns
    -------
    Machine
        SI.
    """
    return Machine(
        name=table.machine.name,
        axis=table.machine.axis,
        source=table.machine.source,
        motion=Motion(table.machine.motion),
        mechanics=table.plant.build(),
        drive=Drive(
            force_lag=table.drive.force_lag,
            max_force=table.drive.max_force,
            continuous_force=_or_infinite(table.drive.continuous_force),
            static_load=table.drive.static_load,
            coulomb_friction=table.drive.coulomb_friction,
            viscous_friction=table.drive.viscous_friction,
            lead=table.drive.lead,
            gear=table.drive.gear,
            encoder_resolution=table.drive.encoder_resolution or 0.0,
        ),
        moves=tuple(_build_move(move) for move in table.moves),
        requirements=_build_requirements(table.requirements),
        damping_optimal=_build_damping_optimal(table.damping_optimal),
        control=_build_control(table.control),
        today=_build_today(table.today) if table.today else None,
        illustrative=table.machine.illustrative,
        assumed=(*table.machine.assumed, *_left_out(table)),
        identified=table.identified.build() if table.identified else None,
    )


def _left_out(table: ProfileTable) -> list[str]:
    """The keys of ``ASSUMED`` that the profile does not state."""
    return [
        f"{name}.{key}"
        for name, keys in ASSUMED.items()
        for key in keys
        if key not in getattr(table, name).model_fields_set
    ]


def _or_infinite(value: float | None) -> float:
    return inf if value is None else value


def _or_weight(weight: float | None, is_there: bool) -> float:
    """A weight of feed-forward; left out, all of it where the control has it."""
    return float(is_there) if weight is None else weight


def _build_move(move: MoveTable) -> Move:
    if move.distance is not None:
        return Positioning(
            distance=move.distance, max_velocity=_or_infinite(move.max_velocity), dwell=move.dwell
        )
    if move.velocity_step is not None:
        return VelocityStep(velocity_step=move.velocity_step, dwell=move.dwell)
    raise AssertionError("a validated move has a distance or a velocity step")


def _build_requirements(needs: RequirementsTable) -> Requirements:
    given = (needs.modes.surface, needs.modes.accuracy, needs.modes.speed)
    surface, accuracy, speed = (
        factor * needs.tcp_deviation if band is None else band
        for band, factor in zip(given, MODE_BANDS, strict=True)
    )
    low, high = needs.payload or (0.0, 0.0)
    return Requirements(
        tcp_deviation=needs.tcp_deviation,
        modes=Modes(surface=surface, accuracy=accuracy, speed=speed),
        max_settling_time=_or_infinite(needs.max_settling_time),
        contour_deviation=_or_infinite(needs.contour_deviation),
        contour_feed=_or_infinite(needs.contour_feed),
        reserve=Reserve(band=needs.reserve.band, force=needs.reserve.force),
        frequency_spread=needs.frequency_spread,
        damping_spread=needs.damping_spread,
        every_size=needs.move_sizes == "every",
        payload=(low, high),
        payload_radius=needs.payload_radius,
        peaks=tuple(Peak(name=name, bound=bound) for name, bound in needs.peaks.items()),
    )


def _build_damping_optimal(settings: DampingOptimalTable) -> DampingOptimal:
    given = settings.weights if isinstance(settings.weights, dict) else {}
    weights = tuple(Weight(state=state, value=value) for state, value in given.items())
    return DampingOptimal(t_f=settings.t_f, weights=weights)


def _build_today(today: TodayTable) -> Today:
    return Today(
        acceleration=today.acceleration,
        jerk=today.jerk,
        position_gain=today.position_gain,
        velocity_gain=today.velocity_gain,
        integral_time=today.integral_time,
        setpoint_filter=today.setpoint_filter.build() if today.setpoint_filter else None,
    )


def _build_control(control: ControlTable) -> Control:
    kind, feedback = KINDS[control.kind], control.state_feedback
    given = feedback if isinstance(feedback, dict) else {}
    mode = StateFeedback(feedback) if isinstance(feedback, str) else StateFeedback.GIVEN
    chosen = control.setpoint_filter
    return Control(
        kind=kind,
        position_loop=closes_in(control),
        position_gain=control.position_gain,
        velocity_gain=control.velocity_gain,
        integral_time=control.integral_time,
        reference_model_time=control.reference_model_time,
        velocity_feedforward=_or_weight(control.velocity_feedforward, kind.velocity_feedforward),
        acceleration_feedforward=_or_weight(
            control.acceleration_feedforward, kind.acceleration_feedforward
        ),
        jerk_feedforward=control.jerk_feedforward,
        feedforward_mass=control.feedforward_mass,
        reference_delay=control.reference_delay if kind.reference_delay else 0.0,
        position_cycle=cycle_of(control),
        velocity_cycle=control.velocity_cycle or kind.velocity_cycle,
        tcp_sensor=TcpSensor(control.tcp_sensor),
        state_feedback=mode,
        state_gains=tuple(StateGain(state=name, value=value) for name, value in given.items()),
        setpoint_filter=chosen.build() if chosen else None,
        seeks_setpoint_filter=chosen is None,
        force_filters=tuple(one.build() for one in control.force_filters or ()),
        seeks_force_filters=control.force_filters is None,
        minimum_bandwidth_hz=control.minimum_bandwidth or 0.0,
    )
