"""The structure of the loop with its gains, as a block diagram."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.record import Record
from mtcommission.sheet.diagram import SUM_RADIUS
from mtcommission.sheet.plot_model import Box, Diagram, Wire, Word

WIDTH, HEIGHT = 740.0, 262.0
MAIN, AHEAD, BACK = 120.0, 32.0, 236.0
"""Heights of the forward path, of the feed-forward above it and of the feedback below."""

R = SUM_RADIUS
SUMS = (132.0, 262.0, 448.0)
"""Summing points for position, velocity and force."""


def structure(record: Record, words: Catalogue) -> Diagram:
    """Return position loop, velocity loop, feed-forward and state feedback with their values."""
    text, f, part = words.text, words.format, record.loop
    has_feedback = bool(part.state_feedback)
    wires = [*_forward_wires(), *_return_wires()]
    boxes = [*_forward_boxes(record, words), *_ahead_boxes(record, words)]
    boxes.append(_box(262 - 18, 182, 36, 28, "d/dt"))
    if has_feedback:
        count = text("diagram-gains", count=len(part.state_feedback))
        boxes.append(_box(396, 168, 104, 44, text("diagram-observer"), "K (x̂_ref − x̂)", count))
        wires += [_wire((448, BACK), (448, 212)), _wire((448, 168), (448, MAIN + R))]
    return Diagram(
        key="structure",
        caption=text("diagram-caption"),
        alt=text(
            "diagram-alt",
            kv=f.quantity(part.Kv, "1/s"),
            kp=f.axis(part.Kp, "N s/m"),
            tn=f.quantity(part.Tn, "s"),
            feedback=text("yes") if has_feedback else text("no"),
        ),
        width=WIDTH,
        height=HEIGHT,
        boxes=tuple(boxes),
        sums=tuple((x, MAIN) for x in SUMS),
        wires=tuple(wires),
        words=(
            Word(x=2, y=MAIN - 5, text="x_ref"),
            Word(x=128, y=AHEAD - 5, text="v_ref"),
            Word(x=288, y=AHEAD - 5, text="a_ref, j_ref"),
            Word(x=712, y=MAIN - 19, text="TCP"),
            Word(x=640, y=BACK - 5, text=words.name("encoder")),
            *(Word(x=x + 9, y=MAIN + 20, text="−") for x in SUMS[:2]),
        ),
    )


def _box(x: float, y: float, width: float, height: float, *lines: str) -> Box:
    return Box(x=x, y=y, width=width, height=height, lines=lines)


def _wire(*points: tuple[float, float]) -> Wire:
    return Wire(points=points)


def _forward_boxes(record: Record, words: Catalogue) -> list[Box]:
    text, f, part, plant = words.text, words.format, record.loop, record.plant
    force = f.quantity(part.motion_force, plant.units["F"])
    is_in_drive = part.position_loop == "drive"
    position_cycle = part.velocity_cycle if is_in_drive else part.position_cycle
    top = MAIN - 24
    return [
        _box(
            34,
            top,
            78,
            48,
            text("diagram-delay"),
            f"τ = {f.quantity(part.reference_delay, 's')}",
        ),
        _box(
            154,
            top,
            88,
            48,
            f"Kv = {f.quantity(part.Kv, '1/s')}",
            text("diagram-cycle", cycle=f.quantity(position_cycle, "s")),
            _late(record, "path-position-controller", words),
        ),
        _box(
            286,
            top - 6,
            140,
            60,
            "Kp (1 + 1/(Tn s))",
            f"Kp = {f.axis(part.Kp, 'N s/m')}",
            f"Tn = {f.quantity(part.Tn, 's')}, "
            f"{text('diagram-cycle', cycle=f.quantity(part.velocity_cycle, 's'))}",
            _late(record, "path-velocity-controller", words),
        ),
        _box(
            474,
            top,
            108,
            48,
            f"|F_set| ≤ {force}",
            "1 / (1 + T s)",
            f"T = {f.quantity(part.force_lag, 's')}",
        ),
        _box(
            610,
            top,
            98,
            48,
            text("diagram-mechanics"),
            f"m = {f.axis(plant.moving_mass, 'kg')}",
            text("diagram-modes", count=len(plant.modes)),
        ),
    ]


def _ahead_boxes(record: Record, words: Catalogue) -> list[Box]:
    f = words.format
    ahead = record.loop.feedforward
    velocity, acceleration, jerk = (
        f.number(weight) for weight in (ahead.velocity, ahead.acceleration, ahead.jerk)
    )
    mass = f.axis(ahead.mass, "kg")
    return [
        _box(
            160,
            AHEAD - 17,
            92,
            34,
            f"× {velocity}",
            _late(record, "path-velocity-feed-forward", words),
        ),
        _box(
            352,
            AHEAD - 21,
            178,
            42,
            f"m ({acceleration} a_ref + {jerk} T j_ref)",
            f"m = {mass}",
            _late(record, "path-force-feed-forward", words),
        ),
    ]


def _late(record: Record, path: str, words: Catalogue) -> str:
    """Return how late a path acts, drive and filters included."""
    totals = {entry.path.kind: entry.total for entry in record.loop.delays}
    return words.text("diagram-late", time=words.format.quantity(totals.get(path), "s"))


def _forward_wires() -> list[Wire]:
    position, velocity, force = SUMS
    return [
        _wire((0, MAIN), (34, MAIN)),
        _wire((112, MAIN), (position - R, MAIN)),
        _wire((position + R, MAIN), (154, MAIN)),
        _wire((242, MAIN), (velocity - R, MAIN)),
        _wire((velocity + R, MAIN), (286, MAIN)),
        _wire((426, MAIN), (force - R, MAIN)),
        _wire((force + R, MAIN), (474, MAIN)),
        _wire((582, MAIN), (610, MAIN)),
        _wire((708, MAIN - 12), (WIDTH - 2, MAIN - 12)),
        _wire((126, AHEAD), (160, AHEAD)),
        _wire((252, AHEAD), (velocity, AHEAD), (velocity, MAIN - R)),
        _wire((286, AHEAD), (352, AHEAD)),
        _wire((force, AHEAD + 21), (force, MAIN - R)),
    ]


def _return_wires() -> list[Wire]:
    """The encoder's position back to the position loop, and its rate to the velocity loop."""
    position, velocity, _ = SUMS
    right = WIDTH - 14
    return [
        _wire(
            (708, MAIN + 12),
            (right, MAIN + 12),
            (right, BACK),
            (position, BACK),
            (position, MAIN + R),
        ),
        _wire((velocity, BACK), (velocity, 210)),
        _wire((velocity, 182), (velocity, MAIN + R)),
    ]
