"""Recorded circles beside the record of a group: what is found, and never a wrong "holds"."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mtcommission.group.record import GroupRecord, read_pair
from mtcommission.group.recorded import read_circular
from mtcommission.group.verify import CircleVerification, foresee, verify_circles
from mtcommission.verify.checks import Check, Verdict
from tests.group_record import driven, mill, mill_record, printer_record, write_mill
from tests.independent_circle import Road, drive
from tests.recorded_circles import Spoilt, draw, write_ballbar, write_csv


@pytest.fixture(scope="module")
def record():
    return mill_record()


def as_planned(record: GroupRecord) -> Spoilt:
    """A circle with the record's delays and gains; that these are right, stepping tells."""
    own = [record.feedforward[name].delay for name in record.plane]
    T = record.filter.time if record.filter else 0.0
    plan = Spoilt(delays=(own[0] + 0.5 * T, own[1] + 0.5 * T))
    return replace(plan, gains=planned_gains(record, plan.feed, plan.radius))


def planned_gains(record: GroupRecord, feed: float, radius: float) -> tuple[float, float]:
    omega = np.array([feed / radius])
    one, other = (abs(axis.response(omega)[0, 0]) for axis in read_pair(record))
    return float(one), float(other)


def verified(record: GroupRecord, folder: Path, *all_of: Spoilt) -> CircleVerification:
    traces = []
    for number, how in enumerate(all_of):
        file = write_csv(folder / f"{number}.csv", draw(how))
        traces.append(read_circular(str(file), {}, record.plane))
    return verify_circles(record, traces)


def find(found: CircleVerification, key: str, mode: str = "", circle: int = 1) -> Check:
    return next(
        one
        for one in found.checks
        if one.key == key and one.move == circle and mode in ("", one.mode)
    )


def test_what_was_put_in_is_found(record, tmp_path):
    plan = as_planned(record)
    late = replace(
        plan,
        delays=(plan.delays[0], plan.delays[0] + 0.3e-3),
        gains=(plan.gains[0] + 80e-6, plan.gains[1] - 40e-6),
        squareness=55e-6,
        peaks=(20e-6, 3e-6),
        centre=(12e-3, -7e-3),
        noise=0.2e-6,
    )
    found = verified(record, tmp_path, late, replace(late, clockwise=True, seed=1))
    assert found.squareness is not None
    assert found.squareness.value == pytest.approx(55e-6, abs=1e-6)
    assert abs(found.squareness.value - 55e-6) <= found.squareness.uncertainty
    for circle in (1, 2):
        delay = find(found, "delay", circle=circle)
        assert delay.measured == pytest.approx(0.3e-3, abs=2e-6)
        assert delay.verdict is Verdict.FAILS
        radius = find(found, "radius", circle=circle)
        mean = 0.5 * sum(late.gains) - 1.0
        assert radius.measured == pytest.approx(50e-3 * mean, abs=0.1e-6)
        form = find(found, "form", circle=circle)
        oval = np.hypot(50e-3 * (late.gains[0] - late.gains[1]), late.feed * 0.3e-3)
        assert form.measured == pytest.approx(oval, abs=0.3e-6)
        assert form.verdict is Verdict.FAILS
        peak = find(found, "quadrant peak", "X", circle)
        assert peak.measured == pytest.approx(20e-6, abs=0.8e-6)
        assert abs((peak.measured or 0.0) - 20e-6) <= (peak.uncertainty or 0.0)
        assert peak.verdict is Verdict.FAILS
        assert find(found, "quadrant peak", "Y", circle).verdict is Verdict.HOLDS
        assert found.circles[circle - 1].fitted.centre == pytest.approx((12e-3, -7e-3), abs=1e-6)
    fitted = [one.fitted for one in found.circles]
    assert [one.direction for one in fitted] == [1, -1]
    assert [one.feed for one in fitted] == pytest.approx([0.1, 0.1], rel=1e-4)
    assert [one.radius for one in fitted] == pytest.approx([50e-3, 50e-3], rel=1e-9)


def test_an_axis_that_waits_is_late_in_either_direction(record, tmp_path):
    """Closed form: delays apart by d make an oval of v d, turned over with the direction."""
    first, second = read_pair(record)
    late = first, replace(second, wait=second.wait + 0.3e-3)
    plan = as_planned(record)
    found = verified(record, tmp_path, plan, replace(plan, clockwise=True))
    for circle in found.circles:
        per = -2.0 * circle.fitted.direction / circle.fitted.feed
        delay = per * (foresee(late, circle.fitted).ellipse - circle.ellipse).imag
        assert delay == pytest.approx(0.3e-3, rel=0.02)


