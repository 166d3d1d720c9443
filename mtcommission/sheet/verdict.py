"""Page 1: the verdict, the limits large, what to type in, the requirements one by one."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite
from typing import TYPE_CHECKING

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.base.messages.message import Message, join_by_and, parts_of
from mtcommission.base.messages.quantities import pretty_unit
from mtcommission.controls.control import is_neutral, name_row
from mtcommission.controls.syntax import DOUBT
from mtcommission.controls.wording import name_control
from mtcommission.limits.requirements import REGISTER, Requirement, read_requirement
from mtcommission.machine.checks import (
    OF_LOOP,
    filter_rows,
    mark_assumed,
    say_filter,
    say_loop,
)
from mtcommission.machine.moves import Move, VelocityStep, size_unit
from mtcommission.machine.setpoint_filter import name_shaper
from mtcommission.record.machine import datum_name, say_assumed
from mtcommission.record.moves import Check
from mtcommission.sheet.document import (
    BigValue,
    Block,
    Form,
    Headline,
    Paragraph,
    Table,
    Tone,
    note,
)
from mtcommission.sheet.tables import (
    BANDWIDTH,
    DASH,
    GAIN_MARGIN,
    PHASE_MARGIN,
    RESIDUAL,
    SENSITIVITY,
    SETTLING,
    Quantity,
    capitalised,
    pairs,
    say_requirement,
    show,
    table,
)
from mtcommission.study.robustness import KeptRange

if TYPE_CHECKING:
    from mtcommission.controls.syntax import Entry
    from mtcommission.record.exported import Export
    from mtcommission.record.limits import WorstSizeEntry
    from mtcommission.record.read_back import AxisRecord
    from mtcommission.record.record import Record

ROUNDING = 1e-6
"""Relative difference that search and check may have where the reserve is just kept."""

WHOLE = 0.99
"""Share of the recommended acceleration that is all of it, but for rounding."""

ELSEWHERE_MARK = ">"
"""Stands, as in the export's text, before what is set in the drive, or must be so."""

MULTIPLE = re.compile(r"\d+[.0]\d|0\.1")
"""A unit that begins with a number: what is typed counts so many."""

NAME_WIDTH, LEAST_NAME, MOST_NAME = 0.096, 2.0, 3.65
"""Of the column of parameters: for a letter, at least and at most, of 8.9 for all columns."""

NUMBER = re.compile(r"-?\d+(\.\d+)?")

PERMITTED = {
    GAIN_MARGIN.name: ("≥", "tuning.gain_margin_db"),
    PHASE_MARGIN.name: ("≥", "tuning.phase_margin_deg"),
    SENSITIVITY.name: ("≤", "tuning.sensitivity_peak"),
    BANDWIDTH.name: ("≥", "control.minimum_bandwidth"),
}
"""Which bound each margin has, and where the record holds it."""

Row = tuple[str, str]

MARKED = (
    *("control.", "requirements.reserve", "requirements.payload (least)"),
    *("requirements.frequency_spread", "requirements.damping_spread"),
)
"""Beginnings of the keys that other rows of page 1 mark, or that the largest payload stands for."""


def first_page(record: Record, typed: Export | Message, words: Catalogue) -> Iterator[Block]:
    """Yield verdict, what to enter, for what it holds, on what it rests."""
    holds = holds_rows(record, words)
    basis = (*basis_rows(record, words), *data_rows(record, words))
    yield headline(record, typed, words)
    yield from _warnings(record, words)
    yield _entries(record, typed, words)
    yield _checks(record, words)
    yield note(_judged_during(record, words))
    yield pairs(words, "holds-caption", holds, first="basis", width=5.0)
    yield pairs(words, "basis-caption", basis, first="basis", width=5.0)


