"""The structure of the loop with its gains, as a block diagram: structure.svg with its values."""

from __future__ import annotations

from pathlib import Path

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.web import fill_template
from mtcommission.record.record import Record
from mtcommission.sheet.document import Diagram
from mtcommission.sheet.tables import PATH_GAINS, show

SIZE, MARGIN = 9.5, 4.0
"""Font size and room beside text in a box [drawing units]."""

CHARACTER = 0.64
"""Width of a character relative to the font size; DejaVu Sans is narrower for all but capitals."""


def structure(record: Record, words: Catalogue) -> Diagram:
    """Return position loop, velocity loop, feed-forward and state feedback with their values."""
    text, part, plant, ahead = words.text, record.loop, record.plant, record.loop.feedforward
    kv, kp, tn = (gain.show(part, words) for gain in PATH_GAINS)
    number, cycle = words.format.number, part.position_cycle
    totals = {entry.path.kind: entry.total for entry in part.delays}

    def late(path: str) -> str:
        """How late a path acts, drive and filters included."""
        return text("diagram-late", time=show(totals.get(f"path-{path}"), words, "s"))

    def cycle_of(time: float) -> str:
        return text("diagram-cycle", cycle=show(time, words, "s"))

    count, feedback = len(part.state_feedback), tuple[str, ...]()
    if count:
        gains = text("diagram-gains", count=count)
        feedback = (text("diagram-observer"), "K (x̂_ref − x̂)", gains)
    alt = text("diagram-alt", kv=kv, kp=kp, tn=tn, feedback=text("yes" if count else "no"))
    svg = fill_template(
        Path(__file__).with_name("structure.svg"),
        alt=alt,
        size=text_size,
        delay=(text("diagram-delay"), f"τ = {show(part.reference_delay, words, 's')}"),
        position=(
            f"Kv = {kv}",
            cycle_of(part.velocity_cycle if part.position_loop == "drive" else cycle),
            late("position-controller"),
        ),
        velocity=(
            "Kp (1 + 1/(Tn s))",
            f"Kp = {kp}",
            f"Tn = {tn}, {cycle_of(part.velocity_cycle)}",
            late("velocity-controller"),
        ),
        drive=(
            f"|F_set| ≤ {show(part.motion_force, words, plant.units['F'])}",
            "1 / (1 + T s)",
            f"T = {show(part.force_lag, words, 's')}",
        ),
        mechanics=(
            text("diagram-mechanics"),
            f"m = {show(plant.moving_mass, words, 'kg')}",
            text("diagram-modes", count=len(plant.modes)),
        ),
        velocity_ahead=(f"× {number(ahead.velocity)}", late("velocity-feed-forward")),
        force_ahead=(
            f"m ({number(ahead.acceleration)} a_ref + {number(ahead.jerk)} T j_ref)",
            f"m = {show(ahead.mass, words, 'kg')}",
            late("force-feed-forward"),
        ),
        feedback=feedback,
        encoder=words.name("encoder"),
    )
    return Diagram(key="structure", caption=text("diagram-caption"), alt=alt, svg=svg)


def text_size(text: str, width: float) -> float:
    """Return the font size with which a line fits into a box, the usual one at most."""
    return round(min(SIZE, (width - 2 * MARGIN) / (CHARACTER * max(len(text), 1))), 2)
