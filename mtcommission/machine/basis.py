"""Machine in words: control, filter and jerk as they are set, and on what results rest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isinf

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.controls.kind import ControlKind
from mtcommission.machine.machine import Machine
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.machine.shapers import name_shaper

OF_LOOP = ("control.position_loop", "control.position_cycle", "control.velocity_cycle")


OF_SETPOINT = ("jerk", "setpoint-filters", "modes")
"""What a control has that shapes its setpoint."""


def describe_kind(kind: ControlKind, *, follows: bool = False) -> Message:
    """Return what a kind of control has and what it lacks; "(?)" marks what was not read.

    Where the motor ``follows`` its setpoint, only what shapes the setpoint counts.
    """
    counts: dict[str, int] = {
        "jerk": int(kind.has_jerk_limit),
        "setpoint-filters": bool(kind.setpoint_filters),
        "velocity-feedforward": kind.velocity_feedforward,
        "acceleration-feedforward": kind.acceleration_feedforward,
        "jerk-feedforward": kind.jerk_feedforward,
        "reference-delay": kind.reference_delay,
        "force-filters": kind.force_filters,
        "state-feedback": kind.state_feedback,
        **({"modes": True} if kind.modes else {}),
    }
    if follows:
        counts = {name: count for name, count in counts.items() if name in OF_SETPOINT}
    has, lacks = list[Message](), list[Message]()
    for name, count in counts.items():
        said = Message(f"has-{name}")
        if count > 1:
            said = Message("feature-counted", count=count, feature=said)
        if name.replace("-", "_") in kind.unread:
            said = Message("feature-unread", feature=said)
        (has if count else lacks).append(said)
    if not lacks:
        return Message("kind-has-all", has=tuple(has))
    return Message("kind-has", has=tuple(has), lacks=tuple(lacks))


def list_neglected(machine: Machine) -> Iterator[Message]:
    """Yield what the model leaves out, with what to do where it matters."""
    if machine.drive.follows:
        yield Message("neglected-lost-steps")
        if machine.drive.force_velocity is None:
            yield Message("neglected-acceleration-over-speed")
    else:
        if machine.control.kind.follows_steps:
            yield Message("neglected-steps")
        yield Message("neglected-force-over-speed")
        if isinf(machine.drive.continuous_force):
            yield Message("neglected-heat")
    yield Message("neglected-friction")
    if not machine.drive.encoder_resolution and not machine.drive.follows:
        yield Message("neglected-encoder")
    yield Message("neglected-travel")


def name_control(kind: str, words: Catalogue) -> str:
    """Return the name of a kind of control."""
    return words.known(f"control-kind-{kind}", words.known(f"control-{kind}", kind))


def filter_rows(item: SetpointFilter | None, words: Catalogue) -> list[tuple[str, str]]:
    """Return a setpoint filter as it is entered: its kind, then each of its numbers."""
    text, f = words.text, words.format
    if item is None:
        return [(text("setpoint-filter"), text("no-setpoint-filter"))]
    shaper, count = name_shaper(item.kind), len(item.taps)
    name = text("filter-name", kind=item.kind, shaper=shaper, count=count)
    rows = [(text("setpoint-filter"), name)]
    if item.frequency_hz:
        return [
            *rows,
            (text("filter-of-frequency"), f.quantity(item.frequency_hz, "Hz")),
            (text("filter-of-damping"), f"ζ {f.number(item.damping_ratio)}"),
        ]
    times = (item.time or item.duration, item.second_time)
    labels = ("filter-of-length", "filter-of-second-length")
    named = zip(labels, times, strict=True)
    return [*rows, *((text(label), f.quantity(time, "s")) for label, time in named if time)]


def say_filter(item: SetpointFilter | None, words: Catalogue) -> str:
    """Return a setpoint filter with its numbers; None is "none"."""
    (_, kind), *numbers = filter_rows(item, words)
    return " ".join([kind, *([", ".join(value for _, value in numbers)] if numbers else [])])


def say_jerk(
    acceleration: float | None, jerk: float | None, shortest: float, words: Catalogue
) -> str:
    """Return a jerk limit; in words where its ramp is shorter than the shortest [s].

    Shapers and steps of acceleration have a jerk that limits nothing.
    """
    if jerk is None or (acceleration is not None and acceleration < shortest * jerk):
        return words.text("no-jerk-limit")
    return words.format.axis(jerk, "m/s^3")


def say_loop(place: str, position_cycle: float, velocity_cycle: float, words: Catalogue) -> str:
    """Return where the position loop closes, "" for nowhere, and the cycles [s]."""
    return words.text(
        "position-loop-at",
        place=place or "none",
        position_cycle=words.format.quantity(position_cycle, "s"),
        velocity_cycle=words.format.quantity(velocity_cycle, "s"),
    )


def mark_assumed(said: str, keys: Sequence[str], assumed: Sequence[str], words: Catalogue) -> str:
    """Return what rests on some keys of the profile, and which of them nobody stated."""
    if not assumed:
        return said
    if len(assumed) == len(keys):
        return words.text("assumed", value=said)
    return words.text("assumed-of", value=said, names=", ".join(map(words.name, assumed)))