def test_one_direction_does_not_tell_squareness_from_delay(record, tmp_path):
    plan = as_planned(record)
    for spoilt in (
        replace(plan, squareness=100e-6),
        replace(plan, delays=(plan.delays[0], plan.delays[1] + 0.05e-3)),
    ):
        found = verified(record, tmp_path, spoilt)
        assert found.squareness is None
        assert find(found, "delay").verdict is Verdict.UNKNOWN
        assert find(found, "delay").reason.kind == "group-one-direction"
        assert found.verdict is Verdict.UNKNOWN
    both = replace(plan, squareness=100e-6)
    found = verified(record, tmp_path, both, replace(both, clockwise=True))
    assert found.verdict is Verdict.HOLDS


def test_two_feeds_tell_squareness_from_delay(record, tmp_path):
    plan = replace(as_planned(record), squareness=100e-6)
    slow = replace(
        plan, feed=1.0 / 60.0, step=5e-3, turns=1.2, peaks=(3e-6, 3e-6), gains=(1.0, 1.0)
    )
    found = verified(record, tmp_path, plan, slow)
    assert found.squareness is not None
    assert found.squareness.value == pytest.approx(100e-6, abs=2e-6)
    assert found.verdict is Verdict.HOLDS


def test_what_a_scale_may_do_is_not_judged_to_fail(record, tmp_path):
    plan = as_planned(record)
    for gains, verdict in (((50e-6, 20e-6), Verdict.UNKNOWN), ((220e-6, 220e-6), Verdict.FAILS)):
        own = (plan.gains[0] + gains[0], plan.gains[1] + gains[1])
        found = verified(record, tmp_path, replace(plan, gains=own))
        assert find(found, "radius").verdict is verdict
    alone = verified(record, tmp_path, replace(plan, gains=(plan.gains[0] + 50e-6, plan.gains[1])))
    assert find(alone, "radius").reason.kind == "group-may-be-scale"


def test_loops_that_are_stepped_with_friction_keep_their_prediction(record, tmp_path):
    group, traces = mill(), []
    friction = tuple(axis.machine.drive.coulomb_friction for axis in group.drawn)
    R, feed = 20e-3, 3.0 / 60.0
    how = {"feed": feed, "duration": 0.5 + 1.1 * 2.0 * np.pi * R / feed, "coulomb": friction}
    for sign in (1.0, -1.0):
        road = Road(((1.0, sign / R),))
        t, path = drive(driven(group), group.setpoint_filter, road, **how)
        t, (x, y) = t[::8], path[:, ::8]
        x_ref, y_ref = (
            np.array([road.setpoint(feed, 0.0, k)(s)[0] for s in t.tolist()]) for k in (0, 1)
        )
        columns = {"t": t, "x_ref": x_ref, "y_ref": y_ref, "x": x, "y": y}
        file = write_csv(tmp_path / f"stepped{sign:+.0f}.csv", columns)
        traces.append(read_circular(str(file), {}, record.plane))
    found = verify_circles(record, traces)
    assert {one.name: one.verdict for one in found.checks} == {
        one.name: Verdict.HOLDS for one in found.checks
    }
    for circle in (1, 2):
        for axis in "XY":
            peak = find(found, "quadrant peak", axis, circle)
            assert peak.measured == pytest.approx(peak.predicted, rel=0.05)
        radius = find(found, "radius", circle=circle)
        assert radius.measured == pytest.approx(radius.predicted, abs=0.1e-6)
        # The drawn circle, peaks and all, is the stepped one at every sample.
        beside = found.circles[circle - 1]
        assert np.abs(beside.fitted.deviation - beside.predicted).max() < 0.4e-6
        assert np.ptp(beside.predicted) > 10e-6
        delay = find(found, "delay", circle=circle)
        assert delay.measured == pytest.approx(delay.predicted, abs=2e-6)
    assert found.squareness is not None
    assert abs(found.squareness.value) < 5e-6


def test_a_ballbar_tells_the_same(record, tmp_path):
    plan = as_planned(record)
    spoilt = replace(plan, delays=(plan.delays[0] + 0.2e-3, plan.delays[1]))
    files = [
        write_ballbar(tmp_path / "a.csv", draw(spoilt)),
        write_ballbar(tmp_path / "b.csv", draw(replace(spoilt, clockwise=True)), language="de"),
    ]
    traces = [read_circular(str(file), {}, record.plane) for file in files]
    found = verify_circles(record, traces)
    assert [one.fitted.direction for one in found.circles] == [1, -1]
    for circle in (1, 2):
        planned = record.feedforward["Y"].delay - record.feedforward["X"].delay
        delay = find(found, "delay", circle=circle)
        assert delay.measured == pytest.approx(planned - 0.2e-3, abs=2e-6)
    assert {one.kind for one in found.warnings} == {"group-trace-radius"}