def headline(record: Record, typed: Export | Message, words: Catalogue) -> Headline:
    """Return the verdict with the limits to enter, what they give, and what the export finds.

    The page speaks as one with the export of its own numbers.
    """
    text, limits, assessment = words.text, record.limits.recommended, record.assessment
    values, is_met = list(_big_values(record, words)), assessment.met
    verdict, said = "verdict-met" if is_met else "verdict-not-met", list[str]()
    shown, wanted = _acceleration_typed(record, typed, words), values[0].value
    if shown != wanted:
        values[0] = replace(values[0], value=shown)
        said.append(text("as-typed", acceleration=shown, wanted=wanted))
    said += _reached(record, words)
    if assessment.obstacle:
        obstacle = say_requirement(assessment.obstacle, words)
        said.append(f"{text('obstacle', obstacle=obstacle)}.")
    said.append(f"{text('values-bound-by', bound=words.say(limits.bound_by))}.")
    said += [*assumed_and_binding(record, words), *attainable_sentences(record, words)]
    if isinstance(typed, Message):
        is_met, verdict = False, "verdict-incomplete" if is_met else verdict
    else:
        is_missed = is_met and not typed.is_met
        said += map(words.say, (*([typed.judgement] if is_missed else []), *typed.doubts))
        if is_met and not typed.meets_requirements:
            verdict = "verdict-missed" if is_missed else "verdict-incomplete"
            is_met = typed.is_met
    return Headline(
        is_met=is_met, verdict=text(verdict), detail=" ".join(said), values=tuple(values)
    )


def _reached(record: Record, words: Catalogue) -> Iterator[str]:
    """What the limits give, beside what the values now in the control do."""
    text, today = words.text, record.limits.today

    def gives(limits: object) -> tuple[str, str]:
        return SETTLING.show(limits, words), RESIDUAL.show(limits, words)

    settling, residual = given = gives(record.limits.recommended)
    if today is None:
        yield text("what-they-give", settling=settling, residual=residual)
    else:
        now = text("now-no-result") if today.failure else " / ".join(gives(today))
        yield text("now-and-then", now=now, then=" / ".join(given))
        yield words.say(today.basis)


def signature(record: Record, typed: Export | Message, words: Catalogue) -> tuple[Block, ...]:
    """Return the values that are signed for, and the lines to sign on."""
    values = words.text(
        "signed-values",
        machine=record.machine.name,
        axis_name=record.machine.axis,
        acceleration=_acceleration_typed(record, typed, words),
        jerk=_jerk(record, words),
        filter=say_filter(record.limits.recommended.setpoint_filter, words),
    )
    kinds = (*(f"signature-field-{i}" for i in range(1, 4)), "remarks")
    lines = Form(fields=tuple(map(words.text, kinds)))
    return Paragraph(text=values), lines


def _acceleration_typed(record: Record, typed: Export | Message, words: Catalogue) -> str:
    """What is typed where that is less than what was recommended, rounding apart."""
    acceleration = record.limits.recommended.acceleration
    if not isinstance(typed, Message) and typed.limits.acceleration < WHOLE * acceleration:
        acceleration = typed.limits.acceleration
    return show(acceleration, words, "m/s^2")


def _jerk(record: Record, words: Catalogue) -> str:
    value = record.limits.recommended.jerk if record.loop.jerk != "none" else None
    return show(value, words, "m/s^3", "no-jerk-limit")


def _big_values(record: Record, words: Catalogue) -> Iterator[BigValue]:
    """Acceleration, jerk, jerk time where it is entered or no filter needs its place, filter."""
    text, limits, jerk = words.text, record.limits.recommended, record.loop.jerk
    item = limits.setpoint_filter
    acceleration = show(limits.acceleration, words, "m/s^2")
    yield BigValue(label=text("acceleration"), value=acceleration, aside="a")
    yield BigValue(label=text("jerk"), value=_jerk(record, words), aside="j")
    if jerk != "none" and not (item and jerk == "limit"):
        time = show(limits.jerk_time, words, "s")
        yield BigValue(label=text("jerk-time"), value=time, aside="a / j")
    if item is None:
        return
    (_, kind), *numbers = filter_rows(item, words)
    if item.frequency_hz:
        labels = (kind, *(label for label, _ in numbers[1:]))
        for label, (_, number) in zip(labels, numbers, strict=True):
            yield BigValue(label=capitalised(label), value=number)
    else:
        yield BigValue(label=capitalised(kind), value=", ".join(number for _, number in numbers))


