"""What was measured travels from identify by the profile into the record and onto the sheet.

If one of these fails, a sheet states intervals of another measurement, or hides that a value was
changed, assumed, or that a file is missing.
"""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.choose import choose_limits
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.profile.read import parse_profile
from mtcommission.record.identified import IdentifiedPart, read_evidence
from mtcommission.record.record import Record
from mtcommission.record.shape import to_entry, to_plain
from mtcommission.sheet.document import Section
from mtcommission.sheet.html import set_html
from mtcommission.sheet.identified import identified
from mtcommission.sheet.loop import bode
from mtcommission.study.improvements import value_tool_sensor
from tests.sheet_record import compose, example_record
from tests.test_identify import table_file

REST = """
[drive]
force_lag = "0.6 ms"
max_force = "2.4 kN"

[[moves]]
distance = "15 mm"
max_velocity = "0.4 m/s"
"""


@pytest.fixture
def profile(run, tmp_path):
    """Identified from an encoder alone, and completed."""
    path = tmp_path / "axis.toml"
    code, _, errors = run("identify", table_file(tmp_path / "e.csv"), "-o", str(path))
    assert code == 0, errors
    text = path.read_text().replace("[requirements]", '[requirements]\ntcp_deviation = "8 um"')
    path.write_text(text + REST)
    return path


def _machine(profile: Path) -> Machine:
    return parse_profile(profile.read_text(), where="axis.toml")


def _part(profile: Path) -> IdentifiedPart:
    found = read_evidence(_machine(profile), profile.parent)
    assert found is not None
    return found


def _record(part: IdentifiedPart, **plant) -> Record:
    """A record whose plant has what was measured, but for some changes."""
    record = to_entry(example_record(), Record)
    modes = [
        replace(
            record.plant.modes[0],
            name=mode.name,
            frequency_hz=mode.frequency_hz.value,
            damping_ratio=mode.damping_ratio.value,
            tcp_gain=-0.0077,
        )
        for mode in part.modes
    ]
    mass = part.moving_mass.value
    plant = {"modes": modes, "moving_mass": mass} | plant
    return replace(record, identified=part, plant=replace(record.plant, **plant))


def _section(part: IdentifiedPart, language: str = "en", **plant) -> str:
    """Its section on paper."""
    blocks = tuple(identified(_record(part, **plant), Catalogue(language)))
    heading = Catalogue(language).text("identified-heading")
    section = Section(key="identified", heading=heading, blocks=blocks)
    document = compose(example_record())
    return set_html(replace(document, sections=(section,)))


def test_the_file_beside_the_profile_carries_points_and_states(profile):
    part, entry = _part(profile), json.loads((profile.parent / "axis.identified.json").read_text())
    (response,) = part.responses
    assert response.unit == "(m/s)/N"
    assert 100 < len(response.frequency_hz) <= 300
    # A peak that is two lines wide is among the points.
    mode = part.modes[0]
    reach = mode.damping_ratio.value * mode.frequency_hz.value
    assert sum(abs(f - mode.frequency_hz.value) < reach for f in response.curve_hz) > 20
    assert to_plain(part) == {key: entry[key] for key in to_plain(part)}


def test_without_that_file_the_profile_alone_has_the_intervals_and_the_sheet_says_so(profile):
    whole = _part(profile)
    beside = profile.parent / "axis.identified.json"
    text = beside.read_text()
    beside.unlink()
    alone = _part(profile)
    assert [one.kind for one in alone.warnings] == ["identified-evidence-missing"]
    for one, other in zip(alone.modes, whole.modes, strict=True):
        assert one.frequency_hz.value == pytest.approx(other.frequency_hz.value, rel=1e-5)
        assert one.frequency_hz.sigma == pytest.approx(other.frequency_hz.sigma, rel=1e-2)
    assert alone.sources == whole.sources
    beside.write_text(text.replace('"misfit": 0', '"misfit": 9', 1))
    assert [one.kind for one in _part(profile).warnings] == ["identified-evidence-differs"]
    assert "axis.identified.json" in _section(_part(profile))


