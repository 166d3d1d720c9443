"""The whole chain as a list of verbs: read ``commission`` first.

machine -> plant -> tuned loop -> chosen limits -> setpoints -> responses in every corner
        -> assessment -> optima, and studies with what is known
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mtcommission.base.messages.message import Message
from mtcommission.commission.glance import plot_moves, say_verdict, show_html
from mtcommission.commission.recommend import Announce, Progress, recommend
from mtcommission.limits.choose import Choice
from mtcommission.limits.commissioning_rule import RuleResult
from mtcommission.limits.judge import Assessment, Candidate, MoveResult
from mtcommission.limits.optima import (
    Optima,
    WithinBand,
    condense_optima,
    find_optima,
    find_within_band,
)
from mtcommission.loop.disturbance import DisturbanceStep
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.machine.identified import ToolSensor
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.plant import Plant
from mtcommission.machine.profile.read import ProfileSource
from mtcommission.study.attainable import (
    Attainable,
    ModeLimits,
    find_attainable,
    find_limits_by_mode,
)
from mtcommission.study.improvements import (
    Improvement,
    find_improvements,
    value_tool_sensor,
)
from mtcommission.study.loops import LoopChoice, disturb, show_state_feedback
from mtcommission.study.robustness import (
    FrictionEffect,
    MoveSizes,
    Robustness,
    compare_move_sizes,
    examine_friction,
    examine_robustness,
)
from mtcommission.study.rules import TodaysValues, compare_shapers
from mtcommission.study.variations import Row, judge, serve_listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Commissioning:
    """All that was computed for a machine; a notebook shows verdict, limits and plot."""

    machine: Machine  # nominal
    plant: Plant
    optima: tuple[Optima, ...]  # one for each move
    within_band: tuple[WithinBand, ...]  # the fastest controls that leave the tool in the band
    loop: LoopChoice  # the one that is used, and its variants
    disturbed: dict[str, DisturbanceStep]  # the answer to a step of force, by name of the loop
    choice: Choice  # recommended limits, judged, and each move with them
    listed: Candidate | None  # what would serve the listed sizes best; None: only these count
    alternatives: tuple[Candidate, ...]  # limits condensed from the optima
    rules: tuple[Candidate, ...]  # the makers' and textbooks' rules, and the control's shapers
    modes: tuple[ModeLimits, ...]  # limits for the three machining modes
    rule: RuleResult  # the commissioning rule by hand, applied to this machine
    robustness: Robustness  # the recommendation where the machine differs a little
    move_sizes: tuple[MoveSizes, ...]  # recommendation and rule on smaller and larger moves
    attainable: tuple[Attainable, ...]  # what could be met in place of what stands in the way
    friction: tuple[FrictionEffect, ...]  # what stated friction does to the recommended limits
    today: TodaysValues | None  # what the values now in the control do, where they are stated
    tool_sensor: ToolSensor | None  # what measuring at the tool could free, where that is open
    profile: ProfileSource | None  # that the machine came from; None: another source, so no record

    @property
    def improvements(self) -> tuple[Improvement, ...]:
        """What single changes would bring, the most first; computed when asked for."""
        return find_improvements(self.machine, self.loop, self.choice)

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

        ``figure``: empty, to be drawn into, e.g. one of pyplot's; None: a new one.
        """
        return plot_moves(self.machine, self.moves, self.tuned.corners, figure)

    def __repr__(self) -> str:
        """Return one line instead of every number inside."""
        return f"<Commissioning: {say_verdict(self.machine, self.recommended)}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: verdict, limits, requirements and the plot."""
        rules = [(item.name, item) for item in (*self.alternatives, *self.rules) if item.name]
        named = [(Message("recommended"), self.recommended), *rules]
        if self.today and self.today.judged:
            named.insert(1, (Message("today"), self.today.judged))
        return show_html(self.machine, named, self.plot())


def commission(
    machine: Machine,
    *,
    profile: ProfileSource | None = None,
    progress: Progress = lambda _: None,
    announce: Announce = lambda _: None,
) -> Commissioning:
    """Return optima, recommended limits, their response, the verdict and every study of a machine.

    ``profile``: where the machine came from, for a record; ``progress``: called with the name of
    each stage as it begins; ``announce``: called with the recommended limits, judged, as soon as
    they are known.

    Raises
    ------
    ComputationError
        A stage ended with a named outcome; the message tells the remedy.
    """
    answer = recommend(machine, with_rules=True, progress=progress, announce=announce)
    plant, tuned, choice, rule = answer.plant, answer.tuned, answer.choice, answer.rule
    assert rule is not None  # asked for
    loop = show_state_feedback(machine, answer.loop)
    progress(Message("stage-optimal-controls"))
    optima = tuple(find_optima(machine, plant, move) for move in machine.moves)
    within_band = tuple(find_within_band(machine, item) for item in optima)
    progress(Message("stage-responses"))
    listed = serve_listed(machine, tuned, choice, loop.filters)
    alternatives = [
        judge(Row(label=name, machine=machine, tuned=tuned, limits=limits))
        for name, limits in condense_optima(machine, plant, optima)
    ]
    shapers = compare_shapers(machine, tuned)
    attainable: tuple[Attainable, ...] = ()
    if not choice.meets_requirements:
        progress(Message("stage-attainable"))
        attainable = find_attainable(machine, tuned, choice)
    progress(Message("stage-machining-modes"))
    modes = find_limits_by_mode(machine, tuned, choice)
    progress(Message("robustness-heading"))
    sized = {
        "way-recommended": choice.limits,
        "way-listed": listed.limits if listed else None,
        "commissioning-rule": rule.limits,
    }
    return Commissioning(
        machine=machine,
        plant=plant,
        optima=optima,
        within_band=within_band,
        loop=loop,
        disturbed=disturb(loop),
        choice=choice,
        listed=listed,
        alternatives=tuple(alternatives),
        rules=(*answer.rules, *shapers),
        modes=modes,
        rule=rule,
        robustness=examine_robustness(machine, tuned, choice.limits),
        move_sizes=compare_move_sizes(machine, tuned, sized),
        attainable=attainable,
        friction=examine_friction(machine, tuned, choice.moves),
        today=answer.today,
        tool_sensor=value_tool_sensor(machine, tuned, choice),
        profile=profile,
    )
