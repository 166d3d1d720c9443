"""The verdict: met or not, the limits large, the requirements one by one."""

from __future__ import annotations

from math import inf

from mtcommission.messages.catalogue import Catalogue
from mtcommission.messages.message import parts_of
from mtcommission.record.schema.limits import LimitsEntry, TodayEntry
from mtcommission.record.schema.moves import Check
from mtcommission.record.schema.optima import BandEntry, RobustEntry
from mtcommission.record.schema.record import Record
from mtcommission.requirements.register import REGISTER
from mtcommission.requirements.requirement import Requirement
from mtcommission.sheet.basis_part import is_assumed
from mtcommission.sheet.model import BigValue, Column, Headline, Paragraph, Table, Tone
from mtcommission.sheet.values import filter_rows, residual, say_limiting, say_requirement, settling

CONTOUR = "requirements.contour_deviation"

ROUNDING = 1e-6
"""Relative difference that search and check may have where the reserve is just kept."""


def headline(record: Record, words: Catalogue) -> Headline:
    """Return the verdict with the limits to enter and what they give."""
    text, limits = words.text, record.limits.recommended
    assessment = record.assessment
    told = now_and_then(record, words) or [
        text(
            "what-they-give",
            settling=settling(limits.settling_time, words),
            residual=residual(limits.residual_deviation, words),
        )
    ]
    if assessment.obstacle:
        obstacle = say_requirement(assessment.obstacle, words)
        told.append(f"{text('obstacle', obstacle=obstacle)}.")
    told.append(f"{text('values-bound-by', bound=words.say(limits.bound_by))}.")
    told += assumed_and_binding(record, words)
    told += attainable_sentences(record, words)
    return Headline(
        is_met=assessment.met,
        verdict=text("verdict-met") if assessment.met else text("verdict-not-met"),
        detail=" ".join(told),
        values=(
            BigValue(label=text("acceleration"), value=acceleration(record, words), aside="a"),
            BigValue(label=text("jerk"), value=jerk(record, words), aside="j"),
            *_jerk_time(record, words),
            *_setpoint_filter(record, words),
        ),
    )


def assumed_and_binding(record: Record, words: Catalogue) -> list[str]:
    """Return which assumed values bind, and what others would give, as sentences."""
    found, binding = list[str](), parts_of(record.limits.recommended.bound_by)
    for requirement in REGISTER:
        if not isinstance(requirement, Requirement) or requirement.message not in binding:
            continue
        begin, name = requirement.rests_on
        keys = [item.key for item in record.data if begin and item.key.startswith(begin)]
        keys = [one for one in keys if one.endswith(name) and is_assumed(record, one)]
        if keys:
            named = words.text("assumed-binds", keys=", ".join(keys))
            found.append(f"{named}{_with_another(record, name, words)}")
    return found


def _with_another(record: Record, name: str, words: Catalogue) -> str:
    """What another value would give, where that was computed."""
    for item in record.limits.would_bring:
        if item.name == name and item.meets_requirements and item.saved and item.saved > 0.0:
            accelerations = [part.values.get("acceleration") for part in parts_of(item.change)]
            given = [words.format.axis(a, "m/s^2") for a in accelerations if isinstance(a, float)]
            given.append(settling(item.settling_time, words))
            said = words.say(item.change)
            return words.text("another-gives", change=said, given=", ".join(given))
    return words.text("another-unknown")


def acceleration(record: Record, words: Catalogue) -> str:
    """Return the recommended acceleration limit with its unit."""
    value = record.limits.recommended.acceleration
    return words.format.axis(value, "m/s^2")


def jerk(record: Record, words: Catalogue) -> str:
    """Return the recommended jerk limit with its unit."""
    value = record.limits.recommended.jerk if record.loop.jerk != "none" else None
    return words.format.axis(value, "m/s^3", missing=words.text("no-jerk-limit"))


