"""Whether a sensor at the tool is worth its price, where modes' share at the tool was assumed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.machine import Machine
from mtcommission.plant.plant import build_plant


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSensor:
    """What measuring at the tool could free at most."""

    modes: tuple[str, ...]  # those whose share at the tool was assumed
    settling_time: float  # with the limits recommended for these shares [s]; inf: not settled
    least: float  # with limits for a tool at rest in these modes [s]; inf: nothing is met even then


def value_tool_sensor(machine: Machine, tuned: TunedLoop, choice: Choice) -> ToolSensor | None:
    """Return what a sensor at the tool could free at most; None where nothing was assumed.

    The measurement may show anything between the assumed share, a worst case, and a tool at rest.
    """
    mechanics = machine.mechanics
    assumed = tuple(
        mode.name
        for place, mode in enumerate(mechanics.modes)
        if machine.is_assumed(f"{mechanics.mode_key(place)}.tcp_gain")
    )
    resting = mechanics.still_tool(assumed)
    if machine.identified is None or not assumed or resting is None:
        return None
    still = replace(machine, mechanics=resting)
    loop = close_loop(corner_plants(still), tuned.controller)
    # A tool that swings less may want another filter: everywhere, not about the recommendation.
    found = choose_limits(still, build_plant(still), loop)
    return ToolSensor(
        modes=assumed,
        settling_time=choice.candidate.settling_time if choice.meets_requirements else inf,
        least=found.candidate.settling_time if found.meets_requirements else inf,
    )