def assumed_and_binding(record: Record, words: Catalogue) -> Iterator[str]:
    """Yield which assumed values bind, and what others would give."""
    binding = parts_of(record.limits.recommended.bound_by)
    for requirement in REGISTER:
        if not isinstance(requirement, Requirement) or requirement.message not in binding:
            continue
        begin, name = requirement.rests_on
        data = [one for one in record.data if begin and one.key.startswith(begin)]
        data = [one for one in data if one.key.endswith(name) and one.is_assumed]
        if data:
            names = ", ".join(datum_name(one, words) for one in data)
            named = words.text("assumed-binds", data=names)
            yield f"{named}{_with_another(record, name, words)}"


def _with_another(record: Record, name: str, words: Catalogue) -> str:
    for item in record.limits.would_bring:
        if item.name != name:
            continue
        given = []
        if item.meets_requirements and item.saved and item.saved > 0.0:
            accelerations = [part.values.get("acceleration") for part in parts_of(item.change)]
            given = [show(a, words, "m/s^2") for a in accelerations if isinstance(a, float)]
            given.append(SETTLING.show(item, words))
        elif isinstance(item.outcome, Message) and item.outcome.kind == "change-saves-little":
            given.append(words.say(item.outcome))
        if given:
            said = words.say(item.change)
            return words.text("another-gives", change=said, given=", ".join(given))
    return words.text("another-unknown")


def attainable_sentences(record: Record, words: Catalogue) -> Iterator[str]:
    """Yield what could be met where a requirement stands in the way."""
    for item in record.limits.attainable:
        named = say_requirement(item.requirement, words)
        if item.together_with:
            others = join_by_and([read_requirement(one).message for one in item.together_with])
            named = words.text("requirement-together-with", requirement=named, others=others)
        value, limit = (show(one, words, item.unit) for one in (item.value, item.limit))
        yield words.text("could-be-met", requirement=named, value=value, limit=limit)


def _warnings(record: Record, words: Catalogue) -> tuple[Paragraph, ...]:
    hung = (*record.limits.warnings, *record.loop.warnings, *record.robustness.warnings)
    lines = [words.say(line) for line in hung]
    others = [line for line in record.warnings if line not in hung]
    if others:
        further = "yes" if hung else "no"
        lines.append(words.text("warning-count", count=len(others), others=further))
    return tuple(Paragraph(text=line, tone=Tone.WARNING) for line in lines)


def _checks(record: Record, words: Catalogue) -> Table:
    name = Quantity("check", lambda one: capitalised(say_requirement(one.name, words)), width=1.75)
    columns = (name, *check_columns(words), Quantity("where", "where", width=5.7))
    checks = record.assessment.checks
    caption = "checks-caption" if _serves_listed(record) else "checks-any-size-caption"
    return table(words, caption, columns, checks, strong=lambda check: not check.met)


def check_columns(words: Catalogue) -> tuple[Quantity, ...]:
    """Return what was found of a requirement, what is permitted, and how much of it is used."""

    def unit_of(check: Check) -> str:
        return check.unit

    return (
        Quantity("found", "value", unit_of, "not-settled", width=1.25),
        Quantity("permitted", "limit", unit_of, width=1.4),
        Quantity("share-used", lambda check: share_used(check, words), "%", width=1.15),
        Quantity("verdict", lambda check: verdict_on(check, words), width=1.25),
    )


def share_used(check: Check, words: Catalogue) -> str:
    """Return the share of what is allowed that is used."""
    return show(None if check.value is None else check.value / check.limit, words, "%")


def verdict_on(check: Check, words: Catalogue) -> str:
    """Return whether a requirement is met, and whether that takes the reserve."""
    if not check.met:
        return words.text("not-met")
    wanted = (1.0 + ROUNDING) * check.reserve * check.limit
    is_within = check.value is not None and check.value <= wanted
    return words.text("met" if is_within else "met-without-reserve")


