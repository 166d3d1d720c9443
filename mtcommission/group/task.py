"""What is asked of axes that move together, and what they must have in common."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite

from mtcommission.base.errors import Fault, InputError
from mtcommission.base.messages.message import Message, Value
from mtcommission.base.units.quantities import LENGTH, VELOCITY
from mtcommission.commission.options import Options
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.moves import largest_velocity
from mtcommission.machine.profile.read import ProfileSource

AXES = (2, 3)
"""How many axes a group has, at least and at most."""


LARGEST_TOLERANCE = 10e-3
"""Of a contour [m]: more is a unit that was left out (design choice)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Axes, and the contour that they must keep together."""

    machines: tuple[Machine, ...]
    sources: tuple[ProfileSource, ...]
    plane: tuple[int, int]  # the axes that draw circles and corners
    tolerance: float  # largest contour deviation at the tool [m]
    feed: float  # the fastest at which contours are followed [m/s]
    radius: float | None  # of a circle that must keep the tolerance at that feed [m]; None: any

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes, as the profiles give them."""
        return tuple(machine.axis for machine in self.machines)


def read_task(
    machines: Sequence[Machine],
    sources: Sequence[ProfileSource],
    *,
    tolerance: str = "",
    plane: str = "",
    feed: str = "",
    radius: str = "",
) -> Task:
    """Return what some axes are to do together; texts are options of the command line, "" if none.

    Raises
    ------
    InputError
        With every fault found: axes that cannot move together, or what is not stated.
    """
    faults = list(_find_faults(machines, sources))
    if faults:
        raise InputError(faults)
    needs = [machine.requirements for machine in machines]
    names = [machine.axis for machine in machines]
    with Options() as options:
        within = min(need.contour_deviation for need in needs)
        if tolerance:
            within = options.positive("--tolerance", tolerance, LENGTH)
            if within > LARGEST_TOLERANCE:
                message = Message("group-tolerance-large", got=within, most=LARGEST_TOLERANCE)
                options.refuse("--tolerance", message)
        elif not isfinite(within):
            options.refuse("--tolerance", Message("group-tolerance-missing"))
        at = min(need.contour_feed for need in needs)
        if feed:
            at = options.positive("--feed", feed, VELOCITY)
        elif not isfinite(at):
            at = min(max(map(largest_velocity, machine.moves)) for machine in machines)
            if not isfinite(at):
                options.refuse("--feed", Message("group-feed-missing"))
        asked = options.positive("--radius", radius, LENGTH) if radius else None
        drawn = _read_plane(plane, names, options)
    return Task(
        machines=tuple(machines),
        sources=tuple(sources),
        plane=drawn,
        tolerance=within,
        feed=at,
        radius=asked,
    )


def _read_plane(text: str, names: Sequence[str], options: Options) -> tuple[int, int]:
    """The two axes whose names make up a text; the first two where it is empty."""
    pairs = {
        first + second: (i, k)
        for i, first in enumerate(names)
        for k, second in enumerate(names)
        if i != k
    }
    if text and text not in pairs:
        options.word("--plane", text, list(pairs))
    return pairs.get(text, (0, 1))


def _find_faults(machines: Sequence[Machine], sources: Sequence[ProfileSource]) -> Iterator[Fault]:
    """Each reason why axes cannot move together, at the profile that differs from the first."""
    least, most = AXES
    first = machines[0]
    if not least <= len(machines) <= most:
        yield _fault(sources[0], "", "group-count", got=len(machines), least=least, most=most)
    seen: dict[str, str] = {}
    for machine, source in zip(machines, sources, strict=True):
        name, kind = machine.axis, machine.control.kind.key
        if machine.motion is not Motion.LINEAR:
            yield _fault(source, "machine.motion", "group-rotary", name=name)
        if name in seen:
            yield _fault(source, "machine.axis", "group-same-name", name=name, other=seen[name])
        seen.setdefault(name, str(source.path))
        if kind != (other := first.control.kind.key):
            yield _fault(source, "control.kind", "group-other-control", got=kind, first=other)
        if machine.drive.follows != first.drive.follows:
            yield _fault(source, "drive.kind", "group-other-drive")
        for key in ("position_cycle", "velocity_cycle"):
            got, there = getattr(machine.control, key), getattr(first.control, key)
            if got != there:
                yield _fault(source, f"control.{key}", "group-other-cycle", got=got, first=there)
        both = machine.control, first.control
        is_given = not any(control.seeks_setpoint_filter for control in both)
        if is_given and both[0].setpoint_filter != both[1].setpoint_filter:
            yield _fault(source, "control.setpoint_filter", "group-other-filter")


def _fault(source: ProfileSource, key: str, kind: str, **values: Value) -> Fault:
    return Fault(where=str(source.path), key=key, message=Message(kind, **values))
