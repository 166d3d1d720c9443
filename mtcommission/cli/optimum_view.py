"""An optimal control as the terminal shows it: arcs, peaks, proof."""

from __future__ import annotations

from math import isfinite, isnan

from mtcommission.base.messages.catalogue import NAME, Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.base.messages.quantities import pretty_unit
from mtcommission.cli.terminal import Line, heading, heads, table
from mtcommission.machine.machine import Machine
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant
from mtcommission.optimal.control import (
    TIGHT_GAP,
    AnyOptimum,
    ArcControl,
    Bang,
    Boundary,
    Certificate,
    Interior,
    Law,
    Ramp,
    control_text,
    excess_velocity,
    join_arcs,
)
from mtcommission.sheet.tables import capitalised
from mtcommission.sheet.verdict import move_title, say_move

SHOWN_ARCS = 24
"""Arcs printed; a transcription has hundreds."""
SHOWN_TOUCHES = 8
"""Touch points printed; a control on a mesh has hundreds."""
REACHED = 1e-6
"""Relative distance of a peak from its limit within which the limit acts."""
EXCEEDED = 1e-6
"""Relative excess over a limit that is told: a grid keeps it at its points only."""


def describe_optimum(
    machine: Machine,
    plant: Plant,
    solution: AnyOptimum,
    spoken: Catalogue,
    *,
    origin: Message | None = None,
) -> list[Line]:
    """Return arcs, peaks and proof of an optimal control; ``origin`` tells what chose its t_f."""
    joined = join_arcs(solution.arcs)
    arcs = [
        [str(number), _ms(spoken, arc.t_start), _ms(spoken, arc.t_end),
         _say_control(arc.control, spoken)]
        for number, arc in enumerate(joined[:SHOWN_ARCS], start=1)
    ]  # fmt: skip
    if len(joined) > SHOWN_ARCS:
        more = spoken.text("terminal-more-arcs", count=len(joined) - SHOWN_ARCS)
        arcs.append(["...", more, spoken.text("terminal-see-json"), ""])
    missed = (spoken.format.plain(one, 1, "e") for one in solution.terminal_error.tolist())
    errors = dict(zip(plant.states, missed, strict=True))
    signals = zip(plant.signals, plant.signal_units, solution.peaks.tolist(), strict=True)
    peaks = [
        [spoken.name(name), spoken.format.quantity(peak, unit),
         f"{errors[name]} {pretty_unit(unit)}" if name in errors else ""]
        for name, unit, peak in signals
    ]  # fmt: skip
    first = Message(
        "terminal-final-time",
        move=_say_move(machine, solution.move, spoken),
        t_f=_ms(spoken, solution.t_f),
        force=solution.force_limit,
        unit=pretty_unit(machine.axis_units.force.si),
        method=Message(f"method-{solution.method}"),
    )
    lines = [first, *_limit_lines(plant, solution, spoken)]
    proof = solution.certificate
    if isinstance(proof, Certificate):
        lines += _proof_lines(solution, proof, spoken)
    else:
        lines += _damping_lines(machine, plant, solution, proof, origin)
    return [
        heading(spoken.text(f"terminal-{solution.kind}-optimal")),
        *map(spoken.say, lines),
        *table(heads(spoken, "arc", "from", "to", "word-f-set"), arcs),
        *table(heads(spoken, "signal-head", "peak-deviation", "terminal-error"), peaks),
    ]


def _say_move(machine: Machine, move: Move, spoken: Catalogue) -> str:
    """The move, with its number where it is one of the profile's."""
    if move in machine.moves:
        return move_title(move, machine.moves.index(move) + 1, spoken)
    return capitalised(say_move(move, spoken))


def _proof_lines(solution: AnyOptimum, proof: Certificate, spoken: Catalogue) -> list[Message]:
    least, gap = proof.t_f_lower_bound, proof.relative_gap
    proves_nothing = Message("terminal-grid-proves-nothing")
    bound = Message("terminal-lower-bound", bound=_ms(spoken, least), gap=gap)
    lines = [
        proves_nothing if isnan(gap) else bound,
        _law_line(solution, holds=proof.switching_law_holds),
    ]
    if gap > TIGHT_GAP:
        lines.append(Message("terminal-loose-proof", percent=100.0 * gap))
    return lines + _touch_lines(solution)


