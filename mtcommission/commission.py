"""The whole chain as a list of verbs: read ``commission`` first.

machine -> plant -> optima -> starting limits -> tuned loop -> chosen limits
        -> setpoints -> responses in every corner -> assessment
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING

from mtcommission.glance import plot_moves, say_verdict, show_html
from mtcommission.limits.choose import Choice, choose_for_listed, choose_limits
from mtcommission.limits.commissioning_rule.rule import RuleResult, apply_commissioning_rule
from mtcommission.limits.optima import Optima, condense_optima, find_optima
from mtcommission.loop.tuning.tuning import TunedLoop
from mtcommission.machine.machine import Machine
from mtcommission.machine.rigid_body import require_force
from mtcommission.messages.message import Message
from mtcommission.plant.plant import Plant, build_plant
from mtcommission.profile.read import ProfileSource
from mtcommission.recommend import Announce, Progress
from mtcommission.setpoint.duration import require_short_moves
from mtcommission.study.attainable import Attainable, find_attainable
from mtcommission.study.comparison import MoveComparison, compare_move
from mtcommission.study.friction import FrictionEffect, examine_friction
from mtcommission.study.improvements import Improvement, find_improvements
from mtcommission.study.known_rules import evaluate_rules
from mtcommission.study.loop_choice import settle_on_loop, show_alternatives
from mtcommission.study.loop_study import LoopStudy, study_loop
from mtcommission.study.loop_trials import LoopChoice
from mtcommission.study.machining_modes import ModeLimits, find_limits_by_mode
from mtcommission.study.move_sizes import MoveSizes, compare_move_sizes
from mtcommission.study.robustness import Robustness, examine_robustness
from mtcommission.study.settings import Settings
from mtcommission.study.shapers import compare_shapers
from mtcommission.study.today import TodaysValues, judge_today
from mtcommission.study.tool_sensor import ToolSensor, value_tool_sensor
from mtcommission.study.within_band import WithinBand, find_within_band
from mtcommission.verdict.assess import Assessment
from mtcommission.verdict.evaluate import Candidate, MoveResult, evaluate

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Commissioning:
    """All that was computed for a machine; a notebook shows verdict, limits and plot.

    Parameters
    ----------
    machine, plant
        Nominal.
    settings
        Numerical settings used.
    optima
        One for each move.
    within_band
        The fastest controls of each move that leave the tool within the band.
    loop
        The loop that is used, and its variants.
    loop_study
        Its answer to a disturbance, and the effect of the jerk feed-forward.
    choice
        Recommended limits, judged, each move with them, and the landscape of the search.
    listed
        The limits that would serve the listed sizes of move best; None where only these count, or
        where every size cannot be served.
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
    friction
        What the stated friction does to the recommended limits; empty where none is stated.
    today
        What the values now in the control do; None where the profile states none.
    tool_sensor
        What measuring at the tool could free; None where nothing was measured, or all of it.
    profile
        The profile that the machine came from; None: another source, so no record.
    improve
        Finds what single changes would bring, when it is first asked for: a sweep never does.
    """

    machine: Machine
    plant: Plant
    settings: Settings
    optima: tuple[Optima, ...]
    within_band: tuple[WithinBand, ...]
    loop: LoopChoice
    loop_study: LoopStudy
    choice: Choice
    listed: Candidate | None
    alternatives: tuple[Candidate, ...]
    rules: tuple[Candidate, ...]
    comparisons: tuple[MoveComparison, ...]
    modes: tuple[ModeLimits, ...]
    rule: RuleResult
    robustness: Robustness
    move_sizes: tuple[MoveSizes, ...]
    attainable: tuple[Attainable, ...]
    friction: tuple[FrictionEffect, ...]
    today: TodaysValues | None
    tool_sensor: ToolSensor | None
    profile: ProfileSource | None
    improve: Callable[[], tuple[Improvement, ...]]

    @property
    def improvements(self) -> tuple[Improvement, ...]:
        """What single changes would bring, the most first."""
        return self.improve()

    @property
    def tuned(self) -> TunedLoop:
        """The loop that is used, in every corner."""
        return self.loop.tuned

    @property
    def moves(self) -> tuple[MoveResult, ...]:
        """Each move with the recommended limits."""
        return self.choice.moves

    @property
    def recommended(self) -> Candidate:
        """The recommendation, judged."""
        return self.choice.candidate

    @property
    def assessment(self) -> Assessment:
        """Verdict on the recommendation."""
        return self.recommended.assessment

    def plot(self, figure: Figure | None = None) -> Figure:
        """Return a figure: deviation at the tool and set force of each move, in every corner.

        Parameters
        ----------
        figure
            Empty, to be drawn into, e.g. one of pyplot's; None: a new one.
        """
        return plot_moves(self.machine, self.moves, self.tuned.corners, figure)

    def __repr__(self) -> str:
        """Return one line instead of every number inside."""
        return f"<Commissioning: {say_verdict(self.machine, self.recommended)}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: verdict, limits, requirements and the plot."""
        rules = [(item.name, item) for item in (*self.alternatives, *self.rules) if item.name]
        named = [(Message("terminal-recommended"), self.recommended), *rules]
        if self.today and self.today.judged:
            named.insert(1, (Message("terminal-today"), self.today.judged))
        return show_html(self.machine, named, self.plot())


