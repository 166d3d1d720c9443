from __future__ import annotations

import re
from math import isfinite, pi

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mtcommission.base.units.quantities import (
    ACCELERATION,
    ANGLE,
    ANGULAR_VELOCITY,
    DAMPING,
    FORCE,
    FOREIGN,
    FREQUENCY,
    GAIN,
    INERTIA,
    LENGTH,
    MASS,
    PER_INERTIA,
    RATIO,
    ROTARY_DAMPING,
    ROTARY_STIFFNESS,
    STIFFNESS,
    TIME,
    TORQUE,
    VELOCITY,
    Dimension,
    parse_quantity,
)
from mtcommission.base.units.symbols import SYMBOLS, read_unit

REPEATABLE = settings(derandomize=True, deadline=None)
PINT = pint.UnitRegistry()
PINT_NAMES = {
    "t": "metric_ton",
    "rev": "turn",
    "°": "degree",
    "arcmin": "arcminute",
    "%": "percent",
}


@pytest.mark.parametrize("symbol", [s for s in SYMBOLS if s not in ("%", "percent")])
def test_every_symbol_has_the_factor_and_dimension_that_pint_gives(symbol):
    unit = SYMBOLS[symbol]
    theirs = PINT.Quantity(1.0, PINT_NAMES.get(symbol, symbol)).to_base_units()
    ours = PINT.Quantity(
        unit.si_value, "meter**{} * kilogram**{} * second**{} * rad**{}".format(*unit.exponents)
    )
    assert theirs.check(ours.dimensionality)
    assert unit.si_value == pytest.approx(theirs.magnitude, rel=1e-14)


@REPEATABLE
@given(
    st.lists(
        st.tuples(
            st.sampled_from(["*", "/"]),
            st.sampled_from([s for s in SYMBOLS if s not in ("%", "percent", "°")]),
            st.integers(1, 3),
        ),
        min_size=1,
        max_size=5,
    ),
    st.sampled_from(["*", " * ", " ", "·"]),
)
def test_products_powers_and_quotients_agree_with_pint(factors, times):
    """Association to the left and powers: an error here would scale a stiffness wrongly."""
    ours = "1" if factors[0][0] == "/" else ""
    theirs = "1.0"
    for mark, symbol, power in factors:
        ours += (times if mark == "*" and ours else mark if mark == "/" else "") + symbol
        ours += f"^{power}" if power > 1 else ""
        theirs += f" {mark} {PINT_NAMES.get(symbol, symbol)}**{power}"
    expected = PINT.parse_expression(theirs).to_base_units().magnitude
    assert read_unit(ours)[0].si_value == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("44.41 N/µm", STIFFNESS, 44.41e6),
        ("44.41 N/μm", STIFFNESS, 44.41e6),
        ("125 µs", TIME, 125e-6),
        ("8.2e6 Nm/rad", ROTARY_STIFFNESS, 8.2e6),
        ("8.2e6 N·m", ROTARY_STIFFNESS, 8.2e6),
        ("1 Nm/deg", ROTARY_STIFFNESS, 180 / pi),
        ("1800 Nms/rad", ROTARY_DAMPING, 1800.0),
        ("200kNs/m", DAMPING, 200e3),
        ("5 Nmm", TORQUE, 5e-3),
        ("40 kgm^2", INERTIA, 40.0),
        ("40 kg cm²", INERTIA, 40e-4),
        ("40 kg mm**2", INERTIA, 40e-6),
        ("1 (m/min)/mm", GAIN, 1000 / 60),
        ("1 1000/min", GAIN, 1000 / 60),
        ("60/s", GAIN, 60.0),
        ("60 s⁻¹", GAIN, 60.0),
        ("3000 rev/min", FREQUENCY, 50.0),
        ("3000 rpm", ANGULAR_VELOCITY, 100 * pi),
        ("20 rad/s", FREQUENCY, 10 / pi),
        ("1 mm/s2", ACCELERATION, 1e-3),
        ("2 1/(kg m^2)", PER_INERTIA, 2.0),
        ("5 per cent", RATIO, 0.05),
        ("2.5", MASS, 2.5),
        ("\N{MINUS SIGN}3 mm", LENGTH, -3e-3),
        ("-.5e1 mm", LENGTH, -5e-3),
        ("0e999999999 m", LENGTH, 0.0),
    ],
)
def test_written_by_custom(text, dimension, expected):
    assert parse_quantity(text, dimension) == pytest.approx(expected, rel=1e-15)


