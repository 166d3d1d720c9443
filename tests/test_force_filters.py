"""Filters that are suggested must let Kp rise with the margins kept in every corner."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import numpy as np
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.kinds import GENERIC
from mtcommission.loop.model.controller import filter_polynomials
from mtcommission.loop.tuning.family import LoopFamily, cascade_family, find_filters, tune_shape
from mtcommission.loop.tuning.tuned import Shape, TunedLoop, close_loop, corner_plants
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Machine
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.study.loops import settle_on_loop

SHAPE = Shape(position_ratio=0.5, integral_ratio=16.0)


def ball_screw(**changes: object) -> Machine:
    """Nominal and with the frequencies off by 5 %: the payload would double the time."""
    machine = read_shipped("ball-screw").machine
    needs = replace(machine.requirements, payload=(0.0, 0.0), damping_spread=0.0)
    control = replace(machine.control, **{"kind": GENERIC, **changes})  # type: ignore[arg-type]
    return replace(machine, requirements=needs, control=control)


@cache
def loops() -> tuple[LoopFamily, TunedLoop, LoopFamily, TunedLoop]:
    family = cascade_family(ball_screw())
    tuned = tune_shape(family, SHAPE, largest=4.0)
    assert tuned is not None
    found = find_filters(family, SHAPE)
    assert found is not None
    return family, tuned, *found


def test_width_and_damping_make_depth_and_delay():
    """A notch of another depth than the sheet says would be typed in."""
    item = ForceFilter(kind="notch", natural_frequency=2 * pi * 72.0, damping=0.06, width=0.2)
    top, bottom = filter_polynomials(item)

    def response(omega):
        return complex(np.polyval(top, 1j * omega) / np.polyval(bottom, 1j * omega))

    assert abs(response(item.natural_frequency)) == pytest.approx(0.06 / 0.2)
    slow = 1e-3 * item.natural_frequency
    assert -np.angle(response(slow)) / slow == pytest.approx(item.delay, rel=1e-5)


def test_found_filters_let_Kp_rise_with_the_margins_in_every_corner():
    _, tuned, family, found = loops()
    machine, filters = family.machine, found.controller.force_filters
    assert machine.control.force_filters == filters
    again = close_loop(corner_plants(machine), found.controller)
    assert len(again.analyses) == 3
    assert again.keeps_margins
    assert found.controller.velocity_gain > 1.1 * tuned.controller.velocity_gain
    assert again.least_stiffness > 1.1 * tuned.least_stiffness
    bare = replace(found.controller, force_filters=())  # Kp could not have risen anyway
    assert not close_loop(corner_plants(machine), bare).keeps_margins
    # The resonance on the screw is what limits Kp.
    assert filters[0].natural_frequency == pytest.approx(2 * pi * 137.9, rel=0.11)


def test_no_more_filters_than_the_control_has():
    family, *_ = loops()
    for kind in (replace(GENERIC, force_filters=0), replace(GENERIC, force_filters=1)):
        control = replace(family.machine.control, kind=kind)
        limited = replace(family, machine=replace(family.machine, control=control))
        found = find_filters(limited, SHAPE)
        assert len(found[1].controller.force_filters if found else ()) <= kind.force_filters


def test_filters_are_used_only_where_asked_for():
    """A filter that nobody typed in would make the sheet's loop another than the machine's."""
    without = settle_on_loop(ball_screw(seeks_force_filters=False))
    assert without.tuned.controller.force_filters == ()
    used = settle_on_loop(ball_screw(seeks_force_filters=True))
    assert used.tuned.controller.force_filters
    (remark,) = (item for item in used.remarks if item.kind == "loop-filters-used")
    assert "notch at 1" in Catalogue().say(remark)
    assert used.tuned.least_stiffness > 1.1 * without.tuned.least_stiffness
