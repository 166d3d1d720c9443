"""Broken and half-broken profiles, as editors, people and disks make them of the shipped ones."""

from __future__ import annotations

import re

import numpy as np

from mtcommission.machine.profile.shipped import read_shipped, shipped_names

JUNK = "\"'#[]{}=,.\n\\\t \0é€µΩ\ufeff\u202e😀-+eE0123456789abcxyz_%/^*()"
NUMBERS = (
    "0", "-1", "1e308", "1e-308", "1e999", "nan", "inf", "-inf", "0x10", "1_000", "9" * 5000,
    "true",
    "1979-05-27", '"1e9999 kg"', '"-0 kg"', '"1 kg kg kg"', '"٣ kg"', '"1/0 m"', '"m"', '""',
    "[]", "{}", '"1' + "(" * 60 + '"',
)  # fmt: skip
UNITS = ("kg", "t", "N", "kN", "um", "mm", "m", "rad", "deg", "rev/min", "s", "ms", "Hz", "N m",
         "%",
         "furlong", "N/um", "kg m^2", "m/s")  # fmt: skip

TABLE_CELLS = (
    "", " ", '"', '"5 um"', "5;2", "=1+1", "5,0 um", "nan", "\ufeff", "\0", "5 µm", "1e400", "-",
    "'5 um", "5 um 5 um", "[1]", "true", "10 %", "x" * 70_000,
)  # fmt: skip
TABLE_KEYS = (
    "f_max", "plant.modes.x.frequency", "plant.modes[1].frequency", "drive", "moves[0].distance",
    "moves.1.distance", "machine.name", "requirements.payload", "no.such.key", "[", "a" * 5000,
    "plant.kind", "schema", "control.kind", "requirements.tcp_deviation.x", "case", "t_f",
)  # fmt: skip

NUMBER_WITH_UNIT = r'(?<=")[-+0-9.e]+(?= )'

DECADES = 2.5
"""By how many powers of ten a value is moved at most: a slip of units is three."""


def shipped_texts() -> list[str]:
    """Texts of the shipped profiles, in a fixed order."""
    return [read_shipped(name).text for name in shipped_names()]


def dice_of(series: int, seed: int) -> np.random.Generator:
    """The dice of a case: the seed alone says what happens to it."""
    return np.random.default_rng([series, seed])


def mutated(text: str, dice: np.random.Generator) -> str:
    """Break a profile one to three times; never empty."""
    for _ in range(int(dice.integers(1, 4))):
        text = mutated_text(text, dice) or text
    return text


def mutated_text(text: str, dice: np.random.Generator) -> str:
    """Break a profile in one of the ways in which editors, people and disks break files."""
    lines = text.split("\n")
    at, line = int(dice.integers(len(text))), int(dice.integers(len(lines)))
    other = int(dice.integers(len(lines)))
    match int(dice.integers(11)):
        case 0:
            return text[:at]
        case 1:
            return text[:at] + text[at + int(dice.integers(1, 30)) :]
        case 2:
            return text[:at] + JUNK[int(dice.integers(len(JUNK)))] + text[at:]
        case 3:
            noise = "".join(JUNK[i] for i in dice.integers(0, len(JUNK), 40))
            return text[:at] + noise + text[at:]
        case 4:
            return "\n".join([*lines[:line], *lines[line + 1 :]])
        case 5:
            return "\n".join([*lines[: line + 1], lines[other], *lines[line + 1 :]])
        case 6:
            lines[line], lines[other] = lines[other], lines[line]
            return "\n".join(lines)
        case 7:
            number = NUMBERS[int(dice.integers(len(NUMBERS)))]
            return _replace_some(r"(?<== )[^#\n]+", number + " ", text, dice)
        case 8:
            unit = UNITS[int(dice.integers(len(UNITS)))]
            return _replace_some(r'(?<=\d )[A-Za-z][^"]*(?=")', unit, text, dice)
        case 9:
            scale = f"{10.0 ** float(dice.integers(-12, 13)):g}"
            return _replace_some(NUMBER_WITH_UNIT, scale, text, dice)
        case _:
            return _replace_some(r"^[a-z_]+(?= =)", "zzz", text, dice)


def mutated_values(text: str, dice: np.random.Generator) -> str:
    """Move one to three numbers by some powers of ten: what is left is mostly a valid profile."""
    places = list(re.finditer(NUMBER_WITH_UNIT, text))
    for place in sorted(
        dice.choice(len(places), int(dice.integers(1, 4)), replace=False), reverse=True
    ):
        found = places[int(place)]
        value = float(found[0]) * 10.0 ** float(dice.uniform(-DECADES, DECADES))
        text = f"{text[: found.start()]}{value:.4g}{text[found.end() :]}"
    return text


