"""Axes that move together: closed forms, a second program, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from math import cos, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from mtcommission.errors import InputError
from mtcommission.group.circle import deviate, filter_response
from mtcommission.group.contours import draw_circle, follow_contours, turnings
from mtcommission.group.corner import NO_ARC, Turning, corner_deviation, speeds_at_once
from mtcommission.group.group import Group, join
from mtcommission.group.record import build_group_record, load_group
from mtcommission.group.rules import junction_speed, largest_step
from mtcommission.group.task import Task, read_task
from mtcommission.group.verdict import judge_group
from mtcommission.machine.setpoint_filter import moving_average
from mtcommission.machine.variations import vary
from mtcommission.profile.read import parse_profile, read_source
from mtcommission.record.files import dump_json
from tests.independent_circle import Driven, circle_off, corner_off, entry_off, line_off

PROFILES = Path(__file__).parent.parent / "profiles"
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


@pytest.fixture(scope="module")
def joined() -> Group:
    return join(task_of())


WITHOUT_CONTOUR = ('contour_deviation = "20 um"\ncontour_feed = "6 m/min"\n', "")


def driven(group: Group, corner: int = 0) -> list[Driven]:
    """The axes of the plane for the second program, in one corner of each."""
    found = []
    for axis in group.drawn:
        machine, tuned = axis.alone.machine, axis.alone.tuned
        wait = axis.wait * tuned.controller.position_cycle
        found.append((vary(machine, tuned.corners[corner]), machine, tuned.controller, wait))
    return found


# Closed forms


@pytest.mark.parametrize(("feed", "radius"), [(0.1, 0.01), (0.05, 0.05)])
def test_an_average_makes_circles_smaller_by_its_square(feed: float, radius: float) -> None:
    T, omega = 0.016, np.array([feed / radius])
    same = filter_response(moving_average(T), omega)
    off = radius * deviate(same, same).radius[0]
    assert off == pytest.approx(-(feed**2) * T**2 / (24.0 * radius), rel=2e-3)


def test_a_lag_makes_circles_smaller_than_its_square_says() -> None:
    feed, radius, Kv = 0.1, 0.01, 1000.0 / 60.0
    lag = 1.0 / (1.0 + 1j * np.array([feed / radius]) / Kv)
    assert radius * deviate(lag, lag).radius[0] == pytest.approx(-1425e-6, abs=1e-6)
    slow = 1.0 / (1.0 + 1j * np.array([0.01 * feed / radius]) / Kv)
    square = -((0.01 * feed) ** 2) / (2.0 * radius * Kv**2)
    assert radius * deviate(slow, slow).radius[0] == pytest.approx(square, rel=1e-4)


def test_delays_apart_make_an_ellipse_of_feed_times_their_difference() -> None:
    feed, radius, apart = 0.1, 0.05, 0.4e-3
    omega = np.array([feed / radius])
    off = deviate(np.exp(-1j * omega * 2e-3), np.exp(-1j * omega * (2e-3 + apart)))
    assert radius * off.form[0] == pytest.approx(feed * apart, rel=1e-6)


@pytest.mark.parametrize("degrees", [45.0, 90.0, 135.0])
def test_a_corner_behind_an_average_alone(degrees: float) -> None:
    T, step, v = 0.016, 1e-4, 0.1
    t = step * np.arange(400)
    tool = np.where(t < T, t**2 / (2.0 * T), t - 0.5 * T)[None, None]
    axis = Turning(step=step, starts=(0.0,), tool=tool, lag=np.array([0.5 * T]))
    angle = degrees * pi / 180.0
    off = corner_deviation((axis, axis), angle, v, NO_ARC)
    assert off == pytest.approx(v * T / 4.0 * sin(0.5 * angle), rel=1e-3)


def test_what_a_control_is_told_keeps_the_speed_of_every_corner(joined: Group) -> None:
    speeds = tuple(speeds_at_once(turnings(joined), tolerance=10e-6, feed=joined.task.feed))
    step, square = largest_step(speeds), junction_speed(speeds)
    s = cos(pi / 4.0)
    q = square**2 * (1.0 - s) / s
    for one in speeds:
        assert step / (2.0 * sin(0.5 * one.angle)) <= one.speed * (1.0 + 1e-9)
        c = cos(0.5 * one.angle)
        assert sqrt(q * c / (1.0 - c)) <= one.speed * (1.0 + 1e-9)


# The second program


def test_circles_come_out_as_the_second_program_drives_them(joined: Group) -> None:
    radius, feed = 10e-3, 0.1
    circle = draw_circle(joined, radius, feed)
    corners = [
        axis.alone.tuned.corners.index(corner)
        for axis, corner in zip(joined.drawn, circle.corner, strict=True)
    ]
    axes = [driven(joined, corner)[number] for number, corner in enumerate(corners)]
    off, _ = circle_off(axes, joined.setpoint_filter, radius=radius, feed=feed)
    assert off.mean() == pytest.approx(circle.radius_deviation, rel=0.01, abs=0.1e-6)
    assert np.ptp(off) == pytest.approx(circle.form_deviation, rel=0.01, abs=0.1e-6)


def test_reversal_peaks_are_those_of_the_second_program_and_below_their_bound(
    joined: Group,
) -> None:
    radius, feed = 10e-3, 0.05
    friction = tuple(axis.alone.machine.drive.coulomb_friction for axis in joined.drawn)
    assert friction[0] > 0.0
    axes, item = driven(joined), joined.setpoint_filter
    with_friction, angle = circle_off(
        axes, item, radius=radius, feed=feed, coulomb=(friction[0], friction[1])
    )
    without, _ = circle_off(axes, item, radius=radius, feed=feed)
    peaks = draw_circle(joined, radius, feed).quadrant_peak
    for number, axis in enumerate(joined.drawn):
        near = np.abs(np.angle(np.exp(1j * (angle - 0.5 * pi * number)))) < 0.3
        found = np.abs(with_friction - without)[near].max()
        assert peaks[axis.name] == pytest.approx(found, rel=0.02)
        assert peaks[axis.name] <= axis.peak_bound


def test_entries_corners_and_lines_keep_the_tolerance_in_the_second_program(
    joined: Group,
) -> None:
    allowed, item = joined.allowed, joined.setpoint_filter
    assert joined.setpoint_filter is not None
    radius = joined.task.feed**2 / joined.acceleration
    for turned, corner in ((0.0, 5), (0.5 * pi, 3)):
        off = entry_off(
            driven(joined, corner), item, radius=radius, feed=joined.task.feed, turned=turned
        )
        assert 0.2 * allowed < off <= allowed
    speed = next(one for one in follow_contours(joined).corners if one.angle == pi / 2)
    nominal = tuple(
        replace(axis, starts=axis.starts[1:2], tool=axis.tool[1:2, :1], lag=axis.lag[:1])
        for axis in turnings(joined)
    )
    ours = corner_deviation((nominal[0], nominal[1]), speed.angle, speed.speed, speed.arc)
    offs = [
        corner_off(
            driven(joined),
            item,
            angle=speed.angle,
            arc=speed.arc.radius,
            feed=speed.speed,
            turned=turned,
        )
        for turned in (0.0, 0.25 * pi)
    ]
    assert max(offs) <= allowed
    assert ours == pytest.approx(max(offs), rel=0.02)
    line = line_off(
        driven(joined),
        item,
        feed=joined.task.feed,
        acceleration=joined.acceleration,
        jerk=joined.jerk,
        direction=0.25 * pi,
    )
    assert line <= allowed


# What is told


def test_no_axis_is_slower_than_alone_with_the_same_filter(joined: Group) -> None:
    for axis in joined.axes:
        control = replace(
            axis.alone.machine.control,
            setpoint_filter=joined.setpoint_filter,
            seeks_setpoint_filter=False,
        )
        machine = replace(axis.alone.machine, control=control)
        own = join_alone(machine, axis)
        assert axis.choice.candidate.settling_time <= 1.01 * own


def join_alone(machine: object, axis: object) -> float:
    """Settling time of an axis alone, with its loop, behind a filter that is given."""
    from mtcommission.study.variations import Row, choose

    found = choose(Row(machine=machine, tuned=axis.alone.tuned))  # type: ignore[arg-type, attr-defined]
    return found.candidate.settling_time


def test_the_filter_is_short_enough_for_circles_and_corners(joined: Group) -> None:
    """Alone the axes would settle soonest behind averages that would halve the feed of a circle."""
    own = [axis.alone.found.choice.limits.setpoint_filter for axis in joined.axes]
    longest = max(item.duration for item in own if item)
    used = joined.setpoint_filter
    assert used is None or used.duration < longest
    checks = judge_group(joined, follow_contours(joined))
    assert all(check.is_met for check in checks)


def test_axes_that_lag_get_the_position_gain_of_the_slower() -> None:
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
            (WITHOUT_CONTOUR, (stated, f'{given}"50 1/s"')),
            (WITHOUT_CONTOUR, (stated, f'{given}"30 1/s"')),
            tolerance="1mm",
            feed="6m/min",
        )
    )
    assert [axis.alone.tuned.controller.position_gain for axis in found.axes] == [30.0, 30.0]
    circle = draw_circle(found, 50e-3, 0.02)
    assert circle.radius_deviation == pytest.approx(-(0.02**2) / (0.1 * 30.0**2), rel=0.1)


# Records and faults


def test_a_group_comes_back_from_its_file(joined: Group, tmp_path: Path) -> None:
    record = build_group_record(joined, created="2026-01-01T00:00:00Z")
    file = tmp_path / "group.json"
    file.write_text(dump_json(record), encoding="utf-8")
    assert load_group(file) == record
    changed = json.loads(file.read_text(encoding="utf-8"))
    changed["path"]["acceleration"] *= 1.1
    file.write_text(json.dumps(changed), encoding="utf-8")
    with pytest.raises(InputError, match="checksum"):
        load_group(file)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('kind = "sinumerik"', 'kind = "fanuc"'), "axes that move together have one control"),
        (('position_cycle = "1 ms"', 'position_cycle = "4 ms"'), "have one cycle"),
        (('axis = "Y"', 'axis = "X"'), "has the name of that in"),
    ],
)
def test_axes_that_cannot_move_together_are_refused(change: Change, words: str) -> None:
    with pytest.raises(InputError, match=words):
        task_of((), (change,))


def test_a_rotary_axis_and_a_single_one_are_refused() -> None:
    sources = [read_source(X), read_source(PROFILES / "rotary-table.toml")]
    machines = [parse_profile(one.text, where=str(one.path)) for one in sources]
    with pytest.raises(InputError, match="turns; circles and corners are those of linear axes"):
        read_task(machines, sources)
    with pytest.raises(InputError, match="got 1 profiles"):
        read_task(machines[:1], sources[:1])


def test_a_tolerance_must_be_known() -> None:
    without = WITHOUT_CONTOUR
    with pytest.raises(InputError, match="--tolerance 10um"):
        task_of((without,), (without,))
    assert task_of((without,), (without,), tolerance="10um").tolerance == pytest.approx(1e-5)


def test_the_plane_names_two_axes() -> None:
    assert task_of(plane="YX").plane == (1, 0)
    with pytest.raises(InputError, match="XY"):
        task_of(plane="XZ")
