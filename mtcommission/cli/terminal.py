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

from mtcommission.machine.machine import Machine
from mtcommission.machine.rigid_body import least_motion_time
from mtcommission.optimal.solution import (
    TIGHT_GAP,
    DampingOptimum,
    TimeOptimum,
    excess_velocity,
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
)
from mtcommission.sheet.format import Formatter, formatter_of
from mtcommission.sheet.labels_en import ENGLISH
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


def describe_machine(machine: Machine, plant: Plant, warnings: Sequence[str]) -> Group:
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
    printed, axis = _formatter(machine), machine.axis_units
    length, force = axis.length.si, axis.force.si
    said = printed.labels.say
    modes = _table(
        "Mode", "Frequency", "Damping ratio", said("Tool per force, static"), "Seen by encoder"
    )
    for mode in plant.modes:
        compliance = mode.tcp_gain / mode.natural_frequency**2
        at_full = printed.quantity(abs(compliance) * machine.drive.motion_force, length)
        modes.add_row(
            mode.name,
            printed.quantity(mode.frequency_hz, "Hz"),
            printed.number(mode.damping_ratio, digits=3),
            f"{at_full} at F_max",
            "yes" if mode.measured_gain else "no",
        )
    limits = _table("Rigid-body limit", "Value", "Reason")
    a = machine.drive.motion_force / plant.moving_mass
    mass = printed.quantity(plant.moving_mass, axis.mass.si)
    limits.add_row(
        "acceleration",
        printed.quantity(a, f"{length}/s^2"),
        f"{printed.quantity(machine.drive.motion_force, force)} on {mass}",
    )
    for number, move in enumerate(machine.moves, start=1):
        limits.add_row(
            f"time of move {number}",
            printed.quantity(least_motion_time(move, a), "s"),
            "at this acceleration, no jerk limit, no vibration: no control is faster",
        )
    rank = kalman_rank(plant)
    parts: list[RenderableType] = [
        _heading(f"{machine.name}, axis {machine.axis}"),
        Text(f"Source of the data: {machine.source}"),
        modes,
        limits,
        Text(f"Controllable: Kalman rank {rank} of {plant.order} states."),
    ]
    parts += _warnings(printed, warnings)
    if not warnings:
        parts.append(Text("No warnings."))
    return Group(*parts)


def describe_optimum(
    machine: Machine, plant: Plant, solution: TimeOptimum | DampingOptimum, *, origin: str = ""
) -> Group:
    """Return arcs, peaks and proof of an optimal control; ``origin`` tells what chose its t_f."""
    printed = _formatter(machine)
    arcs = _table("Arc", "From", "To", "F_set")
    # Interior control is kept in many short pieces; to the reader they are one arc.
    joined = [tuple(run) for _, run in groupby(solution.arcs, key=lambda arc: arc.control)]
    for number, run in enumerate(joined[:SHOWN_ARCS], start=1):
        start, end = 1e3 * run[0].t_start, 1e3 * run[-1].t_end
        arcs.add_row(str(number), f"{start:.6f} ms", f"{end:.6f} ms", run[0].control)
    if len(joined) > SHOWN_ARCS:
        arcs.add_row("...", f"{len(joined) - SHOWN_ARCS} more:", "see --json", "")
    peaks = _table("State or output", "Peak", "Terminal error")
    errors = dict(zip(plant.states, solution.terminal_error.tolist(), strict=True))
    for name, unit, peak in zip(
        plant.signals, plant.signal_units, solution.peaks.tolist(), strict=True
    ):
        error = f"{errors[name]:.1e} {unit}" if name in errors else ""
        peaks.add_row(name, printed.quantity(peak, unit), error)
    lines = [
        f"t_f = {1e3 * solution.t_f:.6f} ms at F_max = {solution.force_limit:g} "
        f"{machine.axis_units.force.si}, method {solution.method}"
    ]
    lines += _limit_lines(plant, solution, printed)
    if isinstance(solution, TimeOptimum):
        proof = solution.certificate
        lines.append(
            "A grid proves no lower bound of t_f; --method exact does."
            if isnan(proof.relative_gap)
            else f"No control is faster than {1e3 * proof.t_f_lower_bound:.6f} ms "
            f"(relative gap {proof.relative_gap:.1e})."
        )
        lines.append(_law_line(solution))
        if proof.relative_gap > TIGHT_GAP:
            slower = 100.0 * proof.relative_gap
            lines.append(
                f"At most {slower:.1g} % slower than the optimum; exact arcs were not found."
            )
        lines += _touch_lines(solution)
    else:
        lines += _damping_lines(machine, plant, solution, origin)
    kind = "Time-optimal" if isinstance(solution, TimeOptimum) else "Damping-optimal"
    return Group(_heading(f"{kind} control"), *map(Text, lines), arcs, peaks)


