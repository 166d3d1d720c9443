"""The whole chain as a list of verbs: read ``commission`` first.

machine -> plant -> optima -> starting limits -> tuned loop -> chosen limits
        -> setpoints -> responses in every corner -> assessment
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.limits.commissioning_rule.rule import RuleResult, apply_commissioning_rule
from mtcommission.limits.optima import Optima, condense_optima, find_optima, require_force
from mtcommission.limits.rules_of_thumb import apply_rules_of_thumb, apply_slower_ramps
from mtcommission.loop.simulate.continuous import ContinuousResponse, simulate_continuous
from mtcommission.loop.simulation_budget import require_affordable
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.study.assess import Assessment
from mtcommission.study.attainable import Attainable, find_attainable, find_least_residual
from mtcommission.study.comparison import ComparedControl, compare_controls
from mtcommission.study.evaluate import (
    Candidate,
    MoveResult,
    evaluate,
    evaluate_moves,
    simulate_moves,
)
from mtcommission.study.feedforward import FedForward, feed_forward, follow_setpoint
from mtcommission.study.loop_choice import LoopChoice, Settings, settle_on_loop
from mtcommission.study.loop_study import LoopStudy, study_loop
from mtcommission.study.move_sizes import MoveSizes, SetpointWay, vary_move_sizes
from mtcommission.study.robustness import Robustness, examine_robustness
from mtcommission.study.shapers import compare_shapers
from mtcommission.study.size_filter import find_size_filter

RULE_SOURCE = "this project, by hand; derived and validated in docs/commissioning-rule.md"

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeLimits:
    """Limits for one machining mode, from a band of its own.

    Parameters
    ----------
    name
        ``"surface"``, ``"accuracy"`` or ``"speed"``.
    band
        Allowed residual deviation [m].
    choice, candidate
        The search with this band, and its result judged with it.
    attainable
        Where that result does not meet all requirements, it is no recommendation: the least
        residual deviation that was found with the others kept; None if met, or if there is none.
    """

    name: str
    band: float
    choice: Choice
    candidate: Candidate
    attainable: Attainable | None


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveComparison:
    """A move done in the loop and by optimal controls.

    Parameters
    ----------
    controls
        The paper's comparison.
    fed_forward
        Names of the optimal controls, and what each does when it is fed forward; then the
        recommended limits on the same machines.
    continuous
        The recommended setpoint through the continuous approximation of the loop.
    """

    controls: tuple[ComparedControl, ...]
    fed_forward: tuple[tuple[str, tuple[FedForward, ...]], ...]
    continuous: ContinuousResponse


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
    loop
        The loop that is used, and its variants.
    loop_study
        Its answer to a disturbance, and the effect of the jerk feed-forward.
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
    comparisons
        One for each move.
    modes
        Limits for the three machining modes.
    rule
        The commissioning rule by hand, applied to this machine.
    robustness
        The recommended limits where machine or limits differ a little.
    move_sizes
        Recommendation, rule and setpoint filter on smaller and larger moves.
    attainable
        What could be met in place of the requirements that stand in the way; empty if all are
        met, or if the force itself does not suffice.
    """

    machine: Machine
    plant: Plant
    settings: Settings
    optima: tuple[Optima, ...]
    loop: LoopChoice
    loop_study: LoopStudy
    choice: Choice
    moves: tuple[MoveResult, ...]
    recommended: Candidate
    alternatives: tuple[Candidate, ...]
    rules: tuple[Candidate, ...]
    comparisons: tuple[MoveComparison, ...]
    modes: tuple[ModeLimits, ...]
    rule: RuleResult
    robustness: Robustness
    move_sizes: tuple[MoveSizes, ...]
    attainable: tuple[Attainable, ...]

    @property
    def tuned(self) -> TunedLoop:
        """The loop that is used, in every corner."""
        return self.loop.tuned

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
    require_affordable(machine)
    plant = build_plant(machine)
    progress("optimal controls")
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    starts = condense_optima(machine, plant, optima)
    progress("feedback loop")
    loop = settle_on_loop(machine, plant, settings)
    tuned = loop.tuned
    progress("limits")
    start_limits = [candidate[1] for candidate in starts]
    choice = choose_limits(machine, plant, tuned, starts=start_limits, settings=settings.search)
    progress("responses and rules of thumb")
    moves = simulate_moves(machine, tuned, choice.limits)
    recommended = evaluate_moves(machine, plant, tuned, "recommended", "this search", moves)
    alternatives = tuple(
        evaluate(machine, plant, tuned, name, "condensed from the optimum", limits)
        for name, limits in starts
    )
    rule = apply_commissioning_rule(machine, plant, tuned)
    rules = evaluate_rules(machine, plant, tuned, rule)
    attainable: tuple[Attainable, ...] = ()
    if not recommended.assessment.is_met:
        progress("what could be met")
        attainable = find_attainable(machine, plant, tuned, choice, settings=settings.comparison)
    progress("machining modes")
    modes = limits_by_mode(machine, plant, tuned, choice, start_limits, settings)
    progress("comparison with the optima")
    comparisons = tuple(
        compare(machine, plant, tuned, item, result)
        for item, result in zip(optima, moves, strict=True)
    )
    progress("robustness")
    robustness = examine_robustness(
        machine, plant, tuned, choice.limits, settings=settings.robustness
    )
    return Commissioning(
        machine=machine,
        plant=plant,
        settings=settings,
        optima=optima,
        loop=loop,
        loop_study=study_loop(machine, loop, choice.limits),
        choice=choice,
        moves=moves,
        recommended=recommended,
        alternatives=alternatives,
        rules=rules,
        comparisons=comparisons,
        modes=modes,
        rule=rule,
        robustness=robustness,
        move_sizes=vary_move_sizes(machine, tuned, _ways(machine, plant, tuned, choice, rule)),
        attainable=attainable,
    )