def _say_control(control: ArcControl, spoken: Catalogue) -> str:
    match control:
        case Bang() | Ramp():
            text = control_text(control)
            return text.replace("F_max", "a_max") if spoken.follows else text
        case Boundary(signal, side):
            return spoken.say(_limit_of(signal, side))
        case Interior():
            return spoken.text("terminal-arc-interior")


def _limit_of(signal: str, side: int) -> Message:
    which = "upper" if side > 0 else "lower"
    return Message("terminal-arc-boundary", name=Message(NAME, key=signal), side=which)


def _ms(spoken: Catalogue, seconds: float) -> str:
    return f"{spoken.format.plain(1e3 * seconds, 6, 'f')} ms"


def _law_line(solution: AnyOptimum, *, holds: bool) -> Message:
    """Return whether the force switches with the adjoint, or why that is not to be seen."""
    if isfinite(solution.jerk_limit):
        return Message("terminal-jerk-law", holds="yes" if holds else "no")
    if holds:
        held = any(isinstance(arc.control, Boundary) for arc in solution.arcs)
        return Message(
            "terminal-law-holds",
            grid="yes" if solution.method == "transcription" else "no",
            boundary="yes" if held else "no",
        )
    loose = sum(
        arc.t_end - arc.t_start for arc in solution.arcs if isinstance(arc.control, Interior)
    )
    if solution.method != "exact" or not loose:
        return Message("terminal-law-fails")
    return Message("terminal-law-in-cells", percent=100.0 * loose / solution.t_f)


def _damping_lines(
    machine: Machine,
    plant: Plant,
    solution: AnyOptimum,
    law: Law,
    origin: Message | None,
) -> list[Message]:
    """Return cost and weights with their units and where they come from."""
    force = _squared(machine.axis_units.force.si)
    weights = tuple(
        Message(
            "terminal-weight",
            state=Message(NAME, key=item.name),
            value=item.value,
            unit=f"{force}/{_squared(plant.unit(item.name))}",
        )
        for item in solution.weights
    )
    chosen = "stated" if machine.damping_optimal.weights else "balanced"
    cost, residual = solution.cost, law.law_residual
    return [
        *([Message("terminal-origin-of-final-time", origin=origin)] if origin else []),
        *_velocity_lines(plant, solution),
        Message("terminal-cost", cost=cost, unit=f"{force} s", residual=residual),
        Message("terminal-weights", chosen=chosen, weights=weights),
    ]


def _velocity_lines(plant: Plant, solution: AnyOptimum) -> list[Message]:
    """Return by how much the move's max_velocity, which the functional knows not, is exceeded."""
    excess = excess_velocity(plant, solution)
    if not excess:
        return []
    name = plant.states[plant.velocity]
    return [Message("terminal-velocity-exceeded", name=name, percent=100.0 * excess)]


def _squared(unit: str) -> str:
    return pretty_unit(f"({unit})^2" if set(unit) & set(" /^") else f"{unit}^2")


def _limit_lines(plant: Plant, solution: AnyOptimum, spoken: Catalogue) -> list[Message]:
    peaks = dict(zip(plant.signals, solution.peaks.tolist(), strict=True))
    lines = []
    for bound in solution.bounds:
        share = peaks[bound.name] / bound.value - 1.0
        acts = Message("terminal-reached" if share > -REACHED else "terminal-not-reached")
        if share > EXCEEDED:
            acts = Message("terminal-exceeded", percent=100.0 * share)
        value = spoken.format.quantity(bound.value, plant.unit(bound.name))
        name = Message(NAME, key=bound.name)
        lines.append(Message("terminal-limit", name=name, value=value, acts=acts))
    if isfinite(solution.jerk_limit):
        value = spoken.format.quantity(solution.jerk_limit, plant.jerk_unit)
        acts = Message("terminal-reached")
        lines.append(Message("terminal-limit", name=Message("jerk"), value=value, acts=acts))
    return lines


def _touch_lines(solution: AnyOptimum) -> list[Message]:
    touches = solution.touch_points
    lines = [
        Message("terminal-touched", limit=_limit_of(p.signal, p.side), ms=1e3 * p.t)
        for p in touches[:SHOWN_TOUCHES]
    ]
    if len(touches) > SHOWN_TOUCHES:
        lines.append(Message("terminal-more-touches", count=len(touches) - SHOWN_TOUCHES))
    return lines
