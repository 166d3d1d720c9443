"""When the tool stays in its band at last, of the listed moves."""

from __future__ import annotations

from dataclasses import replace

from mtcommission.base.messages.message import Message
from mtcommission.limits.requirements.requirement import Requirement, Settling, Yields
from mtcommission.machine.machine import Machine


def _with_time(machine: Machine, time: float) -> Machine:
    return replace(machine, requirements=replace(machine.requirements, max_settling_time=time))


SETTLING_TIME = Requirement(
    key="settling time",
    message=Message("requirement-settling-time"),
    unit=lambda *_: "s",
    bound=lambda machine: machine.requirements.max_settling_time,
    with_bound=_with_time,
    share=lambda _: 1.0,  # a time is wanted as it is
    value=lambda response, _: response.settling_time,
    by_poles=lambda _: Settling(),
    yields=Yields.MINIMISED,
)
