"""The commissioning rule, applied: formulas, every symbol with its value, the steps by hand."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mtcommission.record.schema import ModeEntry, Record
from mtcommission.sheet.format import Formatter, motion_unit
from mtcommission.sheet.formula import parse_formula
from mtcommission.sheet.model import Block, Column, Formula, Paragraph, Section, Table, Tone
from mtcommission.sheet.verdict_part import band

SENTENCE_END = re.compile(r"; |\. |\.$")
JOINT = re.compile(r", with |, | and ")
"""What stands between formulas in one sentence."""


def rule(record: Record, f: Formatter) -> Section:
    """Return the rule in words and formulas, its symbols, and the calculation by hand."""
    text, part = f.labels, record.limits.rule
    return Section(
        key="rule",
        heading=text.rule_heading,
        blocks=(
            Paragraph(text=text.say(part.text)),
            Paragraph(text=_result(record, f)),
            *_formulas(part.formula, f),
            _symbols(record, f),
            _steps(record, f),
            Paragraph(text=text.rule_valid.format(range=text.say(part.valid_for)), tone=Tone.NOTE),
            *(Paragraph(text=text.say(line), tone=Tone.WARNING) for line in part.warnings),
        ),
    )


def _result(record: Record, f: Formatter) -> str:
    text, part, length = f.labels, record.limits.rule, motion_unit("m", rotary=f.rotary)
    return text.rule_result.format(
        acceleration=f.quantity(part.acceleration, f"{length}/s^2"),
        jerk=f.quantity(part.jerk, f"{length}/s^3"),
        chosen=text.say(part.chosen),
        bound=text.say(part.bound_by),
        residual=f.quantity(part.predicted_residual, length, missing=text.not_settled),
    )


def _formulas(text: str, f: Formatter) -> tuple[Block, ...]:
    """Return each formula of the rule in a line of its own, and the words between them."""
    blocks: list[Block] = []
    words: list[str] = []
    for sentence in filter(None, (part.strip() for part in SENTENCE_END.split(text))):
        found = tuple(split_formulas(sentence, decimal_mark=f.labels.decimal_mark))
        if all(isinstance(block, Formula) for block in found):
            blocks += [_spoken(block, f) for block in found if isinstance(block, Formula)]
        else:
            words.append(sentence)
    if words:
        blocks.append(Paragraph(text=f.labels.say("; ".join(words) + ".")))
    return tuple(blocks)


def split_formulas(sentence: str, *, decimal_mark: str = ".") -> Iterator[Formula | str]:
    """Yield the formulas of a sentence; what is none comes as text.

    Parameters
    ----------
    sentence
        Formulas in plain signs, joined by words.
    decimal_mark
        For the numbers of the formulas.

    Examples
    --------
    >>> [part.source for part in split_formulas("j <= F/m, with m = a/F within reach")]
    ['j <= F/m', 'm = a/F']
    """
    for piece in _pieces(sentence):
        words = piece.split(" ")
        for count in range(len(words), 0, -1):
            source = " ".join(words[:count])
            tree = parse_formula(source, decimal_mark=decimal_mark)
            if tree is not None and any(sign in source for sign in "<>="):
                yield Formula(tree=tree, source=source, aside=" ".join(words[count:]))
                break
        else:
            yield piece


def _pieces(sentence: str) -> Iterator[str]:
    """Split a sentence at its joints, but not inside brackets."""
    begin = 0
    for joint in JOINT.finditer(sentence):
        piece = sentence[begin : joint.start()]
        if piece.count("(") == piece.count(")"):
            yield piece
            begin = joint.end()
    yield sentence[begin:]


def _spoken(formula: Formula, f: Formatter) -> Formula:
    if not formula.aside:
        return formula
    return Formula(tree=formula.tree, source=formula.source, aside=f.labels.say(formula.aside))


def _symbols(record: Record, f: Formatter) -> Table:
    """Return what each letter of the rule means, with its value on this axis."""
    text, part, loop = f.labels, record.limits.rule, record.loop
    length, force = motion_unit("m", rotary=f.rotary), record.plant.units["F"]
    mass, per_mass = motion_unit("kg", rotary=f.rotary), motion_unit("1/kg", rotary=f.rotary)
    data = {item.key: item.value for item in record.data}
    lag, modes = data.get("drive.force_lag"), record.plant.modes
    names = text.rule_symbols
    rows = [
        ("a", names["a"], f.quantity(part.acceleration, f"{length}/s^2")),
        ("j", names["j"], f.quantity(part.jerk, f"{length}/s^3")),
        ("t_j", names["t_j"], f.quantity(part.jerk_time, "s")),
        ("band", names["band"], f.quantity(band(record), length)),
        ("F", names["F"], f.quantity(record.optima[0].time.f_max, force)),
        ("v", names["v"], _velocities(record, f)),
        *((("L", names["L"], distances),) if (distances := _distances(record, f)) else ()),
        ("m", names["m"], f.quantity(record.plant.moving_mass, mass)),
        ("m_ff", names["m_ff"], f.quantity(loop.feedforward.mass, mass)),
        ("T", names["T"], f.quantity(lag if isinstance(lag, float) else None, "s")),
        ("T_p", text.position_cycle, f.quantity(loop.position_cycle, "s")),
        ("T_v", text.velocity_cycle, f.quantity(loop.velocity_cycle, "s")),
        ("Kv", text.name("Kv"), f.quantity(loop.Kv, "1/s")),
        ("Kp", text.name("Kp"), f.quantity(loop.Kp, motion_unit("N s/m", rotary=f.rotary))),
        ("Tn", text.name("Tn"), f.quantity(loop.Tn, "s")),
        ("f", names["f"], "; ".join(f.quantity(m.frequency_hz, "Hz") for m in modes)),
        ("omega", names["omega"], "2π f"),
        ("zeta", names["zeta"], "; ".join(f.percent(m.damping_ratio) for m in modes)),
        ("g", names["g"], "; ".join(f.quantity(_share(m), per_mass) for m in modes)),
        ("c", names["c"], "; ".join(f.quantity(m.measured_gain, per_mass) for m in modes)),
        ("R", names["R"], "–"),
        ("x", names["x"], "–"),
        ("i", names["i"], "–"),
    ]
    return Table(
        caption=text.rule_symbols_caption.format(modes="; ".join(m.name for m in modes)),
        columns=(
            Column(head=text.symbol, width=0.6, is_formula=True),
            Column(head=text.meaning, width=2.6),
            Column(head=text.value, width=1.6, is_number=True),
        ),
        rows=tuple(rows),
    )


def _velocities(record: Record, f: Formatter) -> str:
    """Return the change or the limit of velocity of each move; a dash where there is none."""
    unit = motion_unit("m/s", rotary=f.rotary)
    moves = (entry.move for entry in record.moves)
    speeds = (move.get("velocity_step", move.get("max_velocity")) for move in moves)
    return "; ".join(f.quantity(speed, unit) for speed in speeds)


def _distances(record: Record, f: Formatter) -> str:
    """Return the length of each positioning move; empty if there is none."""
    unit = motion_unit("m", rotary=f.rotary)
    moves = (entry.move for entry in record.moves)
    return "; ".join(f.quantity(move["distance"], unit) for move in moves if "distance" in move)


def _share(mode: ModeEntry) -> float:
    tool, encoder = mode.tcp_gain, mode.measured_gain
    return max(abs(tool), abs(tool - encoder))


def _steps(record: Record, f: Formatter) -> Table:
    """Return the hand calculation, one line a step."""
    text = f.labels
    return Table(
        caption=text.rule_steps_caption,
        columns=(
            Column(head=text.rule_step, width=1.6),
            Column(head=text.rule_how, width=2.4, is_formula=True),
            Column(head=text.value, width=1.0, is_number=True),
        ),
        rows=tuple(
            (
                text.say(step.name),
                _how(step.formula, f),
                _value(step.value, step.unit, f),
            )
            for step in record.limits.rule.steps
        ),
    )


def _how(formula: str, f: Formatter) -> str:
    return formula if parse_formula(formula) else f.labels.say(formula)


def _value(value: float | None, unit: str, f: Formatter) -> str:
    return f.quantity(value, "" if unit == "1" else motion_unit(unit, rotary=f.rotary))
