"""Plots for print: every value at its place, every label readable."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.sheet.document import Border, Line, LinePlot, Panel
from mtcommission.sheet.figures import ALONG, SIZE, Axis, draw_svg, text_width

ENDS = st.tuples(st.floats(min_value=-1e6, max_value=1e6), st.floats(min_value=1e-6, max_value=1e6))


@given(ENDS, st.integers(min_value=3, max_value=12))
def test_even_ticks_are_round_few_and_inside(ends, most):
    """A plot with no tick, or with a hundred, or with ticks at 0.137, cannot be read."""
    low, width = ends
    axis = Axis(low=low, high=low + width, begin=0.0, end=100.0)
    if axis.low == axis.high:
        return
    found = axis.ticks(most=most)
    step = (axis.high - axis.low) / most
    assert len(found) <= most + 1
    assert len(found) >= 1 or most < 4
    assert all(axis.low - 1e-6 * step <= tick <= axis.high + 1e-6 * step for tick in found)
    if len(found) > 1:
        gap = found[1] - found[0]
        mantissa = float(f"{gap:.6e}".partition("e")[0])
        # Far from zero, the difference of two ticks has lost digits.
        if abs(low) < 1e6 * gap:
            assert min(abs(mantissa - nice) for nice in (1.0, 2.0, 5.0, 10.0)) < 1e-3


@given(st.floats(min_value=1e-6, max_value=1e6), st.floats(min_value=1.2, max_value=1e6))
def test_logarithmic_ticks_are_inside_and_enough_to_read_a_value(low, ratio):
    """Settling times from 0.7 s to 1.2 s stood along the plot with two numbers."""
    axis = Axis(low=low, high=low * ratio, begin=0.0, end=100.0, is_log=True)
    found = axis.ticks(most=ALONG)
    assert all(axis.low * (1 - 1e-9) <= tick <= axis.high * (1 + 1e-9) for tick in found)
    assert (2 if ratio > 29.0 else 4) <= len(found) <= ALONG + 1


def line_plot(**changes):
    x = np.linspace(0.0, 10.0, 11)
    line = Line(label="a & b", x=x, y=x**2, style=4)
    panel = Panel(y_label="y in m", lines=(line,), borders=(Border(label="top", y=150.0),))
    options = {"x_is_log": False, "panels": (panel,)} | changes
    return LinePlot(key="k", caption="c", alt="a", x_label="x in s", link="k", **options)


def test_a_curve_lies_where_its_numbers_are():
    svg = draw_svg(line_plot())
    # The first one is the sample in the legend; the curve is inside the clipped group.
    curve = re.search(r'<g clip-path.*?<path d="M([^"]*)"[^>]*stroke="#0b4f9e"', svg, re.DOTALL)
    assert curve
    points = np.array([[float(v) for v in part.split()] for part in curve[1].split("L")])
    x = (points[:, 0] - points[0, 0]) / (points[-1, 0] - points[0, 0])
    y = (points[:, 1] - points[0, 1]) / (points[-1, 1] - points[0, 1])
    np.testing.assert_allclose(y, x**2, atol=2e-3)
    assert "a &amp; b" in svg


@pytest.mark.parametrize("language", ["en", "de"])
def test_names_of_curves_keep_to_their_room_in_the_legend(language):
    """The room is estimated from the number of letters; the drawn word is the truth."""
    font = FontProperties(family="DejaVu Sans")
    for key in ("response", "control-damping-optimal", "closed-velocity", "recommended"):
        words = Catalogue(language).text(key)
        drawn = TextPath((0, 0), words, size=SIZE, prop=font, usetex=False).get_extents().width
        assert drawn < text_width(words) + 8.0, words
