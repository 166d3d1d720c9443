"""Profile tables -> Machine: where "left out" gets its meaning."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite

from mtcommission.control_kinds.kind import PositionLoop
from mtcommission.control_kinds.kinds import KINDS
from mtcommission.machine.control import Control, StateFeedback, StateGain, TcpSensor, Today
from mtcommission.machine.keys import list_keys
from mtcommission.machine.machine import (
    DampingOptimal,
    Drive,
    DriveKind,
    Machine,
    Modes,
    Motion,
    Move,
    Peak,
    Positioning,
    Requirements,
    Reserve,
    VelocityStep,
    Weight,
)
from mtcommission.profile.control_tables import ControlTable, TodayTable, closes_in, cycle_of
from mtcommission.profile.drive_tables import DriveTable, PositionSourceTable
from mtcommission.profile.model import (
    DampingOptimalTable,
    MoveTable,
    ProfileTable,
    RequirementsTable,
)

MODE_BANDS = (0.4, 1.0, 4.0)
"""Default bands of surface, accuracy and speed in units of tcp_deviation (interface)."""

ASSUMED = {
    "drive": ("static_load",),
    "requirements": ("frequency_spread", "damping_spread", "reserve"),
    "control": ("kind", "position_loop", "position_cycle", "velocity_cycle"),
}
"""Keys whose defaults decide about limits; left out, they are assumptions, as is each dwell."""


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
    mechanics = table.plant.build()
    drive = _build_drive(table.drive, table.moves)
    return Machine(
        name=table.machine.name,
        axis=table.machine.axis,
        source=table.machine.source,
        motion=Motion(table.machine.motion),
        mechanics=mechanics,
        drive=drive,
        moves=tuple(_build_move(move, fastest=drive.max_velocity) for move in table.moves),
        requirements=_build_requirements(table.requirements),
        damping_optimal=_build_damping_optimal(table.damping_optimal),
        control=_build_control(table.control, follows=drive.follows),
        today=_build_today(table.today) if table.today else None,
        illustrative=table.machine.illustrative,
        assumed=(*table.machine.assumed, *_left_out(table, drive)),
        identified=table.identified.build() if table.identified else None,
    )


def _left_out(table: ProfileTable, drive: Drive) -> list[str]:
    """The keys that decide about limits and that the profile does not state."""
    decides = {
        f"{name}.{key}": getattr(table, name) for name, keys in ASSUMED.items() for key in keys
    }
    if drive.follows:
        del decides["drive.static_load"]
    if drive.follows or len(KINDS[table.control.kind].position_loops) == 1:
        del decides["control.position_loop"]  # nothing to choose
    if isfinite(drive.continuous_force):
        decides |= {f"moves[{n}].dwell": move for n, move in enumerate(table.moves, start=1)}
    return [
        key
        for key, stated in decides.items()
        if key.rpartition(".")[2] not in stated.model_fields_set
    ]


def _or_infinite(value: float | None) -> float:
    return inf if value is None else value


def _or_weight(weight: float | None, is_there: bool) -> float:
    """A weight of feed-forward; left out, all of it where the control has it."""
    return float(is_there) if weight is None else weight


def _build_drive(drive: DriveTable | PositionSourceTable, moves: Sequence[MoveTable]) -> Drive:
    if isinstance(drive, PositionSourceTable):
        limit = drive.velocity_limit
        # One acceleration is typed in for all velocities: what is left at the largest counts.
        fastest = max(
            min(move.velocity_step or _or_infinite(move.max_velocity), limit) for move in moves
        )
        return Drive(
            kind=DriveKind.POSITION_SOURCE,
            force_lag=0.0,
            max_force=drive.acceleration_up_to(fastest),
            max_velocity=limit,
            force_velocity=fastest if drive.acceleration_curve else None,
        )
    return Drive(
        force_lag=drive.force_lag,
        max_force=drive.max_force,
        continuous_force=_or_infinite(drive.continuous_force),
        static_load=drive.static_load,
        coulomb_friction=drive.coulomb_friction,
        viscous_friction=drive.viscous_friction,
        lead=drive.lead,
        gear=drive.gear,
        encoder_resolution=drive.encoder_resolution or 0.0,
    )


def _build_move(move: MoveTable, *, fastest: float) -> Move:
    if move.distance is not None:
        velocity = min(_or_infinite(move.max_velocity), fastest)
        return Positioning(distance=move.distance, max_velocity=velocity, dwell=move.dwell)
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
        **{key: _or_infinite(getattr(needs, key)) for key, _, _ in list_keys(Requirements)},
        modes=Modes(surface=surface, accuracy=accuracy, speed=speed),
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


def _build_control(control: ControlTable, *, follows: bool) -> Control:
    kind, feedback = KINDS[control.kind], control.state_feedback
    given = feedback if isinstance(feedback, dict) else {}
    mode = StateFeedback(feedback) if isinstance(feedback, str) else StateFeedback.GIVEN
    chosen = control.setpoint_filter
    position_cycle, velocity_cycle = (
        cycle_of(control),
        control.velocity_cycle or kind.velocity_cycle,
    )
    if follows and kind.follows_steps and control.position_cycle is None:
        position_cycle = 2.0 * velocity_cycle  # steps leave at any instant
    return Control(
        kind=kind,
        position_loop=PositionLoop.DRIVE if follows else closes_in(control),
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
        position_cycle=position_cycle,
        velocity_cycle=velocity_cycle,
        tcp_sensor=TcpSensor(control.tcp_sensor),
        state_feedback=mode,
        state_gains=tuple(StateGain(state=name, value=value) for name, value in given.items()),
        setpoint_filter=chosen.build() if chosen else None,
        seeks_setpoint_filter=chosen is None,
        force_filters=tuple(one.build() for one in control.force_filters or ()),
        seeks_force_filters=control.force_filters is None and kind.force_filters > 0,
        minimum_bandwidth_hz=control.minimum_bandwidth or 0.0,
    )
