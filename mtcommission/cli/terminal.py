"""Results -> what a terminal of 80 columns shows; plain text when piped.

Every number is formatted by the sheet's formatter, so terminal, HTML and PDF agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from math import isnan

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mtcommission.cli.language import words
from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import Message
from mtcommission.optimal.solution import (
    TIGHT_GAP,
    Boundary,
    DampingOptimum,
    Interior,
    TimeOptimum,
    control_text,
    excess_velocity,
    side_text,
)
from mtcommission.plant.plant import Plant, kalman_rank
from mtcommission.record.schema import (
    Alternative,
    AssessmentPart,
    LimitsEntry,
    LimitsPart,
    ModeLimitsEntry,
    MoveSizesEntry,
    RuleResult,
    SimulationPart,
    Words,
)
from mtcommission.sheet.limits_part import name_obstacle

WIDTH = 80

SHOWN_ARCS = 24
"""Arcs printed; a transcription has hundreds."""
SHOWN_TOUCHES = 8
"""Touch points printed; a control on a mesh has hundreds."""
REACHED = 1e-6
"""Relative distance of a peak from its limit within which the limit acts."""
EXCEEDED = 1e-6
"""Relative excess over a limit that is told: a grid keeps it at its points only."""


def show(content: RenderableType) -> None:
    """Print to standard output: styled on a terminal, plain when piped."""
    console = Console(highlight=False, emoji=False)
    if not console.is_terminal:
        console = Console(highlight=False, emoji=False, width=WIDTH, no_color=True)
    console.print(content)


def describe_machine(machine: Machine, plant: Plant, warnings: Sequence[Words]) -> Group:
    """Return modes, rigid-body limits and warnings of a profile.

    Parameters
    ----------
    machine, plant
        Nominal.
    warnings
        From the plausibility check.

    Returns
    -------
    Group
    """
    spoken, axis = _words(machine), machine.axis_units
    printed, length, force = spoken.format, axis.length.si, axis.force.si
    modes = _table(spoken, "mode", "frequency", "damping-ratio", "tool-per-force", "seen")
    for mode in plant.modes:
        compliance = mode.tcp_gain / mode.natural_frequency**2
        at_full = printed.quantity(abs(compliance) * machine.drive.motion_force, length)
        modes.add_row(
            mode.name,
            printed.quantity(mode.frequency_hz, "Hz"),
            printed.number(mode.damping_ratio, digits=3),
            spoken.text("terminal-at-full-force", value=at_full),
            spoken.text("terminal-yes" if mode.measured_gain else "terminal-no"),
        )
    limits = _table(spoken, "rigid-body-limit", "value", "reason")
    a = machine.drive.motion_force / plant.moving_mass
    mass = printed.quantity(plant.moving_mass, axis.mass.si)
    limits.add_row(
        spoken.text("terminal-acceleration"),
        printed.quantity(a, f"{length}/s^2"),
        spoken.text(
            "terminal-force-on-mass",
            force=printed.quantity(machine.drive.motion_force, force),
            mass=mass,
        ),
    )
    for number, move in enumerate(machine.moves, start=1):
        limits.add_row(
            spoken.text("terminal-time-of-move", number=number),
            printed.quantity(least_motion_time(move, a), "s"),
            spoken.text("terminal-rigid-time"),
        )
    rank = kalman_rank(plant)
    parts: list[RenderableType] = [
        _heading(spoken.text("terminal-machine", name=machine.name, axis_name=machine.axis)),
        Text(spoken.text("terminal-source", source=machine.source)),
        modes,
        limits,
        Text(spoken.text("terminal-controllable", rank=rank, order=plant.order)),
    ]
    parts += _warnings(spoken, warnings)
    if not warnings:
        parts.append(Text(spoken.text("terminal-no-warnings")))
    return Group(*parts)


def describe_optimum(
    machine: Machine,
    plant: Plant,
    solution: TimeOptimum | DampingOptimum,
    *,
    origin: Message | None = None,
) -> Group:
    """Return arcs, peaks and proof of an optimal control; ``origin`` tells what chose its t_f."""
    spoken = _words(machine)
    arcs = _table(spoken, "arc", "from", "to", "set-force")
    # Interior control is kept in many short pieces; to the reader they are one arc.
    joined = [tuple(run) for _, run in groupby(solution.arcs, key=lambda arc: arc.control)]
    for number, run in enumerate(joined[:SHOWN_ARCS], start=1):
        start, end = _ms(spoken, run[0].t_start), _ms(spoken, run[-1].t_end)
        arcs.add_row(str(number), start, end, control_text(run[0].control))
    if len(joined) > SHOWN_ARCS:
        more = spoken.text("terminal-more-arcs", count=len(joined) - SHOWN_ARCS)
        arcs.add_row("...", more, spoken.text("terminal-see-json"), "")
    peaks = _table(spoken, "signal", "peak", "terminal-error")
    errors = dict(zip(plant.states, solution.terminal_error.tolist(), strict=True))
    for name, unit, peak in zip(
        plant.signals, plant.signal_units, solution.peaks.tolist(), strict=True
    ):
        error = f"{spoken.format.plain(errors[name], 1, 'e')} {unit}" if name in errors else ""
        peaks.add_row(name, spoken.format.quantity(peak, unit), error)
    first = Message(
        "terminal-final-time",
        t_f=_ms(spoken, solution.t_f),
        force=solution.force_limit,
        unit=machine.axis_units.force.si,
        method=solution.method,
    )
    lines = [first, *_limit_lines(plant, solution, spoken)]
    if isinstance(solution, TimeOptimum):
        proof = solution.certificate
        bound = _ms(spoken, proof.t_f_lower_bound)
        lines += [
            Message("terminal-grid-proves-nothing")
            if isnan(proof.relative_gap)
            else Message("terminal-lower-bound", bound=bound, gap=proof.relative_gap),
            _law_line(solution),
        ]
        if proof.relative_gap > TIGHT_GAP:
            lines.append(Message("terminal-loose-proof", percent=100.0 * proof.relative_gap))
        lines += _touch_lines(solution)
    else:
        lines += _damping_lines(machine, plant, solution, origin)
    kind = "time" if isinstance(solution, TimeOptimum) else "damping"
    title = _heading(spoken.text(f"terminal-{kind}-optimal"))
    return Group(title, *(Text(spoken.say(line)) for line in lines), arcs, peaks)


def _ms(spoken: Catalogue, seconds: float) -> str:
    return f"{spoken.format.plain(1e3 * seconds, 6, 'f')} ms"


def _law_line(solution: TimeOptimum) -> Message:
    """Return whether the force switches with the adjoint, or why that is not to be seen."""
    if solution.certificate.switching_law_holds:
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
    machine: Machine, plant: Plant, solution: DampingOptimum, origin: Message | None
) -> list[Message]:
    """Return cost and weights with their units and where they come from."""
    force = _squared(machine.axis_units.force.si)
    weights = tuple(
        Message(
            "terminal-weight",
            state=item.state,
            value=item.value,
            unit=f"{force}/{_squared(plant.unit(item.state))}",
        )
        for item in solution.weights
    )
    chosen = "stated" if machine.damping_optimal.weights else "balanced"
    cost, residual = solution.cost, solution.law_residual
    return [
        *([Message("terminal-origin-of-final-time", origin=origin)] if origin else []),
        *_velocity_lines(plant, solution),
        Message("terminal-cost", cost=cost, unit=f"{force} s", residual=residual),
        Message("terminal-weights", chosen=chosen, weights=weights),
    ]


def _velocity_lines(plant: Plant, solution: DampingOptimum) -> list[Message]:
    """Return by how much the move's max_velocity, which the functional knows not, is exceeded."""
    excess = excess_velocity(plant, solution)
    if not excess:
        return []
    name = plant.states[plant.velocity]
    return [Message("terminal-velocity-exceeded", name=name, percent=100.0 * excess)]


