"""First page: the verdict and the values to enter."""

from __future__ import annotations

from math import inf

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema import Check, Record
from mtcommission.sheet.model import BigValue, Column, Headline, Paragraph, Section, Table, Tone
from mtcommission.sheet.plot_model import LinePlot
from mtcommission.sheet.values import say_requirement, settling


def verdict(record: Record, words: Catalogue, *, picture: LinePlot) -> Section:
    """Return verdict, values to enter, result and checks, with a picture of the first move."""
    text, f, limits = words.text, words.format, record.limits.recommended
    assessment = record.assessment
    detail = text("values-bound-by", bound=words.say(limits.bound_by))
    if assessment.obstacle:
        obstacle = say_requirement(assessment.obstacle, words)
        detail = f"{text('obstacle', obstacle=obstacle)}. {detail}"
    headline = Headline(
        is_met=assessment.met,
        verdict=text("verdict-met") if assessment.met else text("verdict-not-met"),
        detail=detail,
        values=(
            BigValue(label=text("acceleration"), value=acceleration(record, words), aside="a"),
            BigValue(label=text("jerk"), value=jerk(record, words), aside="j"),
            BigValue(
                label=text("jerk-time"),
                value=f.quantity(limits.jerk_time, "s"),
                aside="a / j",
            ),
        ),
    )
    return Section(
        key="verdict",
        heading=text("verdict-heading"),
        blocks=(
            Paragraph(
                text=text("data-source", source=words.say(record.machine.source)),
                tone=Tone.NOTE,
            ),
            headline,
            *_warnings(record, words),
            _result(record, words),
            Paragraph(text=reference_sentence(record, slowest_move(record), words)),
            Paragraph(text=text("reference-note"), tone=Tone.NOTE),
            _checks(assessment.checks, words),
            picture,
        ),
    )


def acceleration(record: Record, words: Catalogue) -> str:
    """Return the recommended acceleration limit with its unit."""
    value = record.limits.recommended.acceleration
    return words.format.axis(value, "m/s^2")


def jerk(record: Record, words: Catalogue) -> str:
    """Return the recommended jerk limit with its unit."""
    value = record.limits.recommended.jerk
    return words.format.axis(value, "m/s^3")


def band(record: Record) -> float | None:
    """Return the permitted TCP deviation [m or rad]; None where the record does not state it."""
    for item in record.data:
        if item.key == "requirements.tcp_deviation" and isinstance(item.value, float | int):
            return float(item.value)
    return None


def move_title(move: dict[str, float], number: int, words: Catalogue) -> str:
    """Return e.g. "Move 1 (velocity step 100 mm/s)"."""
    text, f = words.text, words.format
    if "velocity_step" in move:
        what = text("velocity-step", velocity=f.axis(move["velocity_step"], "m/s"))
    elif move.get("max_velocity") is not None:
        what = text(
            "positioning-limited",
            distance=f.axis(move["distance"], "m"),
            velocity=f.axis(move["max_velocity"], "m/s"),
        )
    else:
        what = text("positioning", distance=f.axis(move["distance"], "m"))
    return f"{text('move', number=number)} ({what})"


def reference_sentence(record: Record, number: int, words: Catalogue) -> str:
    """Return the time-optimal reference of a move beside the recommendation.

    Parameters
    ----------
    record
        The record.
    number
        Which move, counted from 1.
    words
        Of the language and the kind of axis.

    Returns
    -------
    str
    """
    text, f, move = words.text, words.format, record.moves[number - 1]
    title = move_title(move.move, number, words)
    best = record.optima[number - 1].time
    least, bound = best.t_f, getattr(best.certificate, "t_f_lower_bound", None)
    settling, optimal = move.response.settling_time, f.quantity(least, "s")
    bounded = record.optima[number - 1].constrained
    if best.method == "composed" and isinstance(bound, float):
        optimal = text("reference-composed", optimum=optimal, bound=f.quantity(bound, "s"))
    if settling is None:
        return text("reference-unsettled", move=title, optimum=optimal)
    share = settling / least - 1.0
    sentence = text(
        "reference" if share >= 0.0 else "reference-faster",
        move=title,
        optimum=optimal,
        settling=f.quantity(settling, "s"),
        more=f.percent(share),
        less=f.percent(-share),
    )
    if bounded is None:
        return sentence
    held = text(
        "reference-bounded",
        optimum=f.quantity(bounded.t_f, "s"),
        change=f.signed_percent(settling / bounded.t_f - 1.0),
    )
    return f"{sentence} {held}"


def slowest_move(record: Record) -> int:
    """Return the number of the move that settles last, counted from 1."""
    times = [move.response.settling_time for move in record.moves]
    return 1 + max(range(len(times)), key=lambda i: inf if times[i] is None else times[i] or 0.0)


def residual_against_band(record: Record, words: Catalogue) -> str:
    """Return the worst residual deviation as a share of the band."""
    text, f, permitted = words.text, words.format, band(record)
    residual = record.limits.recommended.residual_deviation
    shown = f.axis(permitted, "m")
    if residual is None:
        return text("no-residual", band=shown)
    if permitted is None:
        return f.axis(residual, "m")
    return text(
        "of-band", value=f.axis(residual, "m"), percent=f.percent(residual / permitted), band=shown
    )


def capitalised(words: str) -> str:
    """Return words with a capital at the beginning and the rest as it is."""
    return words[:1].upper() + words[1:]


def _warnings(record: Record, words: Catalogue) -> tuple[Paragraph, ...]:
    """Return the warnings on which the verdict hangs, and how many more there are."""
    text = words.text
    told = (*record.loop.warnings, *record.robustness.warnings)
    lines = [words.say(line) for line in told]
    others = [line for line in record.warnings if line not in told]
    if others:
        lines.append(text("further-warnings" if told else "warning-count", count=len(others)))
    return tuple(Paragraph(text=line, tone=Tone.WARNING) for line in lines)


def _result(record: Record, words: Catalogue) -> Table:
    text, f, limits = words.text, words.format, record.limits.recommended
    return Table(
        caption=text("result-caption"),
        columns=(Column(head=text("quantity")), Column(head=text("value"), width=2.0)),
        rows=(
            (text("settling-time"), settling(limits.settling_time, words)),
            (text("residual"), residual_against_band(record, words)),
            (text("peak-deviation"), f.axis(limits.peak_deviation, "m")),
        ),
    )


def _checks(checks: list[Check], words: Catalogue) -> Table:
    text, f = words.text, words.format
    rows = tuple(
        (
            capitalised(say_requirement(check.name, words)),
            f.quantity(check.value, check.unit, missing=text("not-settled")),
            f.quantity(check.limit, check.unit),
            text("met") if check.met else text("not-met"),
            words.say(check.where),
        )
        for check in checks
    )
    return Table(
        caption=text("checks-caption"),
        columns=(
            Column(head=text("check"), width=1.6),
            Column(head=text("found"), is_number=True),
            Column(head=text("permitted"), is_number=True),
            Column(head=text("verdict"), width=0.8),
            Column(head=text("where"), width=2.0),
        ),
        rows=rows,
        strong_rows=tuple(i for i, check in enumerate(checks) if not check.met),
    )