def test_the_loop_with_the_measured_axis_differs_by_measured_over_fitted(profile):
    """Points that are 6 dB above the fitted curve lie 6 dB above the loop of the model."""
    part = _part(profile)
    (response,) = part.responses
    place = np.log(response.frequency_hz), np.log(response.curve_hz)
    fitted = np.interp(*place, response.curve_magnitude)
    phase = np.interp(*place, response.curve_phase_deg) - 350.0
    shifted = replace(response, magnitude=(2.0 * fitted).tolist(), phase_deg=phase.tolist())
    record = _record(replace(part, responses=[shifted]))
    panels, model = bode(record, Catalogue("en")).panels, record.loop.bode
    signals = ("open_loop_db", "open_loop_deg")
    for panel, signal, apart in zip(panels, signals, (20.0 * np.log10(2.0), 10.0), strict=True):
        (measured,) = (line for line in panel.lines if "e.csv" in line.label)
        assert measured.x.size > 50
        expected = np.interp(np.log(measured.x), np.log(model.t), model.signals[signal])
        difference = (measured.y - expected + 180.0) % 360.0 - 180.0
        np.testing.assert_allclose(difference, apart, atol=0.6)  # between their points


def test_what_was_changed_by_hand_is_told(profile):
    part = _part(profile)
    first = part.modes[0]
    mode = replace(
        to_entry(example_record(), Record).plant.modes[0],
        name=first.name,
        frequency_hz=1.1 * first.frequency_hz.value,
        damping_ratio=first.damping_ratio.value,
    )
    # The sheet's record states 5.2 %, less than an identified axis may ask for.
    wide = replace(part, spread=replace(part.spread, frequency=0.08))
    page = _section(wide, modes=[mode], moving_mass=2.0 * part.moving_mass.value)
    assert "mode1 was changed by hand: Frequency" in page
    assert "mass was changed by hand" in page
    assert "mode2 was measured, but no mode of the profile has this name" in page
    assert "the corners hold ± 5.2 %" in page.replace("\u202f", " ").replace("\xa0", " ")


def test_wrong_values_in_what_was_measured_are_named_with_their_line(profile):
    document = tomlkit.parse(profile.read_text())
    document["identified"]["modes"][0]["frequency"] = ["38 kg", "1 Hz"]  # type: ignore[index]
    document["identified"]["misfits"] = 1.0  # type: ignore[index]
    with pytest.raises(Exception, match=r"identified\.modes\[1\]\.frequency\[1\]") as caught:
        parse_profile(tomlkit.dumps(document), where="axis.toml")
    assert "identified.misfits" in str(caught.value)


def test_merging_again_replaces_what_was_measured_and_follows_renamed_modes(run, profile, tmp_path):
    profile.write_text(profile.read_text().replace('"mode1"', '"beam"'))
    files = [table_file(tmp_path / "e2.csv", seed=7)]
    again = tmp_path / "again.toml"
    code, _, errors = run("identify", *files, "--profile", str(profile), "-o", str(again))
    assert code == 0, errors
    text = again.read_text()
    data = tomllib.loads(text)
    # The worst case at the tool was an assumption: it follows the mass that was measured now.
    for mode in data["plant"]["modes"]:
        mass = float(data["plant"]["moving_mass"].split()[0])
        assert float(mode["tcp_gain"].split()[0]) == pytest.approx(-1.0 / mass, rel=1e-4)
    shares = {f"plant.modes[{number}].tcp_gain" for number in (1, 2)}
    spreads = {f"requirements.{kind}_spread" for kind in ("frequency", "damping")}
    assert set(data["machine"]["assumed"]) == shares | spreads
    assert data["machine"]["source"].startswith("identified from e2.csv on ")
    assert text.count("SHA-256") == 1
    assert [one["name"] for one in data["identified"]["modes"]] == ["beam", "mode2"]
    assert [one["name"].rpartition("/")[2] for one in data["identified"]["files"]] == ["e2.csv"]
    assert data["identified"]["evidence"] == "again.identified.json"
    part = read_evidence(_machine(again), tmp_path)
    assert [mode.name for mode in part.modes] == ["beam", "mode2"]
    assert part.responses


def test_a_sensor_at_the_tool_frees_what_the_worst_case_costs(profile):
    machine = _machine(profile)
    tuned = tune_loop(machine)
    choice = choose_limits(machine, tuned)
    freed = value_tool_sensor(machine, tuned, choice)
    assert freed is not None
    assert freed.modes == ("mode1", "mode2")
    assert freed.settling_time == choice.candidate.settling_time
    # A second way: limits for the machine whose tool stands still, from scratch.
    assert isinstance(machine.mechanics, Modal)
    modes = tuple(replace(mode, tcp_gain=0.0) for mode in machine.mechanics.modes)
    still = replace(machine, mechanics=replace(machine.mechanics, modes=modes))
    least = choose_limits(still, tune_loop(still))
    assert freed.least == pytest.approx(least.candidate.settling_time, rel=0.03)
    known = replace(machine, assumed=())
    assert value_tool_sensor(known, tuned, choice) is None
