"""The commissioning rule, applied: formulas, every symbol with its value, the steps by hand."""

from __future__ import annotations

from mtcommission.messages.catalogue import Catalogue
from mtcommission.record.schema.limits import RuleText
from mtcommission.record.schema.machine import ModeEntry
from mtcommission.record.schema.record import Record
from mtcommission.record.schema.values import Words
from mtcommission.sheet.model import Cell, Column, Formula, Paragraph, Section, Table, Tone
from mtcommission.sheet.values import residual
from mtcommission.sheet.verdict_part import band


def rule(record: Record, words: Catalogue) -> Section:
    """Return the rule in words and formulas, its symbols, and the calculation by hand."""
    text, part = words.text, record.limits.rule
    return Section(
        key="rule",
        heading=text("rule-heading"),
        blocks=(
            Paragraph(text=words.say(part.text)),
            Paragraph(text=_result(record, words)),
            *_formulas(part, words),
            Paragraph(text=words.say(part.advice)),
            _symbols(record, words),
            _steps(record, words),
            Paragraph(text=text("rule-valid", range=words.say(part.valid_for)), tone=Tone.NOTE),
            *(Paragraph(text=words.say(line), tone=Tone.WARNING) for line in part.warnings),
        ),
        is_appendix=True,
    )


def _result(record: Record, words: Catalogue) -> str:
    f, part = words.format, record.limits.rule
    return words.text(
        "rule-result",
        acceleration=f.axis(part.acceleration, "m/s^2"),
        jerk=f.axis(part.jerk, "m/s^3"),
        chosen=words.say(part.chosen),
        bound=words.say(part.bound_by),
        residual=residual(part.predicted_residual, words),
    )


def _formulas(part: RuleText, words: Catalogue) -> tuple[Formula, ...]:
    """Return each formula of the rule in a line of its own."""
    return tuple(
        Formula(
            text=item.text.replace(".", words.format.decimal_mark),
            aside=words.say(item.aside) if item.aside else "",
        )
        for item in part.formula
    )


def _symbols(record: Record, words: Catalogue) -> Table:
    """Return what each letter of the rule means, with its value on this axis."""
    text, f, part, loop = words.text, words.format, record.limits.rule, record.loop
    data = {item.key: item.value for item in record.data}
    lag, modes = data.get("drive.force_lag"), record.plant.modes

    def means(letter: str) -> str:
        return text(f"rule-symbol-{letter.replace('_', '-')}")

    rows = [
        ("a", means("a"), f.axis(part.acceleration, "m/s^2")),
        ("j", means("j"), f.axis(part.jerk, "m/s^3")),
        ("t_j", means("t_j"), f.quantity(part.jerk_time, "s")),
        ("T_F", means("T_F"), f.quantity(part.average, "s")),
        ("n", means("n"), "–"),
        ("band", means("band"), f.axis(band(record), "m")),
        ("F", means("F"), f.axis(record.optima[0].time.f_max, "N")),
        ("v", means("v"), _velocities(record, words)),
        *((("L", means("L"), distances),) if (distances := _distances(record, words)) else ()),
        ("m", means("m"), f.axis(record.plant.moving_mass, "kg")),
        ("m_ff", means("m_ff"), f.axis(loop.feedforward.mass, "kg")),
        ("T", means("T"), f.quantity(lag if isinstance(lag, float) else None, "s")),
        ("T_p", text("position-cycle"), f.quantity(loop.position_cycle, "s")),
        ("T_v", text("velocity-cycle"), f.quantity(loop.velocity_cycle, "s")),
        ("Kv", words.name("Kv"), f.quantity(loop.Kv, "1/s")),
        ("Kp", words.name("Kp"), f.axis(loop.Kp, "N s/m")),
        ("Tn", words.name("Tn"), f.quantity(loop.Tn, "s")),
        ("f", means("f"), "; ".join(f.quantity(m.frequency_hz, "Hz") for m in modes)),
        ("ω", means("omega"), "2 π f"),
        ("s", means("s"), _percent(data.get("requirements.frequency_spread"), words)),
        ("ζ", means("zeta"), "; ".join(f.percent(m.damping_ratio) for m in modes)),
        ("g", means("g"), "; ".join(f.axis(_share(m), "1/kg") for m in modes)),
        ("c", means("c"), "; ".join(f.axis(m.measured_gain, "1/kg") for m in modes)),
        ("R", means("R"), "–"),
        ("x", means("x"), "–"),
        ("i", means("i"), "–"),
    ]
    return Table(
        caption=text("rule-symbols-caption", modes="; ".join(m.name for m in modes)),
        columns=(
            Column(head=text("symbol"), width=0.6),
            Column(head=text("meaning"), width=2.6),
            Column(head=text("value"), width=1.6, is_number=True),
        ),
        rows=tuple((Formula(text=letter), *row) for letter, *row in rows),
    )


def _percent(value: object, words: Catalogue) -> str:
    return words.format.percent_if_known(value if isinstance(value, float) else None)


def _velocities(record: Record, words: Catalogue) -> str:
    """Return the change or the limit of velocity of each move; a dash where there is none."""
    moves = (entry.move for entry in record.moves)
    speeds = (move.get("velocity_step", move.get("max_velocity")) for move in moves)
    return "; ".join(words.format.axis(speed, "m/s") for speed in speeds)


def _distances(record: Record, words: Catalogue) -> str:
    """Return the length of each positioning move; empty if there is none."""
    moves = (entry.move for entry in record.moves)
    return "; ".join(
        words.format.axis(move["distance"], "m") for move in moves if "distance" in move
    )


def _share(mode: ModeEntry) -> float:
    tool, encoder = mode.tcp_gain, mode.measured_gain
    return max(abs(tool), abs(tool - encoder))


def _steps(record: Record, words: Catalogue) -> Table:
    """Return the hand calculation, one line a step."""
    text = words.text
    return Table(
        caption=text("rule-steps-caption"),
        columns=(
            Column(head=text("rule-step"), width=1.6),
            Column(head=text("rule-how"), width=2.4),
            Column(head=text("value"), width=1.0, is_number=True),
        ),
        rows=tuple(
            (
                words.say(step.name),
                _how(step.formula, words),
                _value(step.value, step.unit, words),
            )
            for step in record.limits.rule.steps
        ),
    )


def _how(formula: Words, words: Catalogue) -> Cell:
    if isinstance(formula, str):
        return Formula(text=formula.replace(".", words.format.decimal_mark))
    return words.say(formula)


def _value(value: float | None, unit: str, words: Catalogue) -> str:
    return words.format.axis(value, "" if unit == "1" else unit)
