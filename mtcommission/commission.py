"""The whole chain as a list of verbs: read ``commission`` first.

machine -> plant -> optima -> starting limits -> tuned loop -> chosen limits
        -> setpoints -> responses in every corner -> assessment
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

from mtcommission.assess import Assessment, assess
from mtcommission.choose import Choice, SearchSettings, choose_limits
from mtcommission.errors import ComputationError, Outcome
from mtcommission.limits import MotionLimits, condense
from mtcommission.loop.response import LoopResponse, simulate
from mtcommission.loop.tuning import TunedLoop, TuningSettings, tune_loop
from mtcommission.machine import Machine, Move, Positioning, StateFeedback
from mtcommission.optimal.constrained import solve_bounded_time_optimal
from mtcommission.optimal.damping_optimal import solve_damping_optimal
from mtcommission.optimal.solution import (
    Bound,
    DampingOptimum,
    TimeOptimum,
    sample_trajectory,
)
from mtcommission.optimal.time_optimal import solve_time_optimal
from mtcommission.optimal.weights import balanced_weights
from mtcommission.plant import Plant, build_plant
from mtcommission.rules import apply_rules
from mtcommission.setpoint import Setpoint, plan_setpoint

DAMPING_TIME_FACTOR = 1.2
"""Default t_f of the damping-optimal control over t_f,min where no peaks are bounded
(the project's definition)."""

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Numerical settings, all printed on the sheet.

    Parameters
    ----------
    tuning, search
        Of the loop's tuning and of the choice of limits.
    comparison
        The coarser search that decides whether state feedback pays.
    """

    tuning: TuningSettings = field(default_factory=TuningSettings)
    search: SearchSettings = field(default_factory=SearchSettings)
    comparison: SearchSettings = field(
        default_factory=lambda: SearchSettings(grid=32, coarse_grid=8, seeds=12, refinements=3)
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Optima:
    """The physical optima of one move on the nominal machine.

    Parameters
    ----------
    move
        Which move.
    time
        Time-optimal, exact rest; under max_velocity where the move has one.
    constrained
        The same under the profile's peaks; None where there are none.
    damping
        Damping-optimal; None where its final time is too short (see ``remarks``).
    remarks
        What was left out, and why.
    """

    move: Move
    time: TimeOptimum
    constrained: TimeOptimum | None
    damping: DampingOptimum | None
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveResult:
    """One move with some limits, in every corner.

    Parameters
    ----------
    setpoint
        What the control sends.
    responses
        One for each corner, the nominal machine first.
    """

    setpoint: Setpoint
    responses: tuple[LoopResponse, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Named limits through the same loop, corners and judgement as the recommendation.

    Parameters
    ----------
    name, source
        What they are and who says so.
    limits
        Acceleration and jerk.
    settling_time, residual_deviation, peak_deviation
        Worst over moves and corners [s, m, m].
    assessment
        Verdict on every requirement.
    """

    name: str
    source: str
    limits: MotionLimits
    settling_time: float
    residual_deviation: float
    peak_deviation: float
    assessment: Assessment


@dataclass(frozen=True, slots=True, kw_only=True)
class Commissioning:
    """All that was computed for a machine.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings used.
    optima
        One for each move.
    tuned
        The loop in every corner.
    choice
        Recommended limits and the landscape of the search.
    moves
        Each move with the recommended limits.
    recommended
        The recommendation, judged.
    alternatives
        Limits condensed from the optima.
    rules
        The makers' and textbooks' rules.
    """

    machine: Machine
    plant: Plant
    settings: Settings
    optima: tuple[Optima, ...]
    tuned: TunedLoop
    choice: Choice
    moves: tuple[MoveResult, ...]
    recommended: Trial
    alternatives: tuple[Trial, ...]
    rules: tuple[Trial, ...]

    @property
    def assessment(self) -> Assessment:
        """Verdict on the recommendation."""
        return self.recommended.assessment


def commission(
    machine: Machine, *, settings: Settings | None = None, progress: Progress = lambda _: None
) -> Commissioning:
    """Return optima, recommended limits, their response and the verdict for a machine.

    Parameters
    ----------
    machine
        From a profile.
    settings
        Numerical settings; None: the defaults.
    progress
        Called with the name of each stage as it begins.

    Returns
    -------
    Commissioning

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    settings = settings or Settings()
    require_force(machine)
    plant = build_plant(machine)
    progress("optimal controls")
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    starts = condense_optima(plant, optima)
    progress("feedback loop")
    tuned = settle_on_loop(machine, plant, settings)
    progress("limits")
    start_limits = [trial[1] for trial in starts]
    choice = choose_limits(machine, plant, tuned, starts=start_limits, settings=settings.search)
    progress("responses and rules of thumb")
    moves = run_moves(machine, tuned, choice.limits)
    recommended = judge(machine, plant, tuned, "recommended", "this search", choice.limits)
    alternatives = tuple(
        judge(machine, plant, tuned, name, "condensed from the optimum", limits)
        for name, limits in starts
    )
    rules = tuple(
        judge(machine, plant, tuned, rule.name, rule.source, rule.limits)
        for rule in apply_rules(machine, plant)
    )
    return Commissioning(
        machine=machine,
        plant=plant,
        settings=settings,
        optima=optima,
        tuned=tuned,
        choice=choice,
        moves=moves,
        recommended=recommended,
        alternatives=alternatives,
        rules=rules,
    )


def require_force(machine: Machine) -> None:
    """Raise NO_FORCE_LEFT if the static load takes all of the force.

    Parameters
    ----------
    machine
        Any machine.
    """
    drive = machine.drive
    if drive.motion_force <= 0.0:
        detail = f"static_load {drive.static_load:.6g} N of max_force {drive.max_force:.6g} N"
        raise ComputationError(Outcome.NO_FORCE_LEFT, detail)


def find_optima(machine: Machine, plant: Plant, move: Move) -> Optima:
    """Return the physical optima of one move.

    Parameters
    ----------
    machine, plant
        Nominal.
    move
        Velocity step or positioning.

    Returns
    -------
    Optima
    """
    force = machine.drive.motion_force
    time = find_time_optimum(plant, move, force_limit=force, bounds=())
    constrained, remarks = None, []
    bounds = tuple(Bound(name=p.name, value=p.bound) for p in machine.requirements.peaks)
    if bounds:
        try:
            constrained = find_time_optimum(plant, move, force_limit=force, bounds=bounds)
        except ComputationError as error:
            remarks.append(f"Optimum under the bounds on peaks: {error}.")
    wanted = machine.damping_optimal
    t_f = wanted.t_f or (constrained.t_f if constrained else DAMPING_TIME_FACTOR * time.t_f)
    damping = None
    try:
        damping = find_damping_optimum(machine, plant, move, t_f=t_f, least=time.t_f)
    except ComputationError as error:
        remarks.append(f"Damping-optimal control: {error}.")
    return Optima(
        move=move,
        time=time,
        constrained=constrained,
        damping=damping,
        remarks=tuple(remarks),
    )


def find_time_optimum(
    plant: Plant, move: Move, *, force_limit: float, bounds: tuple[Bound, ...]
) -> TimeOptimum:
    """Return the time-optimal control, bounded or free, whichever the move and bounds ask for."""
    limited = isinstance(move, Positioning) and isfinite(move.max_velocity)
    if bounds or limited:
        return solve_bounded_time_optimal(plant, move, force_limit=force_limit, bounds=bounds)
    return solve_time_optimal(plant, move, force_limit=force_limit)


def find_damping_optimum(
    machine: Machine, plant: Plant, move: Move, *, t_f: float, least: float
) -> DampingOptimum:
    """Return the damping-optimal control with the profile's weights, or balanced ones.

    Parameters
    ----------
    machine, plant
        Nominal.
    move
        Velocity step or positioning.
    t_f
        Final time [s].
    least
        t_f,min of the same move [s].

    Returns
    -------
    DampingOptimum

    Raises
    ------
    ComputationError
        FINAL_TIME_TOO_SHORT if t_f < least, with t_f,min in the message.
    """
    if t_f < least:
        detail = f"t_f = {1e3 * t_f:.6g} ms, but t_f,min = {1e3 * least:.6g} ms"
        raise ComputationError(Outcome.FINAL_TIME_TOO_SHORT, detail)
    force = machine.drive.motion_force
    weights = machine.damping_optimal.weights
    if not weights:
        reference = solve_time_optimal(plant, move, force_limit=force)
        weights = balanced_weights(plant, reference)
    return solve_damping_optimal(plant, move, force_limit=force, t_f=t_f, weights=weights)


def condense_optima(plant: Plant, optima: Sequence[Optima]) -> tuple[tuple[str, MotionLimits], ...]:
    """Return the jerk-limited profile closest to each optimum, with its name."""
    found = []
    for number, item in enumerate(optima, start=1):
        place = f", move {number}" if len(optima) > 1 else ""
        solutions = {
            "time-optimal": item.time,
            "constrained": item.constrained,
            "damping-optimal": item.damping,
        }
        for name, solution in solutions.items():
            if solution is None:
                continue
            motion = sample_trajectory(plant, solution.arcs, step=solution.t_f / 500)
            limits = condense(item.move, motion, velocity=plant.velocity)
            found.append((f"closest to the {name} control{place}", limits))
    return tuple(found)


def settle_on_loop(machine: Machine, plant: Plant, settings: Settings) -> TunedLoop:
    """Return the tuned loop, with state feedback only where it lets the move settle sooner.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings.

    Returns
    -------
    TunedLoop
        Its remarks state both settling times.
    """
    tuned = tune_loop(machine, settings=settings.tuning)
    if machine.control.state_feedback is not StateFeedback.AUTO:
        return tuned
    off = replace(machine, control=replace(machine.control, state_feedback=StateFeedback.OFF))
    plain = tune_loop(off, settings=settings.tuning)
    if not tuned.controller.state_gains.any():
        return replace(plain, remarks=(*plain.remarks, tuned.remarks[-1]))
    times = []
    for candidate in (tuned, plain):
        limits = choose_limits(machine, plant, candidate, settings=settings.comparison).limits
        times.append(judge(machine, plant, candidate, "", "", limits).settling_time)
    helps = times[0] < times[1]
    verdict = (
        f"Best settling time {1e3 * times[0]:.4g} ms with it, {1e3 * times[1]:.4g} ms without it: "
        f"it is {'used' if helps else 'left out'}."
    )
    kept = tuned if helps else plain
    return replace(kept, remarks=(*plain.remarks, tuned.remarks[-1], verdict))


def run_moves(machine: Machine, tuned: TunedLoop, limits: MotionLimits) -> tuple[MoveResult, ...]:
    """Return every move with these limits, simulated in every corner.

    Parameters
    ----------
    machine
        Nominal; its band and drive count.
    tuned
        The loop in every corner.
    limits
        Acceleration and jerk.

    Returns
    -------
    tuple of MoveResult
    """
    results = []
    for move in machine.moves:
        setpoint = plan_setpoint(move, limits, moving_average=machine.control.moving_average_time)
        responses = tuple(
            simulate(
                loop,
                lifted,
                setpoint,
                drive=machine.drive,
                band=machine.requirements.tcp_deviation,
            )
            for loop, lifted in zip(tuned.loops, tuned.lifted, strict=True)
        )
        results.append(MoveResult(setpoint=setpoint, responses=responses))
    return tuple(results)


def judge(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    name: str,
    source: str,
    limits: MotionLimits,
) -> Trial:
    """Return what some limits do in the same loop, corners and judgement as all others."""
    rows = [result.responses for result in run_moves(machine, tuned, limits)]
    everywhere = [response for row in rows for response in row]
    return Trial(
        name=name,
        source=source,
        limits=limits,
        settling_time=max(response.settling_time for response in everywhere),
        residual_deviation=max(response.residual_deviation for response in everywhere),
        peak_deviation=max(response.peak_deviation for response in everywhere),
        assessment=assess(machine, plant, tuned.corners, rows),
    )
