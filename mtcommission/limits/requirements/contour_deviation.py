"""How far the tool is off during the whole move, no faster than contours are followed."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Requirement, Swing, Yields
from mtcommission.loop.respond import tool_deviation
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move, VelocityStep


def _with_deviation(machine: Machine, deviation: float) -> Machine:
    needs = replace(machine.requirements, contour_deviation=deviation)
    return replace(machine, requirements=needs)


def slow_to_feed(move: Move, feed: float) -> Move:
    """Return the move at which the contour must hold: no faster than a feed [m/s]; inf: itself."""
    if isinstance(move, VelocityStep):
        return replace(move, velocity_step=min(move.velocity_step, feed))
    return replace(move, max_velocity=min(move.max_velocity, feed))


CONTOUR_DEVIATION = Requirement(
    key="contour deviation",
    message=Message("requirement-contour-deviation"),
    unit=lambda machine, _: machine.axis_units.length.si,
    bound=lambda machine: machine.requirements.contour_deviation,
    with_bound=_with_deviation,
    share=lambda reserve: reserve.band,
    judged=lambda machine, move: slow_to_feed(move, machine.requirements.contour_feed),
    value=lambda response, _: response.peak_deviation,
    with_noise=lambda value, noise: value + noise.tool,
    by_poles=lambda plant: Swing(signal=tool_deviation(plant.order)),
    yields=Yields.FIRST,
    whole_move=("requirements.contour_deviation", "requirements.contour_feed"),
)