def _judged_during(record: Record, words: Catalogue) -> str:
    """Whether the tool is judged during the move, and what that means for the user."""
    every = [item for item in REGISTER if isinstance(item, Requirement) and item.whole_move[0]]
    asked = []
    for item in every:
        bound, feed = (find_number(record, key) for key in item.whole_move)
        if bound is not None:
            to = "none" if feed is None else show(feed, words, "m/s")
            asked.append(Message("judged-to-feed", requirement=item.message, feed=to))
    if asked:
        return words.text("judged-in-motion", requirements=join_by_and(asked))
    peak = show(record.limits.recommended.peak_deviation, words, "m")
    keys = "; ".join(words.name(one.whole_move[0]) for one in every)
    return words.text("judged-at-rest", peak=peak, keys=keys)


def _entries(record: Record, typed: Export | Message, words: Catalogue) -> Block:
    """Every parameter to type in: its name in the control, old beside new, and meaning."""
    if isinstance(typed, Message):
        return Paragraph(text=words.text("entry-none", why=typed), tone=Tone.WARNING)
    longest = max(len(entry_name(entry, words)) for entry in typed.entries)
    named = min(max(NAME_WIDTH * longest, LEAST_NAME), MOST_NAME)
    is_doubted = any(DOUBT in _meaning(entry, words) for entry in typed.entries)
    meaning = "meaning-with-doubt" if is_doubted else "meaning"
    columns = [
        Quantity("parameter", lambda entry: entry_name(entry, words), width=named),
        Quantity("new-value", lambda entry: show_typed(entry.value, entry, words), "", width=1.45),
        Quantity(meaning, lambda entry: _meaning(entry, words), width=7.45 - named),
    ]
    if any(entry.old for entry in typed.entries):
        old = Quantity(
            "old-value", lambda entry: show_typed(entry.old, entry, words), "", width=0.95
        )
        columns.insert(1, old)
    return table(
        words, "entry-caption", columns, typed.entries, jerk=record.loop.jerk, mark=ELSEWHERE_MARK
    )


def entry_name(entry: Entry, words: Catalogue) -> str:
    """Return the name of a parameter, marked where it is set elsewhere than in the control."""
    row, name = entry.row, name_row(entry.row, words)
    if row.is_elsewhere:
        return f"{ELSEWHERE_MARK} {name}"
    return f"[{row.section}] {name}" if row.section else name


def show_typed(value: str, entry: Entry, words: Catalogue) -> str:
    """Return a number with the language's decimal mark and its unit; else what is typed."""
    if not NUMBER.fullmatch(value):
        # A control's own word is typed as it stands.
        kind = f"choice-{value.replace('_', '-')}"
        return words.known(kind, name_shaper(value)) if is_neutral(entry.row) else value
    unit = pretty_unit({"us": "µs"}.get(entry.row.unit, entry.row.unit))
    if MULTIPLE.match(unit):
        unit = f"[{unit}]"
    return words.format.with_unit(value, unit).replace(".", words.format.decimal_mark)


def _meaning(entry: Entry, words: Catalogue) -> str:
    said = words.say(entry.row.text) if entry.row.text else ""
    if said.casefold() == name_row(entry.row, words).casefold():  # the name says it
        said = ""
    if entry.row.unit.startswith("rad/"):  # typed so, while the sheet counts in degrees
        said = f"{said}, {words.format.quantity(float(entry.value), entry.row.unit)}"
    return said if entry.row.is_verified else f"{said} {DOUBT}".strip()


def move_title(move: Move, number: int, words: Catalogue) -> str:
    """Return e.g. "Move 1 (velocity step 100 mm/s)"."""
    return f"{words.text('move', number=number)} ({say_move(move, words)})"


def say_move(move: Move, words: Catalogue) -> str:
    """Return e.g. "velocity step 100 mm/s"."""
    if isinstance(move, VelocityStep):
        return words.text("velocity-step", velocity=show(move.velocity_step, words, "m/s"))
    distance = show(move.distance, words, "m")
    if not isfinite(move.max_velocity):
        return words.text("positioning", distance=distance)
    velocity = show(move.max_velocity, words, "m/s")
    return words.text("positioning-limited", distance=distance, velocity=velocity)


