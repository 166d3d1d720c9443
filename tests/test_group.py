"""Axes that move together: closed forms, a second program, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.cli.group_view import say_next
from mtcommission.controls.control import Corner, CornerRule
from mtcommission.group import follow as follow_module
from mtcommission.group.contours import (
    Turning,
    corner_deviation,
    deviate,
    line_deviation,
    speeds_at_once,
    tell_corner,
    turnings,
    worst_circle,
)
from mtcommission.group.follow import filter_response, follow
from mtcommission.group.group import join
from mtcommission.group.judged import (
    circle_test,
    corner_speeds,
    draw_circles,
    feeds_over_radius,
    judge_group,
)
from mtcommission.group.record import build_group_record
from mtcommission.group.task import Task, read_task
from mtcommission.loop.disturbance import simulate_disturbance
from mtcommission.machine.moves import Positioning
from mtcommission.machine.profile.read import parse_profile, read_source
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.record.read_back import close_as_held
from tests.group_record import PROFILES, driven, mill
from tests.independent_circle import circle_off, corner_off, entry_off, line_off
from tests.test_group_agrees import FEWER, GIVEN

X, Y = PROFILES / "mill-x.toml", PROFILES / "mill-y.toml"


Change = tuple[str, str]


def task_of(*changes: tuple[Change, ...], **options: str) -> Task:
    """The task of X and Y, each with some texts of its profile replaced by others."""
    sources = []
    for path, own in zip((X, Y), changes or ((), ()), strict=True):
        source = read_source(path)
        for old, new in own:
            assert old in source.text
            source = replace(source, text=source.text.replace(old, new))
        sources.append(source)
    machines = [parse_profile(one.text, where=str(one.path)) for one in sources]
    return read_task(machines, sources, **options)


GAINS = [('kind = "sinumerik"\n', GIVEN.format("sinumerik", 60, Kp)) for Kp in (150, 130)]
"""Of X and Y, with which no loop is to be searched for."""


@pytest.fixture(scope="module")
def joined():
    return mill()


WITHOUT_CONTOUR = ('contour_deviation = "20 um"\ncontour_feed = "6 m/min"\n', "")


# Closed forms


def test_an_average_makes_circles_smaller_by_its_square():
    feed, radius, T = 0.1, 0.01, 0.016
    omega = np.array([feed / radius])
    same = filter_response(moving_average(T), omega)
    off = radius * deviate(same, same).radius[0]
    assert off == pytest.approx(-(feed**2) * T**2 / (24.0 * radius), rel=2e-3)


@pytest.mark.parametrize("degrees", [45.0, 135.0])
def test_a_corner_behind_an_average_alone(degrees):
    T, step, v = 0.016, 1e-4, 0.1
    t = step * np.arange(400)
    tool = np.where(t < T, t**2 / (2.0 * T), t - 0.5 * T)[None, None]
    axis = Turning(step=step, starts=np.zeros(1), tool=tool, lag=np.array([0.5 * T]))
    angle = degrees * pi / 180.0
    off = corner_deviation((axis, axis), angle, v)
    assert off == pytest.approx(v * T / 4.0 * sin(0.5 * angle), rel=1e-3)


@pytest.mark.parametrize("kind", [Corner.STEP, Corner.JUNCTION, Corner.DEVIATION])
def test_what_a_control_is_told_keeps_the_speed_of_every_corner(kind, joined):
    """In every direction of the change of velocity, by the rule as the control's source has it."""
    speeds, a = speeds_at_once(turnings(joined.pair), tolerance=10e-6, feed=0.1), (2.0, 5.0)
    rule = CornerRule(kind=kind)
    value = tell_corner(rule, speeds, tolerance=10e-6, accelerations=a)
    nearest = []
    for one in speeds:
        s = cos(0.5 * one.angle)
        for direction in np.arange(1, 40) * pi / 80:
            change = cos(direction), sin(direction)
            v = {
                # Each axis steps its velocity by no more.
                Corner.STEP: value / (2.0 * sin(0.5 * one.angle) * max(change)),
                # toolhead.py: junction deviation scv² (sqrt(2) - 1)/a, times a.
                Corner.JUNCTION: sqrt(value**2 * (sqrt(2.0) - 1.0) * s / (1.0 - s)),
                # planner.c: the axes' own acceleration along the change of direction.
                Corner.DEVIATION: sqrt(
                    value * min(a[0] / change[0], a[1] / change[1]) * s / (1.0 - s)
                ),
            }[kind]
            assert v <= one.speed * (1.0 + 1e-9)
            nearest.append(v / one.speed)
    assert max(nearest) > 0.97
    narrow = replace(rule, least=2.0 * value)
    assert tell_corner(narrow, speeds, tolerance=10e-6, accelerations=a) == 0.0