def _jerk_time(record: Record, words: Catalogue) -> tuple[BigValue, ...]:
    """Return the jerk time where it is entered, or where no filter needs its place."""
    has_filter = record.limits.recommended.setpoint_filter is not None
    if record.loop.jerk == "none" or (has_filter and record.loop.jerk == "limit"):
        return ()
    value = words.format.quantity(record.limits.recommended.jerk_time, "s")
    return (BigValue(label=words.text("jerk-time"), value=value, aside="a / j"),)


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
    """
    text, f, move = words.text, words.format, record.moves[number - 1]
    title = move_title(move.move, number, words)
    aside = _band_sentences(record, number, words)
    best = record.optima[number - 1].time
    least, bound = best.t_f, getattr(best.certificate, "t_f_lower_bound", None)
    settling, optimal = move.response.settling_time, f.quantity(least, "s")
    bounded = record.optima[number - 1].constrained
    if best.method == "composed" and isinstance(bound, float):
        optimal = text("reference-composed", optimum=optimal, bound=f.quantity(bound, "s"))
    if settling is None:
        return " ".join([text("reference-unsettled", move=title, optimum=optimal), *aside])
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
        return " ".join([sentence, *aside])
    held = text(
        "reference-bounded",
        optimum=f.quantity(bounded.t_f, "s"),
        change=f.signed_percent(settling / bounded.t_f - 1.0),
    )
    return " ".join([sentence, *aside, held])


def _band_sentences(record: Record, number: int, words: Catalogue) -> list[str]:
    """Return the optimum with the band, and the force that keeps it over the whole spread."""
    text, f, found = words.text, words.format, record.optima[number - 1]
    settling, sentences = record.moves[number - 1].response.settling_time, []

    def shown(item: BandEntry | RobustEntry) -> dict[str, str]:
        change = "–" if settling is None else f.signed_percent(settling / item.t_f - 1.0)
        return {"optimum": f.quantity(item.t_f, "s"), "change": change}

    if found.band:
        bound, half = f.quantity(found.band.lower_bound, "s"), f.axis(found.band.band, "m")
        sentences = [text("band-optimum", band=half, bound=bound, **shown(found.band))]
    if found.robust:
        sentences.append(text("robust-force", **shown(found.robust)))
    return sentences


def _setpoint_filter(record: Record, words: Catalogue) -> tuple[BigValue, ...]:
    """Return the filter that belongs to the limits; nothing where there is none."""
    item = record.limits.recommended.setpoint_filter
    if item is None:
        return ()
    (_, kind), *numbers = filter_rows(item, words)
    if item.frequency_hz:
        labels = (kind, *(label for label, _ in numbers[1:]))
        return tuple(
            BigValue(label=capitalised(label), value=number, aside="")
            for label, (_, number) in zip(labels, numbers, strict=True)
        )
    value = ", ".join(number for _, number in numbers)
    return (BigValue(label=capitalised(kind), value=value, aside=""),)


def slowest_move(record: Record) -> int:
    """Return the number of the move that settles last, counted from 1."""
    times = [move.response.settling_time for move in record.moves]
    return 1 + max(range(len(times)), key=lambda i: inf if times[i] is None else times[i] or 0.0)


def now_and_then(record: Record, words: Catalogue) -> list[str]:
    """Return what today's values give beside the recommended ones; nothing if none are stated."""
    today, limits = record.limits.today, record.limits.recommended
    if today is None:
        return []

    def shown(item: TodayEntry | LimitsEntry) -> str:
        return f"{settling(item.settling_time, words)} / {residual(item.residual_deviation, words)}"

    now = words.text("now-no-result") if today.failure else shown(today)
    return [words.text("now-and-then", now=now, then=shown(limits)), words.say(today.basis)]


def capitalised(words: str) -> str:
    """Return words with a capital at the beginning and the rest as it is."""
    return words[:1].upper() + words[1:]


def warnings_told(record: Record, words: Catalogue) -> tuple[Paragraph, ...]:
    """Return the warnings on which the verdict hangs, and how many more there are."""
    text = words.text
    told = (*record.limits.warnings, *record.loop.warnings, *record.robustness.warnings)
    lines = [words.say(line) for line in told]
    others = [line for line in record.warnings if line not in told]
    if others:
        lines.append(text("further-warnings" if told else "warning-count", count=len(others)))
    return tuple(Paragraph(text=line, tone=Tone.WARNING) for line in lines)


def attainable_sentences(record: Record, words: Catalogue) -> list[str]:
    """Return what could be met where a requirement stands in the way."""
    f = words.format
    return [
        words.text(
            "could-be-met",
            requirement=say_limiting(item, words),
            value=f.quantity(item.value, item.unit),
            limit=f.quantity(item.limit, item.unit),
        )
        for item in record.limits.attainable
    ]


def share_used(check: Check, words: Catalogue) -> str:
    """Return the share of what is allowed that is used."""
    if check.value is None:
        return "–"
    return words.format.percent(check.value / check.limit)


def verdict_on(check: Check, words: Catalogue) -> str:
    """Return whether a requirement is met, and whether that takes the reserve."""
    if not check.met:
        return words.text("not-met")
    return words.text("met" if _is_within_reserve(check) else "met-without-reserve")


def _is_within_reserve(check: Check) -> bool:
    wanted = (1.0 + ROUNDING) * check.reserve * check.limit
    return check.value is not None and check.value <= wanted


def keeps_reserve(record: Record) -> bool:
    """Return whether the recommended limits leave the reserve of every requirement."""
    return all(map(_is_within_reserve, record.assessment.checks))


def met_at_all(is_met: bool, keeps_reserve: bool, words: Catalogue) -> str:
    """Return whether limits meet all requirements, and whether that takes the reserve."""
    if not is_met:
        return words.text("no")
    return words.text("yes" if keeps_reserve else "yes-without-reserve")


def judged_during(record: Record, words: Catalogue) -> str:
    """Return whether the tool is judged during the move, and what that means for the user."""
    text, f = words.text, words.format
    needs = {item.key: item.value for item in record.data}
    if CONTOUR not in needs:
        peak = f.axis(record.limits.recommended.peak_deviation, "m")
        return text("contour-not-judged", peak=peak)
    feed = needs.get("requirements.contour_feed")
    if isinstance(feed, float | int):
        return text("contour-judged-to-feed", feed=f.axis(feed, "m/s"))
    return text("contour-judged")


def checks_table(checks: list[Check], words: Catalogue) -> Table:
    """Return what was found of each requirement, what is permitted, and where it is worst."""
    text, f = words.text, words.format
    rows = tuple(
        (
            capitalised(say_requirement(check.name, words)),
            f.quantity(check.value, check.unit, missing=text("not-settled")),
            f.quantity(check.limit, check.unit),
            share_used(check, words),
            verdict_on(check, words),
            words.say(check.where),
        )
        for check in checks
    )
    heads = {"found": 1.1, "permitted": 1.3, "share-used": 1.05}
    return Table(
        caption=text("checks-caption"),
        columns=(
            Column(head=text("check"), width=1.8),
            *(
                Column(head=text(head), width=width, is_number=True)
                for head, width in heads.items()
            ),
            Column(head=text("verdict"), width=1.25),
            Column(head=text("where"), width=4.7),
        ),
        rows=rows,
        strong_rows=tuple(i for i, check in enumerate(checks) if not check.met),
    )