def commission(
    machine: Machine,
    *,
    profile: ProfileSource | None = None,
    settings: Settings | None = None,
    progress: Progress = lambda _: None,
    announce: Announce = lambda _: None,
) -> Commissioning:
    """Return optima, recommended limits, their response and the verdict for a machine.

    Parameters
    ----------
    machine
        From a profile.
    profile
        That profile, for a record.
    settings
        Numerical settings; None: the defaults.
    progress
        Called with the name of each stage as it begins.
    announce
        Called with the recommended limits, judged, as soon as they are known.

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    settings = settings or Settings()
    require_force(machine)
    require_short_moves(machine)
    plant = build_plant(machine)
    progress(Message("stage-feedback-loop"))
    loop = settle_on_loop(machine, plant, settings)
    tuned = loop.tuned
    progress(Message("stage-limits"))
    choice = loop.choice or choose_limits(machine, plant, tuned)
    announce(choice.candidate)
    loop = show_alternatives(machine, plant, loop, settings)
    progress(Message("stage-optimal-controls"))
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    within_band = tuple(
        find_within_band(machine, plant, item, settings=settings.band) for item in optima
    )
    condensed = condense_optima(machine, plant, optima)
    listed = None
    if machine.requirements.every_size and choice.meets_requirements:
        listed = choose_for_listed(machine, plant, tuned)
    progress(Message("stage-responses"))
    alternatives = tuple(
        evaluate(machine, plant, tuned, limits, name=name) for name, limits in condensed
    )
    rule = apply_commissioning_rule(machine, plant, tuned)
    rules = evaluate_rules(machine, plant, tuned, rule)
    shapers = compare_shapers(machine, plant, tuned)
    attainable: tuple[Attainable, ...] = ()
    if not choice.meets_requirements:
        progress(Message("stage-attainable"))
        attainable = find_attainable(machine, plant, tuned, choice)
    progress(Message("stage-machining-modes"))
    modes = find_limits_by_mode(machine, plant, tuned, choice)
    progress(Message("stage-comparison"))
    triples = zip(optima, within_band, choice.moves, strict=True)
    comparisons = tuple(
        compare_move(machine, plant, tuned, item, result, robust=within.robust)
        for item, within, result in triples
    )
    progress(Message("stage-robustness"))
    robustness = examine_robustness(
        machine, plant, tuned, choice.limits, settings=settings.robustness
    )
    friction = examine_friction(machine, tuned, choice.moves)
    today = judge_today(machine, plant, tuned, settings.robustness)
    loop_study = study_loop(machine, loop, choice.limits)
    move_sizes = compare_move_sizes(
        machine, tuned, choice.limits, listed.limits if listed else None, rule.limits
    )
    tool_sensor = value_tool_sensor(machine, tuned, choice)
    return Commissioning(
        machine=machine,
        plant=plant,
        settings=settings,
        optima=optima,
        within_band=within_band,
        loop=loop,
        loop_study=loop_study,
        choice=choice,
        listed=listed,
        alternatives=alternatives,
        rules=(*rules, *shapers),
        comparisons=comparisons,
        modes=modes,
        rule=rule,
        robustness=robustness,
        move_sizes=move_sizes,
        attainable=attainable,
        friction=friction,
        today=today,
        tool_sensor=tool_sensor,
        profile=profile,
        improve=cache(partial(find_improvements, machine, loop, choice, comparisons, settings)),
    )