def test_a_corner_at_its_speed_leaves_the_tolerance(joined):
    axes = turnings(joined.pair)
    speeds = speeds_at_once(axes, tolerance=10e-6, feed=0.1)
    offs = [corner_deviation(axes, one.angle, one.speed) for one in speeds if one.speed < 0.1]
    assert len(offs) > 3
    assert offs == pytest.approx([10e-6] * len(offs), rel=1e-6)


# The second program


def test_circles_come_out_as_the_second_program_drives_them(joined):
    radius, feed = 10e-3, 0.1
    circle = draw_circles(joined, ((radius, feed),))[0]
    _, worst = worst_circle(joined.pair, np.array([feed / radius]))
    corners = divmod(int(worst[0]), len(joined.pair[1].tuned.corners))
    axes = driven(joined, corners)
    off, _ = circle_off(axes, joined.setpoint_filter, radius=radius, feed=feed)
    assert off.mean() == pytest.approx(circle.radius_deviation, rel=0.01, abs=0.1e-6)
    assert np.ptp(off) == pytest.approx(circle.form_deviation, rel=0.01, abs=0.1e-6)


def test_reversal_peaks_are_those_of_the_second_program_and_below_their_bound(joined):
    radius, feed = 10e-3, 0.05
    x, y = (axis.machine.drive.coulomb_friction for axis in joined.drawn)
    assert x > 0.0
    axes, item = driven(joined), joined.setpoint_filter
    with_friction, angle = circle_off(axes, item, radius=radius, feed=feed, coulomb=(x, y))
    without, _ = circle_off(axes, item, radius=radius, feed=feed)
    peaks = draw_circles(joined, ((radius, feed),))[0].quadrant_peak
    for number, axis in enumerate(joined.drawn):
        near = np.abs(np.angle(np.exp(1j * (angle - 0.5 * pi * number)))) < 0.3
        found = np.abs(with_friction - without)[near].max()
        assert peaks[axis.name] == pytest.approx(found, rel=0.02)
        assert peaks[axis.name] <= axis.follower.peak_bound()


def test_reversals_of_a_slow_loop_are_followed_until_they_are_over():
    """Where an axis reverses fast, friction is a step of force; cut off, 31 % were missing."""
    gains = 'position_gain = 5\nvelocity_gain = "140 kN s/m"\nintegral_time = "0.3 s"'
    text = Y.read_text().replace('kind = "sinumerik"', f'kind = "generic"\n{gains}')
    machine = parse_profile(text.replace("force_filters", "# "), where="slow")
    axis = follow(machine, close_as_held(machine))
    answer = simulate_disturbance(axis.tuned.loops[0], duration=6.0).peak
    step = 2.0 * machine.drive.coulomb_friction * answer
    assert 0.97 * step < np.abs(axis.reversals(((50e-3, 0.1),))).max() <= step


def test_friction_binds_the_feed_where_reversals_reach_the_tolerance(joined):
    """At the feed that is named the peak is the tolerance; it was no bound at all."""
    within = 12e-6
    narrow = replace(joined, task=replace(joined.task, tolerance=within))
    for one in feeds_over_radius(narrow, circle_test(narrow)):
        if one.radius > 20e-3:
            assert (one.bound_by.kind, one.axis) == ("group-bound-friction", "Y")
            peaks = draw_circles(narrow, ((one.radius, one.feed),))[0].quadrant_peak
            assert peaks["Y"] == pytest.approx(within, rel=0.03)
            assert peaks["X"] < within
            # Compensated they would bind no longer.
            assert one.without_peaks is not None
            assert one.without_peaks.feed > one.feed
            assert one.without_peaks.bound_by.kind != "group-bound-friction"
    hopeless = replace(joined, task=replace(joined.task, tolerance=0.1e-6))
    assert {one.feed for one in feeds_over_radius(hopeless, circle_test(hopeless))} == {0.0}