def test_a_radius_that_nobody_told_is_not_judged_to_fail(record, tmp_path):
    columns = draw(replace(as_planned(record), gains=(1.001, 1.001)))
    del columns["x_ref"], columns["y_ref"]
    file = write_csv(tmp_path / "alone.csv", columns)
    found = verify_circles(record, [read_circular(str(file), {}, record.plane)])
    assert find(found, "radius").verdict is Verdict.UNKNOWN
    assert find(found, "radius").measured == pytest.approx(50e-6, abs=0.1e-6)


def test_a_motor_that_follows_its_setpoint_has_no_peaks(tmp_path):
    record = printer_record()
    omega = np.array([1e-2])
    response = read_pair(record)[0].response(omega)[0, 0]
    behind = -float(np.angle(response)) / omega[0]
    found = verified(record, tmp_path, Spoilt(delays=(behind, behind), peaks=(0.0, 0.0)))
    assert {one.key for one in found.checks} == {"radius", "form", "delay"}
    assert find(found, "delay").verdict is Verdict.HOLDS


def test_the_command_writes_page_and_verdict(record, tmp_path, run):
    group, plan = write_mill(tmp_path), as_planned(record)
    late = replace(plan, delays=(plan.delays[0], plan.delays[1] + 0.3e-3))
    files = [
        write_csv(tmp_path / "forth.csv", draw(late)),
        write_csv(tmp_path / "back.csv", draw(replace(late, clockwise=True))),
    ]
    code, out, _ = run("verify", group, *files, "-o", tmp_path / "out", "--language", "de")
    assert code == 1
    said = " ".join(out.split())
    assert "Kreis 1: Verzögerung, Y - X" in said
    assert "299,9" in said
    assert "Umkehrspitze" in (tmp_path / "out" / "verification.html").read_text("utf-8")
    entry = json.loads((tmp_path / "out" / "verdict.json").read_text("utf-8"))
    assert entry["verdict"] == "does not hold"
    assert entry["circles"][1]["direction"] == "clockwise"
    by_name = {check["name"]: check for check in entry["checks"]}
    assert by_name["circle 1: Y - X: delay"]["verdict"] == "does not hold"
    assert by_name["circle 2: radius"]["verdict"] == "holds"


def headed(file: Path, head: str) -> Path:
    """Time and positions of a circle, the last of them under some heads."""
    columns, count = draw(Spoilt()), head.count(",") + 1
    rows = np.column_stack([columns["t"], 1e3 * columns["x"], 1e3 * columns["y"]])[:, -count:]
    np.savetxt(file, rows, delimiter=",", header=head, comments="")
    return file


def square(file: Path) -> Path:
    t = draw(Spoilt())["t"]
    side = 4.0 * np.mod(t / t[-1] * 2.3, 1.0)
    x, y = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1], [1, 1]]).T * 0.05
    sides = np.arange(5)
    return write_csv(file, {"t": t, "x": np.interp(side, sides, x), "y": np.interp(side, sides, y)})


def in_metres(file: Path) -> Path:
    """A circle whose y is a thousand times as large."""
    columns = draw(Spoilt())
    return write_csv(file, columns | {"y": 1e3 * columns["y"]})


BROKEN: dict[str, tuple[Callable[[Path], Path], str]] = {
    "no columns": (lambda file: headed(file, "a [s],b [mm]"), "no circle among the columns"),
    "no unit": (lambda file: headed(file, "t [s],angle,radius [mm]"), "angle has no unit"),
    "no angle": (lambda file: headed(file, "t [s],angle [mm],radius [mm]"), "is no angle"),
    "no clock": (lambda file: headed(file, "x [mm],y [mm]"), "sample_time"),
    "an arc": (lambda file: write_csv(file, draw(Spoilt(turns=0.6))), "a whole turn is needed"),
    "a square": (square, "is no circle"),
    "unlike": (in_metres, "y travels 1000 times as far as y_ref"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_named_with_its_remedy(name, tmp_path, run):
    write, said = BROKEN[name]
    file = write(tmp_path / "broken.csv")
    code, _, err = run("verify", write_mill(tmp_path), file)
    assert code == 2
    last = len(file.read_text().splitlines())
    assert (f"broken.csv:{last}:" if name == "an arc" else "broken.csv") in err
    assert said in " ".join(err.split())