def _squared(unit: str) -> str:
    return f"({unit})^2" if set(unit) & set(" /^") else f"{unit}^2"


def _limit_lines(
    plant: Plant, solution: TimeOptimum | DampingOptimum, spoken: Catalogue
) -> list[Message]:
    """Return the limits and whether they act."""
    peaks = dict(zip(plant.signals, solution.peaks.tolist(), strict=True))
    lines = []
    for bound in solution.bounds:
        share = peaks[bound.name] / bound.value - 1.0
        acts = Message("terminal-reached" if share > -REACHED else "terminal-not-reached")
        if share > EXCEEDED:
            acts = Message("terminal-exceeded", percent=100.0 * share)
        value = spoken.format.quantity(bound.value, plant.unit(bound.name))
        lines.append(Message("terminal-limit", name=bound.name, value=value, acts=acts))
    return lines


def _touch_lines(solution: TimeOptimum) -> list[Message]:
    """Return the first touch points, and how many there are more."""
    touches = solution.touch_points
    lines = [
        Message("terminal-touched", limit=side_text(p.signal, p.side), ms=1e3 * p.t)
        for p in touches[:SHOWN_TOUCHES]
    ]
    if len(touches) > SHOWN_TOUCHES:
        lines.append(Message("terminal-more-touches", count=len(touches) - SHOWN_TOUCHES))
    return lines