def test_entries_are_those_of_the_second_program(joined):
    """On circles that are slow beside the loop, and on such as it hardly follows."""
    feed, (first, _) = joined.task.feed, joined.pair
    for a in (joined.path.on_circles[0], 5.0):
        radius = feed**2 / a
        ours = radius * np.interp(feed / radius, first.omega, joined.entries)
        offs = [
            entry_off(
                driven(joined, (corner, corner)),
                joined.setpoint_filter,
                radius=radius,
                feed=feed,
                turned=d,
            )
            for d, corner in ((0.0, 5), (0.5 * pi, 3), (0.5 * pi, 0))
        ]
        assert max(offs) <= 1.005 * ours
        assert max(offs) > 0.8 * ours
        assert ours <= joined.allowed or a > joined.path.on_circles[0]


def test_corners_keep_the_tolerance_in_the_second_program(joined):
    speed = next(one for one in corner_speeds(joined) if one.angle_deg == 90.0)
    # The nominal machines, where the corner comes just behind a sample.
    x, y = (
        replace(one, starts=one.starts[1:2], tool=one.tool[1:2, :1], lag=one.lag[:1])
        for one in turnings(joined.pair)
    )
    ours = corner_deviation((x, y), speed.angle, speed.speed, speed.arc_radius)
    offs = [
        corner_off(
            driven(joined),
            joined.setpoint_filter,
            angle=speed.angle,
            arc=speed.arc_radius,
            feed=speed.speed,
            turned=turned,
        )
        for turned in (0.0, 0.25 * pi)
    ]
    assert max(offs) <= joined.allowed
    assert ours == pytest.approx(max(offs), rel=0.02)


def test_lines_in_every_direction_keep_what_was_judged_in_the_second_program(joined):
    """With what the control is told and the limits of the axes: more than both in some."""
    path, feed = joined.path, joined.task.feed
    judged = judge_group(joined, circle_test(joined))[1].value
    assert judged is not None
    ends = hypot(*path.accelerations), hypot(*path.jerks)
    slopes = np.array([pi / 8, np.arctan2(*path.jerks[::-1]), 0.25 * pi])
    along = path.along(slopes)
    assert all((one <= end).all() for one, end in zip(along, ends, strict=True))
    assert along[1].max() > 1.05 * min(path.jerks)
    offs = [
        line_off(
            driven(joined, (corner, corner)),
            joined.setpoint_filter,
            feed=feed,
            acceleration=a,
            jerk=j,
            direction=slope,
        )
        for corner, slope, a, j in zip((0, 3, 5), slopes, *along, strict=True)
    ]
    assert max(offs) <= 1.005 * judged
    assert judged <= joined.task.tolerance


# What is told


def test_lines_at_long_ramps_are_those_of_every_cycle(joined, monkeypatch):
    """Every cycle of ramps of a minute took 10 GB."""
    path = replace(joined.path, acceleration=2e-3, jerk=1e-3)
    thinned = line_deviation(joined.pair, feed=0.05, limits=path)
    monkeypatch.setattr(follow_module, "ALL_LOOKED_AT", 10**9)
    assert line_deviation(joined.pair, feed=0.05, limits=path) == pytest.approx(thinned, rel=5e-3)


def test_axes_come_as_late_as_the_slowest_where_the_control_takes_a_wait():
    """In parts of a cycle, with which circles stay round; without a place for it they are oval."""
    changed = ('frequency = "197.4 Hz", damping', 'frequency = "130 Hz", damping')
    found = join(task_of((changed, GAINS[0], *FEWER), (GAINS[1], *FEWER)))
    first, second = found.pair
    waits = [axis.wait / first.poles.dt for axis in found.pair]
    assert max(abs(wait - round(wait)) for wait in waits) > 0.05
    assert first.delay == pytest.approx(second.delay, abs=0.1e-6)
    assert draw_circles(found, ((50e-3, 0.1),))[0].form_deviation < 2e-6