def slowest_move(record: Record) -> int:
    """Return the number of the move that settles last, counted from 1."""
    times = [move.response.settling_time for move in record.moves]
    return 1 + max(range(len(times)), key=lambda i: inf if times[i] is None else times[i] or 0.0)


def reference_sentence(record: Record, number: int, words: Catalogue) -> str:
    """Return the time-optimal reference of a move, counted from 1, beside the recommendation."""
    f, move = words.format, record.moves[number - 1]
    t_f, settling = record.optima[number - 1].time.t_f, move.response.settling_time
    share = 0.0 if settling is None else settling / t_f - 1.0
    compared = "unsettled" if settling is None else "sooner" if share < 0.0 else "later"
    return words.text(
        "reference",
        move=move_title(move.move, number, words),
        optimum=f.quantity(t_f, "s"),
        compared=compared,
        settling=f.quantity(settling, "s"),
        share=f.percent(abs(share)),
    )


def find_number(record: Record, key: str) -> float | None:
    """Return a number of the profile [SI]; None where the record does not state it."""
    values = (item.value for item in record.data if item.key == key)
    value = next(values, None)
    return float(value) if isinstance(value, float | int) else None


def permitted_margin(quantity: Quantity, record: Record, words: Catalogue) -> str:
    """Return what tuning keeps of a margin in every corner, or what the profile asks of it."""
    sign, key = PERMITTED.get(quantity.name, ("", ""))
    value = record.settings.get(key, find_number(record, key))
    if not isinstance(value, float | int):
        return DASH
    return f"{sign} {show(float(value), words, str(quantity.unit), digits=quantity.digits)}"


def find_band(record: Record) -> float | None:
    """Return the permitted TCP deviation [m or rad]; None where the record does not state it."""
    return find_number(record, "requirements.tcp_deviation")


def is_assumed(record: AxisRecord, key: str) -> bool:
    """Return whether a key, or one that begins so, was not stated by anybody."""
    return any(item.is_assumed for item in record.data if item.key.startswith(key))


def holds_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return for which moves, frequencies, damping ratios and payloads all is kept."""
    text, error = words.text, record.robustness
    rows = [
        (text("basis-sizes"), _sizes(record, words)),
        (text("frequencies"), _spread(record, "frequency", error.frequency_error, words)),
        (text("basis-damping"), _spread(record, "damping", error.damping_error, words)),
    ]
    low, high = (
        find_number(record, f"requirements.payload ({end})") or 0.0 for end in ("least", "largest")
    )
    if high > low:
        said = text("payload-from-to", low=show(low, words, "kg"), high=show(high, words, "kg"))
        rows.append((text("payload"), _marked(record, "requirements.payload", said, words)))
    return tuple(rows)


def basis_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return the control and its loop, the reserve, and what the encoder's steps do."""
    text, loop = words.text, record.loop
    reserve = {
        name: find_number(record, f"requirements.reserve.{name}") or 0.0
        for name in ("band", "force")
    }
    said = _marked(record, "requirements.reserve", text("reserve-kept", **reserve), words)
    rows = [(text("control"), _control(record, words)), (text("name-reserve"), said)]
    if loop.encoder_noise is not None:
        steps = text(
            "encoder-steps",
            resolution=show(loop.encoder_resolution, words, "m"),
            tool=show(loop.encoder_noise.tool, words, "m"),
            force=show(loop.encoder_noise.force, words, "N"),
        )
        rows.append((words.name("encoder"), steps))
    return tuple(rows)


