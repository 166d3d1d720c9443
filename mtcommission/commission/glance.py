"""Results at a glance: a line, a small HTML and a plot, for a Python prompt and a notebook."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from io import BytesIO
from math import isfinite
from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message
from mtcommission.limits.judge import Candidate, MoveResult
from mtcommission.machine.checks import say_filter, say_jerk
from mtcommission.machine.machine import NOMINAL, Corner, Machine, Motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Named = tuple[Message, Candidate]
"""Limits and the name under which they are shown."""

HEIGHT, WIDTH = 5.0, 5.5
"""Of the plots of one move [inch]."""


def say_verdict(machine: Machine, best: Candidate, spoken: Catalogue | None = None) -> str:
    """Return one line: the axis, whether the requirements are met, and the limits.

    In English where no other catalogue is given.
    """
    spoken = spoken or _words(machine)
    return spoken.text(
        "glance",
        machine=machine.name,
        axis_name=machine.axis,
        verdict=spoken.text(_verdict(best)),
        acceleration=_acceleration(best, spoken),
        jerk=_jerk(machine, best, spoken),
        filter=_filter(machine, best, spoken),
        settling=_settling(best.settling_time, spoken),
    )


def show_html(machine: Machine, limits: Sequence[Named], figure: Figure) -> str:
    """Return verdict, limits, requirements and a plot as HTML to stand inside a page.

    ``limits``: the recommended ones first, which are judged, then what stands beside them;
    ``figure``: from ``plot_moves``; ``machine``: nominal. The machine's own texts are escaped; the
    plot is a picture inside.
    """
    spoken, best = _words(machine), limits[0][1]
    length = machine.axis_units.length.si
    f, text = spoken.format, spoken.text
    heads = [text("limits-name"), "a", "j", text("setpoint-filter")]
    judged = ("settling-time", "residual", "peak-deviation", "meets")
    heads += [text(f"terminal-head-{key}") for key in judged]
    rows = [
        [
            spoken.say(name),
            _acceleration(item, spoken),
            _jerk(machine, item, spoken),
            _filter(machine, item, spoken),
            _settling(item.settling_time, spoken),
            _settling(item.residual_deviation, spoken, length),
            f.quantity(item.peak_deviation, length),
            text("yes" if item.assessment.is_met else "no"),
        ]
        for name, item in limits
    ]
    checks = [
        [
            spoken.say(check.requirement.message),
            _settling(check.value, spoken, check.unit),
            f.quantity(check.limit, check.unit),
            text("yes" if check.is_met else "no"),
        ]
        for check in best.assessment.checks
    ]
    columns = [text("check"), text("value"), text("permitted")]
    parts = [
        f"<p><b>{escape(machine.name)}, {text('axis')} {escape(machine.axis)}</b><br>"
        f"{escape(text(_verdict(best)))}</p>",
        _table(heads, rows),
        _table([*columns, text("terminal-head-meets")], checks),
        _picture(figure, text("glance-alt")),
    ]
    return "<div>" + "".join(parts) + "</div>"


def plot_moves(
    machine: Machine,
    moves: Sequence[MoveResult],
    corners: Sequence[Corner],
    figure: Figure | None = None,
) -> Figure:
    """Return a figure: deviation at the tool and set force of each move, in every corner.

    ``machine``: nominal; its band and force limit are drawn. ``moves`` are simulated in every
    corner, ``corners`` in the order of the responses. ``figure``: empty, to be drawn into, e.g. one
    of pyplot's; None: a new one that belongs to nobody.
    """
    from matplotlib.figure import Figure

    figure = figure or Figure(figsize=(WIDTH * len(moves), HEIGHT), layout="constrained")
    spoken, axis = _words(machine), machine.axis_units
    band, limit = machine.requirements.tcp_deviation, machine.drive.motion_force
    length = spoken.format.scale(band, axis.length.si)
    force = spoken.format.scale(limit, axis.force.si)
    plots = figure.subplots(2, len(moves), sharex="col", squeeze=False)
    nominal, others = spoken.text("nominal"), spoken.text("glance-corners")
    for number, (move, column) in enumerate(zip(moves, plots.T, strict=True), start=1):
        upper, lower = column
        for corner, response in reversed(list(zip(corners, move.responses, strict=True))):
            is_nominal = corner == NOMINAL
            line = {
                "color": "black" if is_nominal else "tab:blue",
                "linewidth": 1.4 if is_nominal else 0.6,
                # Each name once: the last corner is drawn first.
                "label": nominal if is_nominal else others if corner is corners[-1] else None,
            }
            upper.plot(1e3 * response.t, response.deviation / length.size, **line)
            lower.plot(1e3 * response.t, response.force / force.size, **line)
        for plot, border in ((upper, band / length.size), (lower, limit / force.size)):
            plot.axhline(border, color="tab:red", linestyle="--", label=spoken.text("permitted"))
            plot.axhline(-border, color="tab:red", linestyle="--")
            plot.grid(linewidth=0.3)
        begin = max(response.t_end for response in move.responses)
        upper.axvline(
            1e3 * begin, color="tab:green", linestyle=":", label=spoken.text("glance-end")
        )
        ends = [response.settling_time for response in move.responses]
        upper.set_xlim(0.0, 1.3e3 * max([begin, *filter(isfinite, ends)]))
        upper.set_title(spoken.text("move", number=number), loc="left")
        lower.set_xlabel(spoken.text("glance-time"))
    plots[0, 0].set_ylabel(spoken.text("glance-deviation", unit=length.unit))
    plots[1, 0].set_ylabel(spoken.text("glance-force", unit=force.unit))
    plots[0, 0].legend(loc="upper right", fontsize="small")
    return figure


def _words(machine: Machine) -> Catalogue:
    return Catalogue("en", rotary=machine.motion is Motion.ROTARY)


def _verdict(best: Candidate) -> str:
    return "verdict-met" if best.assessment.is_met else "verdict-not-met"


def _acceleration(item: Candidate, spoken: Catalogue) -> str:
    return spoken.format.axis(item.limits.acceleration, "m/s^2")


def _jerk(machine: Machine, item: Candidate, spoken: Catalogue) -> str:
    limits, shortest = item.limits, machine.control.shortest_ramp
    return say_jerk(limits.acceleration, limits.jerk, shortest, spoken)


def _filter(machine: Machine, item: Candidate, spoken: Catalogue) -> str:
    return say_filter(item.limits.setpoint_filter or machine.control.setpoint_filter, spoken)


def _settling(value: float, spoken: Catalogue, unit: str = "s") -> str:
    return spoken.format.quantity(value, unit, missing=spoken.text("not-settled"))


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return "<table>" + row(heads, "th") + "".join(row(cells, "td") for cells in rows) + "</table>"


def _picture(figure: Figure, alternative: str) -> str:
    """A plot inside the page; as pixels, since as SVG it holds each of ten thousand points."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=80)
    data = b64encode(buffer.getvalue()).decode()
    return f'<img alt="{escape(alternative)}" src="data:image/png;base64,{data}">'