def test_limits_of_the_path_slow_each_axis_and_its_verdict():
    """All are typed in together: X was called soon enough by its own limits alone."""
    within = ("[requirements]\n", '[requirements]\nmax_settling_time = "410 ms"\n')
    group = join(task_of((within, GAINS[0]), (within, GAINS[1])))
    x, path = group.axes[0], group.path
    assert x.slowed is not None
    # No rest-to-rest move is shorter than at the path's acceleration, without any jerk limit.
    least = max(
        move.max_velocity / path.acceleration + move.distance / move.max_velocity
        if move.max_velocity**2 <= move.distance * path.acceleration
        else 2.0 * sqrt(move.distance / path.acceleration)
        for move in x.machine.moves
        if isinstance(move, Positioning)
    )
    smooth = x.slowed.limits.jerk_time + 8e-3
    assert least < x.slowed.settling_time < least + smooth + 0.1
    assert x.choice.candidate.assessment.is_met
    checks = {check.name: check for check in judge_group(group, circle_test(group))}
    assert not checks["settling time X"].met


def test_axes_that_lag_get_the_position_gain_of_the_slower():
    given = """velocity_cycle = "125 us"
velocity_feedforward = 0.0
acceleration_feedforward = 0.0
velocity_gain = "130 kN s/m"
integral_time = "25 ms"
setpoint_filter = "none"
position_gain = """
    stated = 'velocity_cycle = "125 us"'
    found = join(
        task_of(
            (WITHOUT_CONTOUR, *FEWER, (stated, f'{given}"50 1/s"')),
            (WITHOUT_CONTOUR, *FEWER, (stated, f'{given}"30 1/s"')),
            tolerance="1mm",
            feed="6m/min",
        )
    )
    assert [axis.follower.tuned.controller.position_gain for axis in found.axes] == [30.0, 30.0]
    circle = draw_circles(found, ((50e-3, 0.02),))[0]
    assert circle.radius_deviation == pytest.approx(-(0.02**2) / (0.1 * 30.0**2), rel=0.1)


def test_another_tolerance_than_the_profiles_is_named_and_what_helps_is_next(joined):
    """It was judged beside the profiles' own without a remark, and ended with `export`."""
    words, profiles = Catalogue("en"), [X, Y]
    narrow = replace(joined, task=replace(joined.task, tolerance=8e-6))
    record = build_group_record(narrow, created="today")
    assert "group-other-contours" in {one.kind for one in record.warnings}
    circle, *others = record.assessment.checks
    assert f"--tolerance {ceil(1e6 * circle.value / 0.8)}um" in say_next(record, profiles, words)
    # The peak at the reversal of Y alone is too large.
    thrown = replace(record, assessment=replace(record.assessment, checks=others))
    peak = record.circle[-1].quadrant_peak["Y"]
    step = say_next(thrown, profiles, words)
    assert "friction of Y" in step
    assert f"--tolerance {ceil(1e6 * peak)}um" in step
    own = replace(record.axes[1].assessment, met=False)
    alone = replace(record, axes=[record.axes[0], replace(record.axes[1], assessment=own)])
    assert f"mtcommission run {Y}" in say_next(alone, profiles, words)


# Faults


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('kind = "sinumerik"', 'kind = "fanuc"'), "axes that move together have one control"),
        (('position_cycle = "1 ms"', 'position_cycle = "4 ms"'), "have one cycle"),
        (('axis = "Y"', 'axis = "X"'), "has the name of that in"),
    ],
)
def test_axes_that_cannot_move_together_are_refused(change, words):
    with pytest.raises(InputError, match=words):
        task_of((), (change,))


def test_a_rotary_axis_and_a_single_one_are_refused():
    sources = [read_source(X), read_source(PROFILES / "rotary-table.toml")]
    machines = [parse_profile(one.text, where=str(one.path)) for one in sources]
    with pytest.raises(InputError, match="turns; circles and corners are those of linear axes"):
        read_task(machines, sources)
    with pytest.raises(InputError, match="got 1 profiles"):
        read_task(machines[:1], sources[:1])


def test_tolerance_and_plane_must_be_known():
    without = WITHOUT_CONTOUR
    with pytest.raises(InputError, match="--tolerance 10um"):
        task_of((without,), (without,))
    assert task_of((without,), (without,), tolerance="10um").tolerance == pytest.approx(1e-5)
    assert task_of(plane="YX").plane == (1, 0)
    with pytest.raises(InputError, match="XY"):
        task_of(plane="XZ")