def data_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return where the machine data come from: stated, measured, and assumed."""
    text, part, source = words.text, record.identified, words.say(record.machine.source)
    assumed = assumed_rows(record, words)
    if part is None:
        return ((text("basis-data"), text("measured-nothing", source=source)), *assumed)
    modes = ", ".join(mode.name for mode in part.modes)
    measured = text("measured-modes", modes=modes, date=part.created[:10])
    return ((text("basis-data"), source), (text("measured"), measured), *assumed)


def assumed_rows(record: Record, words: Catalogue) -> tuple[Row, ...]:
    """Return the other values that nobody stated, in one row; nothing where all were."""
    others = [item for item in record.data if not item.key.startswith(MARKED)]
    said = say_assumed(others, record.plant.units, words)
    return ((words.text("basis-assumed"), "; ".join(said)),) if said else ()


def kept_sentence(record: Record, words: Catalogue) -> str:
    """Return between which frequency errors every requirement is kept, as a sentence."""
    kept = _kept_ends(record.robustness.frequency_error, words)
    return words.text("kept-between", **kept) if kept else words.text("kept-nowhere")


def _control(record: Record, words: Catalogue) -> str:
    loop = record.loop
    name = _marked(record, "control.kind", words.say(name_control(loop.kind)), words)
    keys = [item.key for item in record.data if item.key in OF_LOOP]
    assumed = [key for key in keys if is_assumed(record, key)]
    place = "" if record.machine.follows else loop.position_loop
    said = say_loop(place, loop.position_cycle, loop.velocity_cycle, words)
    return f"{name}; {mark_assumed(said, keys, assumed, words)}"


def _spread(record: Record, kind: str, error: KeptRange, words: Catalogue) -> str:
    """The spread that was asked for, and the range in which all is kept."""
    key, kept = f"requirements.{kind}_spread", _kept_ends(error, words)
    spread, said = find_number(record, key), words.text("spread-none")
    if spread:
        said = _marked(record, key, words.text("spread", spread=spread), words)
    where = words.text("all-kept-between", **kept) if kept else words.text("not-kept-nominally")
    return f"{said}; {where}"


def _kept_ends(error: KeptRange, words: Catalogue) -> dict[str, str]:
    """Both ends of the range that is kept; empty if not even the profile's own values are."""
    low, high = error.kept_from, error.kept_to
    if low is None or high is None:
        return {}
    shown = {}
    for name, end, tried in (("low", low, error.factor[0]), ("high", high, error.factor[-1])):
        value = words.format.signed_percent(end - 1.0)
        # Beyond the last one tried nothing is known.
        shown[name] = words.text("at-least", value=value) if end == tried else value
    return shown


def _serves_listed(record: Record) -> bool:
    """Whether the limits hold for the listed sizes alone."""
    return any(item.smallest > 0.0 for item in record.limits.recommended.valid_for)


def _sizes(record: Record, words: Catalogue) -> str:
    text, f, limits = words.text, words.format, record.limits
    sizes = enumerate(limits.recommended.valid_for)
    own = ", ".join(_say_size(record, place, one.largest, words) for place, one in sizes)
    if _serves_listed(record):
        return text("sizes-listed", moves=own)
    said = [text("sizes-every", moves=own), *(told for _, told in worst_sizes(record, words))]
    alone, together = limits.listed_only, limits.recommended.settling_time
    if alone and alone.settling_time and together and together > alone.settling_time:
        said.append(text("sizes-cost", cost=f.quantity(together - alone.settling_time, "s")))
    return "; ".join(said)


def worst_sizes(record: Record, words: Catalogue) -> Iterator[tuple[WorstSizeEntry, str]]:
    """Yield each worst size that is proved, and what is said of it."""
    units = {check.name: check.unit for check in record.assessment.checks}
    worst_of = [] if _serves_listed(record) else record.limits.recommended.worst_sizes
    for worst in worst_of:
        if worst.bound is not None:  # else only some sizes were looked at
            size = _say_size(record, worst.move - 1, worst.size, words)
            found, bound = (
                words.format.quantity(value, units[worst.requirement])
                for value in (worst.value, worst.bound)
            )
            yield worst, words.text("sizes-worst", residual=found, size=size, bound=bound)


def _say_size(record: Record, place: int, size: float, words: Catalogue) -> str:
    return words.format.axis(size, size_unit(record.moves[place].move))


def _marked(record: Record, key: str, shown: str, words: Catalogue) -> str:
    return words.text("assumed", value=shown) if is_assumed(record, key) else shown
