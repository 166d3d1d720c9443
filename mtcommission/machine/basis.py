"""Machine -> on what its results rest: what the control has, what is assumed, what is neglected."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isinf

from mtcommission.control_kinds.kind import ControlKind
from mtcommission.machine.machine import Machine
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message

OF_LOOP = ("control.position_loop", "control.position_cycle", "control.velocity_cycle")

SAID = (
    "requirements.frequency_spread",
    "requirements.damping_spread",
    "requirements.reserve",
    "control.kind",
    "control.position_loop",
    "control.position_cycle",
    "control.velocity_cycle",
    "drive.static_load",
)
"""Keys of ``Machine.assumed`` that have a sentence of their own."""


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
        if not kind.features[name.replace("-", "_")].is_verified:
            said = Message("feature-unread", feature=said)
        (has if count else lacks).append(said)
    if not lacks:
        return Message("kind-has-all", has=tuple(has))
    return Message("kind-has", has=tuple(has), lacks=tuple(lacks))


def list_assumed(machine: Machine) -> Iterator[Message]:
    """Yield what nobody stated of a machine, and what is taken instead."""
    needs, is_assumed = machine.requirements, machine.is_assumed
    if is_assumed("requirements.frequency_spread"):
        yield Message("assumed-frequency-spread", spread=needs.frequency_spread)
    if is_assumed("requirements.damping_spread"):
        yield Message("assumed-damping-spread", spread=needs.damping_spread)
    if is_assumed("requirements.reserve"):
        reserve = needs.reserve
        yield Message("assumed-reserve", band=reserve.band, force=reserve.force)
    if is_assumed("control.kind"):
        yield Message("assumed-kind")
    yield from _assumed_of_loop(machine)
    if is_assumed("drive.static_load"):
        load = machine.drive.static_load
        yield Message("assumed-static-load", load=load, unit=machine.axis_units.force.si)
    dwells = {f"moves[{n}].dwell": move.dwell for n, move in enumerate(machine.moves, start=1)}
    for n, key in enumerate(dwells, start=1):
        if is_assumed(key):
            yield Message("assumed-dwell", number=n, dwell=dwells[key])
    yield from machine.mechanics.assumptions()
    if machine.drive.force_velocity is not None:
        unit, length = machine.axis_units, machine.axis_units.length.si
        yield Message(
            "assumed-acceleration-at",
            acceleration=machine.drive.max_force,
            acceleration_unit=f"{length}/s^2",
            velocity=machine.drive.force_velocity,
            velocity_unit=unit.velocity.si,
        )
    others = [key for key in machine.assumed if key not in (*SAID, *dwells)]
    if others and not machine.illustrative:
        yield Message("assumed-keys", keys=tuple(Message("name", key=key) for key in others))


def _assumed_of_loop(machine: Machine) -> Iterator[Message]:
    """Yield where the position loop closes and the cycles, as far as nobody stated them."""
    control = machine.control
    if machine.is_assumed("control.position_loop"):
        yield Message("assumed-loop", place=Message(f"choice-{control.position_loop.value}"))
    if machine.is_assumed("control.position_cycle"):
        yield Message("assumed-position-cycle", cycle=control.position_cycle)
    if machine.is_assumed("control.velocity_cycle"):
        yield Message("assumed-velocity-cycle", cycle=control.velocity_cycle)


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