def _law_line(solution: TimeOptimum) -> str:
    """Return whether the force switches with the adjoint, or why that is not to be seen."""
    law = "Switching law F_set = -sign(lambda_F) F_max"
    if solution.certificate.switching_law_holds:
        held = any(arc.control.startswith("boundary:") for arc in solution.arcs)
        where = " within a step of the grid" if solution.method == "transcription" else ""
        return f"{law}: holds{where}{' off the boundary arcs' if held else ''}."
    loose = sum(arc.t_end - arc.t_start for arc in solution.arcs if arc.control == "interior")
    if solution.method != "exact" or not loose:
        return f"{law}: DOES NOT HOLD."
    share = 100.0 * loose / solution.t_f
    return (
        f'{law}: kept to one cell of a mesh. Arcs named "interior" ({share:.2g} % of t_f) stand for'
        " switches and touch points too close to be told apart; the proof of t_f does not rest on"
        " them. What the force does there is in --csv."
    )


def _damping_lines(
    machine: Machine, plant: Plant, solution: DampingOptimum, origin: str
) -> list[str]:
    """Return cost and weights with their units and where they come from."""
    force = _squared(machine.axis_units.force.si)
    weights = [
        f"{item.state} {item.value:.5g} {force}/{_squared(plant.unit(item.state))}"
        for item in solution.weights
    ]
    chosen = "from the profile" if machine.damping_optimal.weights else "balanced"
    law = f"law (16) kept to {solution.law_residual:.1e} F_max."
    return [
        *([f"t_f is {origin}."] if origin else []),
        *_velocity_lines(plant, solution),
        f"Cost {solution.cost:.9g} {force} s; {law}",
        f"Weights, {chosen}: {', '.join(weights)}",
    ]


def _velocity_lines(plant: Plant, solution: DampingOptimum) -> list[str]:
    """Return by how much the move's max_velocity, which the functional knows not, is exceeded."""
    excess = excess_velocity(plant, solution)
    if not excess:
        return []
    name = plant.states[plant.velocity]
    return [
        f"max_velocity is no part of this optimum: |{name}| exceeds it by {100.0 * excess:.2g} %;"
        f" --limit {name}=... with --method transcription keeps it."
    ]


def _squared(unit: str) -> str:
    return f"({unit})^2" if set(unit) & set(" /^") else f"{unit}^2"


def _limit_lines(
    plant: Plant, solution: TimeOptimum | DampingOptimum, printed: Formatter
) -> list[str]:
    """Return the limits and whether they act."""
    peaks = dict(zip(plant.signals, solution.peaks.tolist(), strict=True))
    lines = []
    for bound in solution.bounds:
        share = peaks[bound.name] / bound.value - 1.0
        acts = "reached" if share > -REACHED else "not reached"
        if share > EXCEEDED:
            acts = f"exceeded by {100.0 * share:.1g} % between the points of the grid"
        value = printed.quantity(bound.value, plant.unit(bound.name))
        lines.append(f"Limit |{bound.name}| <= {value}: {acts}.")
    return lines


def _touch_lines(solution: TimeOptimum) -> list[str]:
    """Return the first touch points, and how many there are more."""
    touches = solution.touch_points
    lines = [f"{p.limit} touched at {1e3 * p.t:.4f} ms" for p in touches[:SHOWN_TOUCHES]]
    if len(touches) > SHOWN_TOUCHES:
        lines.append(f"... and {len(touches) - SHOWN_TOUCHES} touch points more: see --json")
    return lines