def describe_limits(
    machine: Machine, part: LimitsPart, *, met: bool, warnings: Sequence[Words]
) -> Group:
    """Return the recommendation, the optima's bounds, the rules of thumb, and the warnings."""
    spoken, length = _words(machine), machine.axis_units.length.si
    printed, said, best = spoken.format, spoken.say, part.recommended
    unsettled = spoken.text("terminal-not-settled")
    table = _table(spoken, "limits", "a", "j", "settling", "residual", "peak", "met")
    entries: list[tuple[str, LimitsEntry | ModeLimitsEntry | Alternative | RuleResult, bool]]
    entries = [(spoken.text("terminal-recommended"), best, met)]
    for mode in part.modes:
        name = f"{mode.name} ({printed.quantity(mode.band, length)})"
        entries.append((name, mode, mode.meets_requirements))
    for other in (*part.alternatives, *part.rules):
        entries.append((said(other.name), other, other.meets_requirements))
    for name, entry, keeps in entries:
        table.add_row(
            escape(name),
            printed.quantity(entry.acceleration, f"{length}/s^2"),
            printed.quantity(entry.jerk, f"{length}/s^3"),
            printed.quantity(entry.settling_time, "s", missing=unsettled),
            printed.quantity(entry.residual_deviation, length, missing=unsettled),
            printed.quantity(entry.peak_deviation, length),
            spoken.text("terminal-yes" if keeps else "terminal-no"),
        )
    rule = part.rule
    return Group(
        _heading(spoken.text("terminal-limits")),
        Text(spoken.text("terminal-bound-by", what=said(best.bound_by))),
        table,
        Text(
            spoken.text(
                "terminal-by-hand",
                chosen=said(rule.chosen),
                acceleration=rule.acceleration,
                jerk=rule.jerk,
            )
        ),
        *(
            Text(spoken.say(_hold_sentence(item, spoken, length)))
            for item in part.move_sizes
            if item.way == "recommended"
        ),
        *(
            Text(
                spoken.text(
                    "terminal-in-the-way",
                    obstacle=said(name_obstacle(item)),
                    limit=printed.quantity(item.limit, item.unit),
                    value=printed.quantity(item.value, item.unit),
                )
            )
            for item in part.attainable
        ),
        *_warnings(spoken, warnings),
    )


def _hold_sentence(item: MoveSizesEntry, spoken: Catalogue, length: str) -> Message:
    """Between which sizes of a move the recommendation keeps the band."""
    is_step = "velocity_step" in item.move
    unit, kind = (f"{length}/s", "steps") if is_step else (length, "distances")
    printed = spoken.format
    if item.kept_from is None:
        return Message("terminal-size-missed", sizes=kind, own=printed.quantity(item.own, unit))
    return Message(
        "terminal-sizes-kept",
        sizes=kind,
        least=printed.quantity(item.kept_from, unit),
        largest=printed.quantity(item.kept_to, unit),
        reached=printed.quantity(item.full_from, unit, missing=spoken.text("terminal-no-size")),
    )


def describe_simulation(machine: Machine, part: SimulationPart) -> Group:
    """Return the worst response of each move and the verdict."""
    spoken, axis = _words(machine), machine.axis_units
    printed, unsettled = spoken.format, spoken.text("terminal-not-settled")
    mass, length, force = axis.mass.si, axis.length.si, axis.force.si
    table = _table(spoken, "move", "corner", "settling", "residual", "peak", "set-force")
    for number, move in enumerate(part.moves, start=1):
        for index, response in enumerate(move.corners):
            corner = (
                spoken.text("terminal-nominal")
                if index == 0
                else spoken.text(
                    "terminal-corner",
                    payload=printed.quantity(response.payload, mass),
                    frequency=response.frequency_factor,
                    damping=response.damping_factor,
                )
            )
            wanted = printed.quantity(response.max_force, force)
            table.add_row(
                str(number),
                corner,
                printed.quantity(response.settling_time, "s", missing=unsettled),
                printed.quantity(response.residual_deviation, length, missing=unsettled),
                printed.quantity(response.peak_deviation, length),
                spoken.text("terminal-saturated", force=wanted) if response.saturated else wanted,
            )
    verdict = _verdict(spoken, part.assessment)
    warnings = _warnings(spoken, part.warnings)
    return Group(_heading(spoken.text("terminal-response")), table, *verdict, *warnings)


def _verdict(spoken: Catalogue, assessment: AssessmentPart) -> list[RenderableType]:
    printed, lines = spoken.format, list[RenderableType]()
    unsettled = spoken.text("terminal-not-settled")
    for check in assessment.checks:
        line = spoken.text(
            "terminal-check-met" if check.met else "terminal-check-not-met",
            name=spoken.say(check.name),
            value=printed.quantity(check.value, check.unit, missing=unsettled),
            limit=printed.quantity(check.limit, check.unit),
            where=spoken.say(check.where),
        )
        lines.append(Text(line, style="green" if check.met else "red"))
    return lines


def _warnings(spoken: Catalogue, warnings: Sequence[Words]) -> list[Text]:
    lines = [spoken.text("terminal-warning", warning=spoken.say(line)) for line in warnings]
    return [Text(line, style="yellow") for line in lines]


def _heading(text: str) -> Text:
    return Text(text, style="bold")


def _table(spoken: Catalogue, *columns: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for column in columns:
        table.add_column(spoken.text(f"terminal-head-{column}"), overflow="fold")
    return table


def _words(machine: Machine) -> Catalogue:
    return words(rotary=machine.motion is Motion.ROTARY)
