"""What a sensor at the tool could free where the modes' share at the tool was assumed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from mtcommission.limits.choose import Choice, choose_limits
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.machine.machine import Machine
from mtcommission.plant.modal import Modal
from mtcommission.plant.plant import build_plant


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSensor:
    """What measuring at the tool could free.

    Parameters
    ----------
    modes
        Names of those whose share at the tool was assumed.
    settling_time
        With the limits recommended for these shares [s]; inf: not settled.
    least
        With limits for a tool that stands still in these modes, all else the same [s]; inf: no
        limits meet the requirements even then.
    """

    modes: tuple[str, ...]
    settling_time: float
    least: float


def value_tool_sensor(machine: Machine, tuned: TunedLoop, choice: Choice) -> ToolSensor | None:
    """Return what a sensor at the tool could free at most; None where nothing was assumed.

    The measurement may show anything between the assumed share, a worst case, and a tool at rest.

    Parameters
    ----------
    machine, tuned, choice
        The machine, the loop that is used, and the recommendation.
    """
    mechanics = machine.mechanics
    if machine.identified is None or not isinstance(mechanics, Modal):
        return None
    assumed = [
        machine.is_assumed(f"{mechanics.mode_key(place)}.tcp_gain")
        for place in range(len(mechanics.modes))
    ]
    if not any(assumed):
        return None
    pairs = list(zip(mechanics.modes, assumed, strict=True))
    modes = tuple(replace(mode, tcp_gain=0.0) if open_ else mode for mode, open_ in pairs)
    still = replace(machine, mechanics=replace(mechanics, modes=modes))
    loop = close_loop(corner_plants(still), tuned.controller)
    found = choose_limits(still, build_plant(still), loop)
    return ToolSensor(
        modes=tuple(mode.name for mode, open_ in pairs if open_),
        settling_time=choice.candidate.settling_time if choice.meets_requirements else inf,
        least=found.candidate.settling_time if found.meets_requirements else inf,
    )