def describe_limits(
    machine: Machine, part: LimitsPart, *, met: bool, warnings: Sequence[str]
) -> Group:
    """Return the recommendation, the optima's bounds, the rules of thumb, and the warnings."""
    printed, length = _formatter(machine), machine.axis_units.length.si
    said, best = printed.labels.say, part["recommended"]
    table = _table("Limits", "a", "j", "Settling", "Residual", "Peak", "Met")
    entries: list[tuple[str, LimitsEntry | ModeLimitsEntry | Alternative | RuleResult, bool]]
    entries = [("recommended", best, met)]
    for mode in part["modes"]:
        name = f"{mode['name']} ({printed.quantity(mode['band'], length)})"
        entries.append((name, mode, mode["meets_requirements"]))
    for other in (*part["alternatives"], *part["rules"]):
        entries.append((other["name"], other, other["meets_requirements"]))
    for name, entry, keeps in entries:
        table.add_row(
            escape(name),
            printed.quantity(entry["acceleration"], f"{length}/s^2"),
            printed.quantity(entry["jerk"], f"{length}/s^3"),
            printed.quantity(entry["settling_time"], "s", missing="not settled"),
            printed.quantity(entry["residual_deviation"], length, missing="not settled"),
            printed.quantity(entry["peak_deviation"], length),
            "yes" if keeps else "no",
        )
    rule = part["rule"]
    return Group(
        _heading("Limits"),
        Text(f"Bound by: {said(best['bound_by'])}."),
        table,
        Text(
            f"By hand, with the commissioning rule ({rule['chosen']}): "
            f"a = {printed.quantity(rule['acceleration'], f'{length}/s^2')}, "
            f"j = {printed.quantity(rule['jerk'], f'{length}/s^3')}."
        ),
        *(
            Text(_hold_sentence(item, printed, length))
            for item in part["move_sizes"]
            if item["way"] == "recommended"
        ),
        *(
            Text(
                f"In the way: {said(name_obstacle(item))}; instead of "
                f"{printed.quantity(item['limit'], item['unit'])} could be met: "
                f"{printed.quantity(item['value'], item['unit'])}."
            )
            for item in part["attainable"]
        ),
        *_warnings(printed, warnings),
    )


def _hold_sentence(item: MoveSizesEntry, printed: Formatter, length: str) -> str:
    """Between which sizes of a move the recommendation keeps the band."""
    is_step = "velocity_step" in item["move"]
    unit, kind = (f"{length}/s", "velocity steps") if is_step else (length, "distances")
    reached = printed.quantity(item["full_from"], unit, missing="no size")
    if item["kept_from"] is None:
        return (
            f"With {kind} of {printed.quantity(item['own'], unit)} the recommended limits leave "
            "more than the permitted deviation."
        )
    return (
        f"The recommended limits stay within the permitted deviation for {kind} from "
        f"{printed.quantity(item['kept_from'], unit)} to "
        f"{printed.quantity(item['kept_to'], unit)}; the acceleration limit is reached from "
        f"{reached} on."
    )


def describe_simulation(machine: Machine, part: SimulationPart) -> Group:
    """Return the worst response of each move and the verdict."""
    printed, axis = _formatter(machine), machine.axis_units
    mass, length, force = axis.mass.si, axis.length.si, axis.force.si
    table = _table("Move", "Corner", "Settling", "Residual", "Peak", "F_set")
    for number, move in enumerate(part["moves"], start=1):
        for index, response in enumerate(move["corners"]):
            corner = (
                "nominal"
                if index == 0
                else f"{printed.quantity(response['payload'], mass)}, "
                f"f x {response['frequency_factor']:g}, zeta x {response['damping_factor']:g}"
            )
            wanted = printed.quantity(response["max_force"], force)
            table.add_row(
                str(number),
                corner,
                printed.quantity(response["settling_time"], "s", missing="not settled"),
                printed.quantity(response["residual_deviation"], length, missing="not settled"),
                printed.quantity(response["peak_deviation"], length),
                f"{wanted} saturated" if response["saturated"] else wanted,
            )
    verdict = _verdict(printed, part["assessment"])
    warnings = _warnings(printed, part["warnings"])
    return Group(_heading("Response of the loop"), table, *verdict, *warnings)


def _verdict(printed: Formatter, assessment: AssessmentPart) -> list[RenderableType]:
    said, lines = printed.labels.say, list[RenderableType]()
    for check in assessment["checks"]:
        value = printed.quantity(check["value"], check["unit"], missing="not settled")
        limit = printed.quantity(check["limit"], check["unit"])
        word, style = ("met", "green") if check["met"] else ("NOT MET", "red")
        lines.append(
            Text(
                f"{word}: {said(check['name'])} {value}, allowed {limit} ({said(check['where'])})",
                style=style,
            )
        )
    return lines


def _warnings(printed: Formatter, warnings: Sequence[str]) -> list[Text]:
    return [Text(f"Warning: {printed.labels.say(line)}", style="yellow") for line in warnings]


def _heading(text: str) -> Text:
    return Text(text, style="bold")


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for column in columns:
        table.add_column(column, overflow="fold")
    return table


def _formatter(machine: Machine) -> Formatter:
    return formatter_of(machine.motion.value, ENGLISH)