MUST_BE_MASS = "; must be in kg, g or t"
NO_UNIT = 'is not a unit; write it like "N s/m" or "m/s^2"'
MEANT_KG = ' (did you mean "kg"?)' + MUST_BE_MASS


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("5 Kg", 'got "5 Kg": unknown unit "Kg"' + MEANT_KG),
        ("5 lbs", 'got "5 lbs": unknown unit "lbs" (1 lb = 0.45359237 kg)' + MUST_BE_MASS),
        ("5 kgs", 'got "5 kgs"' + MEANT_KG),
        ("2,5 kg", 'got "2,5 kg" with a comma; write it with a point: "2.5 kg"'),
        ("1,000,000 kg", 'got "1,000,000 kg"; write the number without thousands separators'),
        ("-inf kg", 'got "-inf kg", must be a finite number'),
        ("1e308 t", 'got "1e308 t", must be a finite number'),
        ("", 'got "", which does not begin with a number' + MUST_BE_MASS),
        ("5 (kg", f'got "5 (kg": "(kg" {NO_UNIT}' + MEANT_KG),
        ("10 1000 kg", f'got "10 1000 kg": "1000 kg" {NO_UNIT}' + MUST_BE_MASS),
        ("5 kg\x1b[31m", "got control characters, remove them"),
        ("5" * 81, f'got "{"5" * 77}..."; a quantity has at most 80 characters'),
    ],
)
def test_a_slip_is_named_with_its_remedy(text, message):
    assert fault_in(text, MASS) == message


@pytest.mark.parametrize(
    ("text", "dimension", "wanted"),
    [
        ("20 mm", ANGLE, "rad, mrad, deg, arcsec or rev"),
        ("5 Nm", FORCE, "N, kN or MN"),
        ("5 N/m", ROTARY_STIFFNESS, "N m/rad"),
        ("5 1/s", PER_INERTIA, "1/(kg m^2)"),
    ],
)
def test_a_unit_of_another_quantity_is_refused(text, dimension, wanted):
    assert fault_in(text, dimension).endswith(f"; must be in {wanted}")


@pytest.mark.parametrize(
    ("text", "dimension", "meant"),
    [
        ("30 m/mn", VELOCITY, "m/min"),
        ("30 U/min", ANGULAR_VELOCITY, "rev/min"),
        ("3 newton", FORCE, "N"),
        ("3 mn", FORCE, "mN"),
        ("3 microns", LENGTH, "um"),
        ("50 hz", FREQUENCY, "Hz"),
        ("44 N/my", STIFFNESS, "N/um"),
        ("40 kg/m^2", INERTIA, "kg m^2"),
        ("3 furlong", LENGTH, ""),
    ],
)
def test_a_proposed_unit_fits_the_place(text, dimension, meant):
    """Advice that is refused in turn helps nobody."""
    said = fault_in(text, dimension)
    found = re.search(r'did you mean "([^"]+)"', said)
    assert (found[1] if found else "") == meant
    if found:
        parse_quantity(f"1 {found[1]}", dimension)


@pytest.mark.parametrize(("word", "worth"), sorted(FOREIGN.items()))
def test_what_foreign_units_are_worth_is_what_pint_says(word, worth):
    """A wrong factor in the advice would be typed in as a wrong mass."""
    left, value, unit = re.fullmatch(r"1 (\w+) = ([0-9.]+) (.+)", worth).groups()  # type: ignore[union-attr]
    names = {
        "lbf": "force_pound",
        "kp": "kilogram_force",
        "kgf": "kilogram_force",
        "ipm": "inch/min",
        "PS": "metric_horsepower",
        "h": "hour",
    }
    one = PINT.Quantity(1.0, names.get(left, left)).to(unit.replace(" m", "*m"))
    assert one.m == pytest.approx(float(value), rel=1e-5)


def fault_in(text: str, dimension: Dimension) -> str:
    """The message of the refusal, "" if the text was read as a finite number."""
    try:
        return "" if isfinite(parse_quantity(text, dimension)) else "not finite"
    except ValueError as error:
        return str(error)


def test_the_decimal_comma_is_read_where_it_is_welcome():
    assert parse_quantity("2,5 ms", TIME, decimal_comma=True) == 2.5e-3
    with pytest.raises(ValueError, match="thousands"):
        parse_quantity("1.000,5 kg", MASS, decimal_comma=True)


@REPEATABLE
@given(
    st.text(max_size=100) | st.text("mskgNrad%/*^() 0123456789µ", max_size=79).map("1 {}".format),
    st.sampled_from([MASS, LENGTH, STIFFNESS, FREQUENCY, ROTARY_DAMPING]),
)
def test_any_text_is_read_or_refused_without_harm_to_the_console(text, dimension):
    """Whatever is typed, and whatever is made of the letters of units."""
    message = fault_in(text, dimension)
    assert message.isprintable()
    assert not message or message.startswith("got ")