def evaluate_rules(
    machine: Machine, plant: Plant, tuned: TunedLoop, rule: RuleResult
) -> tuple[Candidate, ...]:
    """Return what the rules of makers and textbooks do in the same loop.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    rule
        The commissioning rule, applied.

    Returns
    -------
    tuple of Candidate
        First the commissioning rule, then the others, then shapers and the jerk filter.
    """
    return (
        evaluate(machine, plant, tuned, "commissioning rule", RULE_SOURCE, rule.limits),
        *(
            evaluate(machine, plant, tuned, item.name, item.source, item.limits)
            for item in (*apply_rules_of_thumb(machine, plant), *apply_slower_ramps(machine, plant))
        ),
        *compare_shapers(machine, plant, tuned),
    )


def limits_by_mode(
    machine: Machine,
    plant: Plant,
    tuned: TunedLoop,
    choice: Choice,
    starts: Sequence[MotionLimits],
    settings: Settings,
) -> tuple[ModeLimits, ...]:
    """Return limits for the machining modes surface, accuracy and speed.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    choice
        The recommendation; reused where a mode has the same band.
    starts
        Limits to refine from.
    settings
        Of the search.

    Returns
    -------
    tuple of ModeLimits
    """
    found = []
    bands = machine.requirements.modes
    for name in ("surface", "accuracy", "speed"):
        band: float = getattr(bands, name)
        needs = replace(machine.requirements, tcp_deviation=band)
        other = replace(machine, requirements=needs)
        chosen = choice
        if band != machine.requirements.tcp_deviation:
            chosen = choose_limits(other, plant, tuned, starts=starts, settings=settings.search)
        candidate = evaluate(other, plant, tuned, name, "machining mode", chosen.limits)
        attainable = None
        if not candidate.assessment.is_met:
            attainable = find_least_residual(other, plant, tuned, chosen)
        found.append(
            ModeLimits(
                name=name, band=band, choice=chosen, candidate=candidate, attainable=attainable
            )
        )
    return tuple(found)


def _ways(
    machine: Machine, plant: Plant, tuned: TunedLoop, choice: Choice, rule: RuleResult
) -> tuple[SetpointWay, ...]:
    """What is tried on moves of other sizes; the filter only where it cures all smaller ones."""
    own = machine.control.moving_average_time
    cure = find_size_filter(machine, plant, tuned)
    return (
        SetpointWay(name="recommended", limits=choice.limits, moving_average=own),
        SetpointWay(name="commissioning rule", limits=rule.limits, moving_average=own),
        *((cure,) if cure else ()),
    )


def compare(
    machine: Machine, plant: Plant, tuned: TunedLoop, optima: Optima, result: MoveResult
) -> MoveComparison:
    """Return what the optimal controls of a move do, on the plant and fed forward in the loop.

    Parameters
    ----------
    machine, plant, tuned
        Nominal machine, its plant and its loop.
    optima, result
        Of the same move.

    Returns
    -------
    MoveComparison
    """
    solutions = {
        "time-optimal": optima.time,
        "constrained": optima.constrained,
        "damping-optimal": optima.damping,
    }
    found = {name: solution for name, solution in solutions.items() if solution is not None}
    return MoveComparison(
        controls=compare_controls(
            machine,
            plant,
            tuned,
            optima.move,
            limits=result.setpoint.limits,
            optima=tuple(found.values()),
        ),
        fed_forward=(
            *(
                (name, feed_forward(machine, plant, tuned, solution))
                for name, solution in found.items()
            ),
            ("recommended limits", follow_setpoint(machine, plant, tuned, result.setpoint)),
        ),
        continuous=simulate_continuous(
            plant,
            tuned.controller,
            result.setpoint,
            model=plant,
            band=machine.requirements.tcp_deviation,
            until=min(float(result.responses[0].t[-1]), result.responses[0].t_end + 0.5),
        ),
    )