def extreme_machine(dice: np.random.Generator) -> str:
    """A machine that nobody built, but that ``check`` mostly accepts.

    From 1 g to 100 t, one to eight modes from 0.1 Hz to 5 kHz, damped by 1e-4 to 0.3; drives from
    one step of a stepper to servos, moves from 2 um to 10 m.
    """

    def power(low: float, high: float) -> float:
        return float(10.0 ** dice.uniform(low, high))

    is_follower = dice.random() < 0.25
    mass = power(-3.0, 5.0)
    force = max(mass * power(-2.0, 2.5), 0.002)
    lines = ["schema = 1", "[machine]", f'name = "{mass:.3g} kg"', 'axis = "X"']
    lines += ['source = "dice"', "[plant]", 'kind = "modal"']
    if not is_follower:
        lines.append(f'moving_mass = "{mass:.4g} kg"')
    for k, hertz in enumerate(sorted(power(-1.0, 3.7) for _ in range(int(dice.integers(1, 9))))):
        gain = float(dice.choice([-1.0, 1.0])) * power(-1.5, 0.3)
        shown = f"{gain:.4g}" if is_follower else f'"{gain / mass:.4g} 1/kg"'
        lines += ["[[plant.modes]]", f'name = "mode_{k + 1}"', f'frequency = "{hertz:.4g} Hz"']
        lines += [f"damping_ratio = {power(-4.0, -0.5):.3g}", f"tcp_gain = {shown}"]
        if not is_follower:
            lines.append(f'measured_gain = "{power(-2.5, -0.2) / mass:.4g} 1/kg"')
    lines.append("[drive]")
    if is_follower:
        lines.append('kind = "position_source"')
        lines.append(f'max_acceleration = "{force / mass:.4g} m/s^2"')
    else:
        lines.append(f'force_lag = "{power(-1.0, 1.0):.3g} ms"')
        lines.append(f'max_force = "{force:.4g} N"')
        lines.append(f'continuous_force = "{0.6 * force:.4g} N"')
    for _ in range(int(dice.integers(1, 4))):
        distance = power(-5.7, 1.0)
        velocity = min(max(distance / power(-2.3, 1.3), 1e-3), 10.0)
        lines += ["[[moves]]", f'distance = "{distance:.4g} m"', f'dwell = "{power(-1, 0):.3g} s"']
        lines.append(f'max_velocity = "{velocity:.4g} m/s"')
    lines += ["[requirements]", f'tcp_deviation = "{power(-7.0, -3.5):.3g} m"']
    lines.append(f'max_settling_time = "{power(-1.3, 1.0):.3g} s"')
    if dice.random() < 0.7:
        lines.append(f"frequency_spread = {dice.choice([0.0, 0.02, 0.05, 0.1])}")
    if not is_follower and dice.random() < 0.5:
        lines.append(f'payload = ["0 kg", "{mass * power(-2.0, 0.0):.3g} kg"]')
    lines += ["[control]", 'kind = "klipper"' if is_follower else 'kind = "generic"']
    if not is_follower:
        cycle = float(dice.choice([0.0625, 0.125, 0.25, 1.0]))
        ratio = int(dice.choice([1, 2, 4, 8, 16]))
        lines += [f'velocity_cycle = "{cycle} ms"', f'position_cycle = "{cycle * ratio} ms"']
    return "\n".join(lines) + "\n"


def _replace_some(pattern: str, new: str, text: str, dice: np.random.Generator) -> str:
    places = list(re.finditer(pattern, text, re.MULTILINE))
    for place in reversed(places):
        if dice.random() < 2.0 / len(places):
            text = text[: place.start()] + new + text[place.end() :]
    return text


def mutated_table(text: str, dice: np.random.Generator) -> str:
    """Break a table of cases one to three times, as spreadsheets and people do."""
    for _ in range(int(dice.integers(1, 4))):
        rows = [line.split(",") for line in text.split("\n")]
        row = rows[int(dice.integers(len(rows)))]
        cell = int(dice.integers(len(row)))
        match int(dice.integers(8)):
            case 0:
                row[cell] = TABLE_CELLS[int(dice.integers(len(TABLE_CELLS)))]
            case 1:
                row.append(TABLE_CELLS[int(dice.integers(len(TABLE_CELLS)))])
            case 2:
                del row[cell]
            case 3:
                rows.insert(int(dice.integers(len(rows) + 1)), list(row))
            case 4:
                for each in rows:
                    each.append(each[-1])
            case 5:
                key = TABLE_KEYS[int(dice.integers(len(TABLE_KEYS)))]
                rows[0] = [key, *rows[0][1:]]
            case 6:
                row[cell] = NUMBERS[int(dice.integers(len(NUMBERS)))]
            case _:
                text = mutated_text(text, dice) or text
                continue
        text = "\n".join(",".join(row) for row in rows) or text
    return text
