"""The example machines: found, readable, honest about their numbers, and able to do their job."""

from __future__ import annotations

import tomllib
from math import pi, sqrt

import pytest

from mtcommission.base.errors import InputError
from mtcommission.base.messages import LANGUAGES
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.machine.checks import check_plausibility
from mtcommission.machine.plant.modal import Modal
from mtcommission.machine.profile import shipped
from mtcommission.machine.profile.shipped import describe_shipped, read_shipped, shipped_names

NAMES = shipped_names()

ROTOR = (0.00636 + 2 * 0.000655 + 0.001973) * (2 * pi / 0.03) ** 2
SCREW = 1 / (1.4 / (pi / 4 * 0.063**2 * 2.06e11) + 1 / 2e9 + 1 / 1e9)
"""Of the ball screw: motor, couplings and screw as a mass [kg]; screw, nut and bearing [N/m]."""


@pytest.mark.parametrize("name", NAMES)
def test_every_number_has_a_source_and_nothing_is_unusual(name):
    """An example that triggers warnings teaches people to ignore warnings."""
    profile = read_shipped(name)
    assert profile.machine.source.strip()
    assert profile.machine.illustrative or "Table 1" in profile.machine.source
    assert check_plausibility(profile.machine) == ()
    for language in LANGUAGES:
        shown = describe_shipped(profile, Catalogue(language))
        assert max(map(len, shown.splitlines())) <= 80
        told = " ".join(shown.split())
        assert profile.machine.name in told
        assert profile.machine.source in told or language != "en"


@pytest.mark.parametrize(
    ("name", "motor", "load", "held_hz"),
    [
        ("rack-gantry", 320.0, 1150.0, 19.0),
        ("rotary-table", 1.9, 6.4, 62.0),
        ("ball-screw", ROTOR, 2500.0, sqrt(SCREW / 2500.0) / (2.0 * pi)),
    ],
)
def test_derivations_in_the_comments_give_the_numbers(name, motor, load, held_hz):
    """Two masses and a spring, as each file's head derives them, to the digits printed."""
    machine = read_shipped(name).machine
    (mode,) = machine.mechanics.modes
    assert isinstance(machine.mechanics, Modal)
    whole = motor + load
    assert machine.mechanics.moving_mass == pytest.approx(whole, rel=1e-3)
    assert mode.frequency_hz == pytest.approx(held_hz * sqrt(1.0 + load / motor), rel=1e-3)
    assert mode.tcp_gain == pytest.approx(-1.0 / whole, rel=1e-3)
    assert mode.measured_gain == pytest.approx(load / (motor * whole), rel=1e-3)


def test_the_printer_is_what_its_comment_derives():
    """Held motor: the export must write what an accelerometer shows, not the free frequency."""
    machine = read_shipped("printer-belt").machine
    radius = 0.04 / (2.0 * pi)
    of_torque = 0.2 / radius / (54e-7 / radius**2 + 0.45)
    assert machine.drive.follows
    assert of_torque - 1.0 < machine.drive.max_force <= of_torque
    (mode,) = machine.mechanics.modes
    assert mode.frequency_hz == pytest.approx(48.0)
    assert machine.drive.max_velocity == pytest.approx(1.25)


def test_list_show_and_copy(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, listed, _ = run("profiles", "list")
    assert code == 0
    assert [line for line in listed.splitlines() if not line.startswith(" ")] == list(NAMES)
    _, shown, _ = run("profiles", "show", "rotary-table")
    assert tomllib.loads(shown)["machine"]["motion"] == "rotary"
    assert run("profiles", "copy", "rotary-table")[0] == 0
    assert (tmp_path / "rotary-table.toml").read_text("utf-8") == shown
    code, _, error = run("profiles", "copy", "rotary-table")
    assert code == 2
    assert "exists already" in error
    assert run("profiles", "copy", "rotary-table.toml", "mine.toml")[0] == 0
    code, _, error = run("profiles", "show", "rotary-tabel")
    assert code == 2
    assert 'did you mean "rotary-table"' in error


def test_profiles_inside_the_package_are_found_first(tmp_path, monkeypatch):
    """A wheel puts them into the package; nothing lies beside it then."""
    package = tmp_path / "mtcommission"
    (package / "profiles").mkdir(parents=True)
    (package / "profiles" / "only.toml").write_text(read_shipped(NAMES[0]).text, "utf-8")
    monkeypatch.setattr(shipped, "__file__", str(package / "machine" / "profile" / "shipped.py"))
    assert shipped_names() == ("only",)
    with pytest.raises(InputError, match="there are only"):
        read_shipped("rotary-table")
