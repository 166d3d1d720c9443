"""How far the tool is off once the move has ended: within the band, from t_e + τ on."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Requirement, Swing, Yields
from mtcommission.loop.respond import tool_deviation
from mtcommission.machine.machine import Machine


def _with_band(machine: Machine, band: float) -> Machine:
    return replace(machine, requirements=replace(machine.requirements, tcp_deviation=band))


RESIDUAL_DEVIATION = Requirement(
    key="residual deviation",
    message=Message("requirement-residual-deviation"),
    unit=lambda machine, _: machine.axis_units.length.si,
    bound=lambda machine: machine.requirements.tcp_deviation,
    with_bound=_with_band,
    share=lambda reserve: reserve.band,
    value=lambda response, _: response.residual_deviation,
    with_noise=lambda value, noise: value + noise.tool,
    by_poles=lambda plant: Swing(signal=tool_deviation(plant.order), is_after=True),
    yields=Yields.FIRST,
    rests_on=("requirements.frequency_spread", "spread"),
)
