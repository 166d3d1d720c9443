"""First page: the verdict and the values to enter."""

from __future__ import annotations

from math import inf

from mtcommission.record.schema import Check, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.model import BigValue, Column, Headline, Paragraph, Section, Table, Tone
from mtcommission.sheet.plot_model import LinePlot


def verdict(record: Record, f: Formatter, *, picture: LinePlot) -> Section:
    """Return verdict, values to enter, result and checks, with a picture of the first move."""
    text, limits = f.labels, record.limits.recommended
    assessment = record.assessment
    detail = text.values_bound_by.format(bound=text.say(limits.bound_by))
    if assessment.obstacle:
        detail = f"{text.obstacle.format(obstacle=text.say(assessment.obstacle))}. {detail}"
    headline = Headline(
        is_met=assessment.met,
        verdict=text.verdict_met if assessment.met else text.verdict_not_met,
        detail=detail,
        values=(
            BigValue(label=text.acceleration, value=acceleration(record, f), aside="a"),
            BigValue(label=text.jerk, value=jerk(record, f), aside="j"),
            BigValue(
                label=text.jerk_time,
                value=f.quantity(limits.jerk_time, "s"),
                aside="a / j",
            ),
        ),
    )
    return Section(
        key="verdict",
        heading=text.verdict_heading,
        blocks=(
            Paragraph(
                text=text.data_source.format(source=text.say_if_known(record.machine.source)),
                tone=Tone.NOTE,
            ),
            headline,
            *_warnings(record, f),
            _result(record, f),
            Paragraph(text=reference_sentence(record, slowest_move(record), f)),
            Paragraph(text=text.reference_note, tone=Tone.NOTE),
            _checks(assessment.checks, f),
            picture,
        ),
    )


def acceleration(record: Record, f: Formatter) -> str:
    """Return the recommended acceleration limit with its unit."""
    value = record.limits.recommended.acceleration
    return f.quantity(value, motion_unit("m/s^2", rotary=f.rotary))


def jerk(record: Record, f: Formatter) -> str:
    """Return the recommended jerk limit with its unit."""
    value = record.limits.recommended.jerk
    return f.quantity(value, motion_unit("m/s^3", rotary=f.rotary))


def band(record: Record) -> float | None:
    """Return the permitted TCP deviation [m or rad]; None where the record does not state it."""
    for item in record.data:
        if item.key == "requirements.tcp_deviation" and isinstance(item.value, float | int):
            return float(item.value)
    return None


def move_title(move: dict[str, float], number: int, f: Formatter) -> str:
    """Return e.g. "Move 1 (velocity step 100 mm/s)"."""
    text = f.labels
    length = motion_unit("m", rotary=f.rotary)
    if "velocity_step" in move:
        what = text.velocity_step.format(velocity=f.quantity(move["velocity_step"], f"{length}/s"))
    elif move.get("max_velocity") is not None:
        what = text.positioning_limited.format(
            distance=f.quantity(move["distance"], length),
            velocity=f.quantity(move["max_velocity"], f"{length}/s"),
        )
    else:
        what = text.positioning.format(distance=f.quantity(move["distance"], length))
    return f"{text.move.format(number=number)} ({what})"


def reference_sentence(record: Record, number: int, f: Formatter) -> str:
    """Return the time-optimal reference of a move beside the recommendation.

    Parameters
    ----------
    record
        The record.
    number
        Which move, counted from 1.
    f
        Formatter.

    Returns
    -------
    str
    """
    text, move = f.labels, record.moves[number - 1]
    title = move_title(move.move, number, f)
    best = record.optima[number - 1].time
    least, bound = best.t_f, getattr(best.certificate, "t_f_lower_bound", None)
    settling, optimal = move.response.settling_time, f.quantity(least, "s")
    bounded = record.optima[number - 1].constrained
    if best.method == "composed" and isinstance(bound, float):
        optimal = text.reference_composed.format(optimum=optimal, bound=f.quantity(bound, "s"))
    if settling is None:
        return text.reference_unsettled.format(move=title, optimum=optimal)
    share = settling / least - 1.0
    form = text.reference if share >= 0.0 else text.reference_faster
    sentence = form.format(
        move=title,
        optimum=optimal,
        settling=f.quantity(settling, "s"),
        more=f.percent(share),
        less=f.percent(-share),
    )
    if bounded is None:
        return sentence
    held = text.reference_bounded.format(
        optimum=f.quantity(bounded.t_f, "s"),
        change=f.signed_percent(settling / bounded.t_f - 1.0),
    )
    return f"{sentence} {held}"


def slowest_move(record: Record) -> int:
    """Return the number of the move that settles last, counted from 1."""
    times = [move.response.settling_time for move in record.moves]
    return 1 + max(range(len(times)), key=lambda i: inf if times[i] is None else times[i] or 0.0)


def residual_against_band(record: Record, f: Formatter) -> str:
    """Return the worst residual deviation as a share of the band."""
    text, permitted = f.labels, band(record)
    residual = record.limits.recommended.residual_deviation
    length = motion_unit("m", rotary=f.rotary)
    shown = f.quantity(permitted, length)
    if residual is None:
        return text.no_residual.format(band=shown)
    if permitted is None:
        return f.quantity(residual, length)
    return text.of_band.format(
        value=f.quantity(residual, length), percent=f.percent(residual / permitted), band=shown
    )


def capitalised(words: str) -> str:
    """Return words with a capital at the beginning and the rest as it is."""
    return words[:1].upper() + words[1:]


def _warnings(record: Record, f: Formatter) -> tuple[Paragraph, ...]:
    """Return the warnings on which the verdict hangs, and how many more there are."""
    text = f.labels
    told = (*record.loop.warnings, *record.robustness.warnings)
    lines = [text.say(line) for line in told]
    others = [line for line in record.warnings if line not in told]
    if others:
        form = text.further_warnings if told else text.warning_count
        lines.append(form.format(count=len(others)))
    return tuple(Paragraph(text=line, tone=Tone.WARNING) for line in lines)


def _result(record: Record, f: Formatter) -> Table:
    text, limits = f.labels, record.limits.recommended
    length = motion_unit("m", rotary=f.rotary)
    return Table(
        caption=text.result_caption,
        columns=(Column(head=text.quantity), Column(head=text.value, width=2.0)),
        rows=(
            (text.settling_time, f.settling(limits.settling_time)),
            (text.residual, residual_against_band(record, f)),
            (text.peak_deviation, f.quantity(limits.peak_deviation, length)),
        ),
    )


def _checks(checks: list[Check], f: Formatter) -> Table:
    text = f.labels
    rows = tuple(
        (
            capitalised(text.say(check.name)),
            f.quantity(check.value, check.unit, missing=text.not_settled),
            f.quantity(check.limit, check.unit),
            text.met if check.met else text.not_met,
            text.say(check.where),
        )
        for check in checks
    )
    return Table(
        caption=text.checks_caption,
        columns=(
            Column(head=text.check, width=1.6),
            Column(head=text.found, is_number=True),
            Column(head=text.permitted, is_number=True),
            Column(head=text.verdict, width=0.8),
            Column(head=text.where, width=2.0),
        ),
        rows=rows,
        strong_rows=tuple(i for i, check in enumerate(checks) if not check.met),
    )
