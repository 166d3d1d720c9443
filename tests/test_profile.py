from __future__ import annotations

import re
from math import inf, pi
from pathlib import Path

import pytest

from mtcommission.base.errors import Fault, InputError
from mtcommission.controls.kind import PositionLoop
from mtcommission.controls.kinds import KINDS
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Motion
from mtcommission.machine.moves import Positioning, VelocityStep
from mtcommission.machine.profile.read import parse_profile, read_profile
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.requirements import NO_RESERVE, Reserve
from mtcommission.machine.setpoint_filter import SetpointFilter
from tests.machines import paper_machine
from tests.profile_page import PAGE, write_page

MILLING = read_shipped("milling-manipulator").text

MANIPULATOR = """\
schema = 1
[machine]
name = "m"
axis = "X"
source = "s"
[plant]
kind = "manipulator"
base_mass = "450 kg"
slider_mass = "750 kg"
rotary_inertia = "40 kg m^2"
lever_arm = "0.25 m"
tcp_height = "0.21 m"
base_stiffness = "44.41 N/um"
base_damping = "8500 N s/m"
rotary_stiffness = "8.2e6 N m/rad"
rotary_damping = "1800 N m s/rad"
[drive]
force_lag = "2.5 ms"
max_force = "2 kN"
[[moves]]
velocity_step = "0.1 m/s"
[requirements]
tcp_deviation = "5 um"
"""
"""Line 8 is base_mass, 19 max_force, 21 velocity_step, 23 tcp_deviation, 24 the end."""

MODAL = """\
schema = 1
[machine]
name = "m"
axis = "X"
source = "s"
[plant]
kind = "modal"
moving_mass = "300 kg"
[[plant.modes]]
name = "beam"
frequency = "40 Hz"
damping_ratio = 0.02
tcp_gain = "2e-3 1/kg"
[[plant.modes]]
name = "ram"
frequency = "80 Hz"
damping_ratio = "3 %"
tcp_gain = "-2e-3 1/kg"
[drive]
force_lag = "2.5 ms"
max_force = "2 kN"
[[moves]]
velocity_step = "0.1 m/s"
[requirements]
tcp_deviation = "5 um"
"""


def faults_in(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_profile(text, where="p.toml")
    return [str(fault) for fault in caught.value.faults]


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new)


# What a whole profile says


def test_a_table_that_is_assumed_covers_its_keys():
    text = changed(MODAL, 'source = "s"', 'source = "s"\nassumed = ["plant.modes", "drive"]')
    machine = parse_profile(text, where="p.toml")
    assert machine.is_assumed("plant.modes[1].frequency")
    assert machine.is_assumed("drive.max_force")
    assert not machine.is_assumed("plant.moving_mass")
    assert not machine.is_assumed("drives")


def test_the_milling_profile_is_table_1_christiansen_maurer_zirn():
    machine, paper = read_shipped("milling-manipulator").machine, paper_machine()
    assert machine.mechanics == paper.mechanics
    assert machine.drive == paper.drive
    assert machine.moves == paper.moves
    assert machine.requirements.tcp_deviation == paper.requirements.tcp_deviation
    assert machine.requirements.modes.surface == pytest.approx(2e-6)
    assert machine.requirements.peaks == ()
    assert machine.damping_optimal.t_f == 0.0522
    weights = {weight.name: weight.value for weight in machine.damping_optimal.weights}
    assert weights == {"x_b": 1.8858e15, "phi": 1.0961e15, "v_b": 8.6070e10, "v_phi": 2.8505e10}


def test_every_key_of_the_interface_reaches_the_machine():
    text = changed(MANIPULATOR, '"2 kN"\n', '"2 kN"\nlead = "10 mm"\ngear = 2\n')
    text += """\
max_settling_time = "0.2 s"
contour_deviation = "20 um"
contour_feed = "3 m/min"
reserve = { band = "70 %" }
frequency_spread = "5 %"
damping_spread = 0.1
payload = ["0 kg", 100]
payload_radius = "300 mm"
[requirements.peaks]
v_phi = "5 mrad/s"
tcp_vibration = "20 um"
F = "1.5 kN"
[requirements.modes]
surface = "2.5 um"
[damping_optimal]
t_f = "60 ms"
weights = "balanced"
[control]
kind = "state-space"
position_loop = "interpolated"
position_gain = "3 (m/min)/mm"
velocity_gain = "200 kN s/m"
integral_time = "20 ms"
velocity_feedforward = 0.9
acceleration_feedforward = 1
jerk_feedforward = "50 %"
feedforward_mass = "800 kg"
reference_delay = "3 ms"
position_cycle = "1 ms"
velocity_cycle = "250 us"
tcp_sensor = "position"
state_feedback = { v_phi = "1e4 N s/rad", phi = -2e5 }
setpoint_filter = { kind = "moving_average", time = "20 ms" }
force_filters = [{ kind = "notch", frequency = "72 Hz", damping = 0.1 }]
minimum_bandwidth = "15 Hz"
[[moves]]
distance = "20 mm"
max_velocity = "30 m/min"
dwell = 1
[[moves]]
distance = 0.5
[today]
acceleration = "2 m/s^2"
jerk = "40 m/s^3"
position_gain = "60 1/s"
integral_time = "20 ms"
setpoint_filter = { kind = "moving_average", time = "20 ms" }
"""
    machine = parse_profile(text, where="p.toml")
    assert machine.moves == (
        VelocityStep(velocity_step=0.1),
        Positioning(distance=0.02, max_velocity=0.5, dwell=1.0),
        Positioning(distance=0.5),
    )
    (notch,) = machine.control.force_filters
    assert notch == ForceFilter(
        kind="notch", natural_frequency=pytest.approx(144 * pi), damping=0.1
    )
    needs, weights = machine.requirements, machine.damping_optimal
    assert (weights.t_f, weights.weights) == (0.06, ())
    assert {peak.name: peak.value for peak in needs.peaks} == PEAKS
    assert {gain.name: gain.value for gain in machine.control.state_gains} == GAINS
    for table, values in ((needs, NEEDS), (needs.modes, BANDS), (machine.control, CONTROL),
                          (machine.drive, DRIVE), (machine.today, TODAY)):  # fmt: skip
        assert {key: getattr(table, key) for key in values} == values


PEAKS = {"v_phi": 5e-3, "tcp_vibration": 20e-6, "F": 1500.0}
GAINS = {"v_phi": 1e4, "phi": -2e5}
NEEDS = {"max_settling_time": 0.2, "frequency_spread": 0.05, "damping_spread": 0.1,
         "payload": (0.0, 100.0), "payload_radius": 0.3, "contour_deviation": 20e-6,
         "contour_feed": pytest.approx(0.05), "reserve": Reserve(band=0.7, force=0.95)}  # fmt: skip
BANDS = {"surface": 2.5e-6, "accuracy": 5e-6, "speed": 20e-6}
DRIVE = {"lead": 0.01, "gear": 2.0}
AVERAGE = SetpointFilter(kind="moving_average", time=0.02)
CONTROL = {"position_gain": pytest.approx(50.0), "velocity_gain": 200e3, "integral_time": 0.02,
           "velocity_feedforward": 0.9, "acceleration_feedforward": 1.0, "jerk_feedforward": 0.5,
           "feedforward_mass": 800.0, "reference_delay": 3e-3, "position_cycle": 1e-3,
           "velocity_cycle": 250e-6, "has_tcp_sensor": True, "setpoint_filter": AVERAGE,
           "state_feedback": StateFeedback.GIVEN, "minimum_bandwidth_hz": 15.0,
           "position_loop": PositionLoop.INTERPOLATED, "seeks_setpoint_filter": False}  # fmt: skip
TODAY = {"acceleration": 2.0, "jerk": 40.0, "position_gain": 60.0, "integral_time": 0.02,
         "setpoint_filter": AVERAGE}  # fmt: skip


def test_a_rotary_axis_takes_inertia_torque_and_angle():
    text = (
        MODAL.replace('axis = "X"', 'axis = "C"\nmotion = "rotary"')
        .replace('"300 kg"', '"3 kg m^2"')
        .replace('"2e-3 1/kg"', '"0.2 1/(kg m^2)"')
        .replace('"-2e-3 1/kg"', '"-0.2 rad/(N m s^2)"')
        .replace('"2 kN"', '"200 Nm"')
        .replace('"0.1 m/s"', '"30 rev/min"')
        .replace('"5 um"', '"1 arcsec"')
    )
    machine = parse_profile(text + '[requirements.peaks]\nq_beam = "1 N m s^2"\n', where="p.toml")
    assert machine.motion is Motion.ROTARY
    assert machine.moves == (VelocityStep(velocity_step=pytest.approx(pi)),)
    assert machine.requirements.tcp_deviation == pytest.approx(pi / 648000)
    assert faults_in(text.replace("30 rev/min", "0.1 m/s")) == [
        'p.toml:24: moves[1].velocity_step: got "0.1 m/s"; must be in rad/s, deg/s or rev/min'
    ]


def test_spreads_reserve_and_kind_are_assumed_unless_stated():
    """None of them must be silently nothing: limits without spread break with 1 % of frequency."""
    machine = parse_profile(MANIPULATOR, where="p.toml")
    needs = machine.requirements
    assert (needs.frequency_spread, needs.damping_spread) == (0.05, 0.3)
    assert needs.reserve == Reserve(band=0.8, force=0.95)
    assert (needs.contour_deviation, needs.contour_feed) == (inf, inf)
    for text in ("", '[control]\nsetpoint_filter = "auto"\n'):
        found = parse_profile(MANIPULATOR + text, where="p.toml").control
        assert (found.seeks_setpoint_filter, found.setpoint_filter) == (True, None)
    for key in ("requirements.frequency_spread", "requirements.damping_spread", "control.kind"):
        assert machine.is_assumed(key)
    stated = MANIPULATOR + (
        'frequency_spread = 0\ndamping_spread = "0 %"\nreserve = { band = 1, force = "100 %" }\n'
        '[control]\nkind = "fanuc"\n'
    )
    machine = parse_profile(stated, where="p.toml")
    assert (machine.requirements.frequency_spread, machine.requirements.damping_spread) == (0, 0)
    assert machine.requirements.reserve == NO_RESERVE
    assert machine.assumed == (
        "drive.static_load",
        "control.position_cycle",
        "control.velocity_cycle",
    )


def test_a_rest_and_the_place_of_the_loop_are_assumed_where_they_decide():
    """A rest heats only a motor whose heat is limited; DSC only where there is a choice."""
    heated = MANIPULATOR.replace("[drive]\n", '[drive]\ncontinuous_force = "900 N"\n')
    assert parse_profile(heated, where="p.toml").is_assumed("moves[1].dwell")
    assert not parse_profile(MANIPULATOR, where="p.toml").is_assumed("moves[1].dwell")
    stated = re.sub(r"(\[\[moves\]\]\n)", r'\1dwell = "0 s"\n', heated)
    assert not parse_profile(stated, where="p.toml").is_assumed("moves[1].dwell")
    for kind, has_choice in (("sinumerik", True), ("fanuc", False)):
        assert (len(KINDS[kind].position_loops) > 1) is has_choice
        machine = parse_profile(f'{MANIPULATOR}[control]\nkind = "{kind}"\n', where="p.toml")
        assert machine.is_assumed("control.position_loop") is has_choice


# Broken profiles: the exact message


FAULTS = r"""
"450 kg"  ->  "-450 kg"
  8: plant.base_mass: got -450 kg, must be > 0 kg
"450 kg"  ->  nan
  8: plant.base_mass: got nan, must be a finite number
"450 kg"  ->  true
  8: plant.base_mass: got true, must be in kg, g or t
"450 kg"  ->  4.5e9
  8: plant.base_mass: got 4.5e+09 kg, must be from 0.001 to 1e+06 kg; check the unit
base_mass =  ->  # base_mass =
  6: plant.base_mass: missing; add the value of your machine, for example base_mass = "450 kg"
"0.25 m"  ->  "0 mm"
  11: plant.lever_arm: got 0, but the force must turn the tower; give the arm, or describe the
    axis as kind = "modal"
"8500 N s/m"  ->  "300 kN s/m"
  14: plant.base_damping: got 300 kN s/m, a damping ratio of 1.06; must be < 2.827e+05 N s/m
    (ratio 1)
source = "s"  ->  source = "s"\nassumed = ["drive.max_force", "drive.force_lg"]
  6: machine.assumed[2]: got "drive.force_lg", which is not stated here; did you mean
    "drive.force_lag"?
source = "s"  ->  source = "s"\nillustrative = 1
  6: machine.illustrative: got 1, must be true or false
"2 kN"  ->  "2 kN"\nstatic_load = -2000
  20: drive.static_load: got -2000 N against max_force = 2 kN; its amount must be smaller, or
    no force is left for motion
"0.1 m/s"  ->  "0.1 m/s"\nmax_velocity = 1
  22: moves[1].max_velocity: belongs to a move with distance; give distance, or remove it
"0.1 m/s"  ->  "0.1 m/s"\ndistance = 1
  20: moves[1]: got both of velocity_step and distance, give exactly one
"5 um"  ->  "5 um"\nfrequency_spread = "60 %"
  24: requirements.frequency_spread: got 60 %, must be from 0 to 0.5 (50 %)
"5 um"  ->  "5 um"\ndamping_spread = 1
  24: requirements.damping_spread: got 1, must be >= 0 and < 1
"5 um"  ->  "5 um"\npayload = ["100 kg", "0 kg"]
  24: requirements.payload: got 100 kg to 0 kg, the least comes first
"5 um"  ->  "5 um"\npayload = ["0 kg"]
  24: requirements.payload: got 1 elements, at least 2 needed
"5 um"  ->  "5 um"\npeaks = { v_fi = 1 }
  24: requirements.peaks.v_fi: no such signal; did you mean "v_phi"?
"5 um"  ->  "5 um"\n[damping_optimal]\nweights = { tcp = 1 }
  25: damping_optimal.weights.tcp: no such signal; there are x_b, x_s, phi, v_b, v_s, v_phi, F
"5 um"  ->  "5 um"\n[control]\nposition_cycle = "1 ms"\nvelocity_cycle = "300 us"
  25: control.position_cycle: got 1 ms, 3.33333 times velocity_cycle = 300 us; must be a
    whole multiple
"5 um"  ->  "5 um"\n[control]\nstate_feedback = "on"
  25: control.state_feedback: got "on", must be "auto" or "off" or a table of signals
"5 um"  ->  "5 um"\n[control]\nkind = "sinumerik"\nsetpoint_filter = { kind = "second_order", time = "40 ms" }
  26: control.setpoint_filter.kind: got "second_order": behind such a filter a setpoint never
    ends, so no time of settling and no proof for every size of move could be stated; choose
    another kind, or "none" with the filter off in the control
"5 um"  ->  "5 um"\n[control]\nkind = "sinumerik"\nsetpoint_filter = { kind = "moving_average", time = "1 ms" }
  26: control.setpoint_filter.time: got 1 ms; kind = "sinumerik" takes 0.002 to 1 s here
"5 um"  ->  "5 um"\n[control]\nkind = "marlin"\nsetpoint_filter = { kind = "marlin_ei", frequency = "12 Hz", damping = 0.1 }
  26: control.setpoint_filter.frequency: got 12 Hz; kind = "marlin" takes 20 to 500 Hz
    here
"5 um"  ->  "5 um"\n[control]\nreference_delay = "soon"
  25: control.reference_delay: got "soon", which does not begin with a number; must be in
    s, ms, us or min, or "auto"
schema = 1  ->  schema = 2
  1: schema: got 2, must be 1
schema = 1  ->  #
  1: schema: missing; add schema = 1
name = "m"  ->  name = " "
  3: machine.name: got an empty text, give a name
name = "m"  ->  name = "MMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMMM"
  3: machine.name: got 81 characters, at most 80 are allowed
name = "m"  ->  name = "m\u0007"
  3: machine.name: got control characters, remove them
name = "m"  ->  name = 7
  3: machine.name: got 7, must be a text in quotes
"2 kN"  ->  "2 kN"\ngear = 2
  20: drive.gear: a gear on a linear axis needs drive.lead (travel per turn of screw or pinion)
    beside it; give both, or remove it
"5 um"  ->  "5 um"\ncontour_feed = "3 m/min"
  24: requirements.contour_feed: belongs to contour_deviation; give that, or remove it
"450 kg"\nslider_mass  ->  "-450 kg"\nslidermass
  8: plant.base_mass: got -450 kg, must be > 0 kg
  9: plant.slidermass: unknown key; did you mean "slider_mass", which is missing?
kind = "manipulator"\nbase_mass = "450 kg"  ->  kind = "manipulater"\nbase_mass = "450 m"
  7: plant.kind: got "manipulater", must be "manipulator" or "modal"; did you mean
    "manipulator"?
  8: plant.base_mass: got "450 m"; must be in kg, g or t
kind = "manipulator"\nbase_mass = "450 kg"  ->  base_mass = "450 m"
  6: plant.kind: missing; add kind = "manipulator", to which the other keys belong
  7: plant.base_mass: got "450 m"; must be in kg, g or t
"2 kN"  ->  0,25
  19: no TOML: max_force = 0,25 ; mend this line or the one above: texts and values with a unit
    stand in quotes, numbers take a point, brackets are closed, and a key stands once
"2 kN"  ->  ["2 kN"
  20: no TOML: [[moves]] ; mend this line or the one above: texts and values with a unit stand
    in quotes, numbers take a point, brackets are closed, and a key stands once
"2 kN"  ->  “2 kN”
  19: no TOML: max_force = “2 kN” ; mend this line or the one above: texts and values with a
    unit stand in quotes, numbers take a point, brackets are closed, and a key stands once
"2 kN"  ->  "2 kN"\nmax_force = 2
  20: no TOML: max_force = 2 ; mend this line or the one above: texts and values with a unit
    stand in quotes, numbers take a point, brackets are closed, and a key stands once
"5 um"  ->  "5 um"\n[control]\nkind = "fluidnc"\nstate_feedback = "auto"\njerk_feedforward = 1\nreference_delay = "1 ms"\ntcp_sensor = "position"\nposition_loop = "control"\nsetpoint_filter = { kind = "moving_average", time = "20 ms" }\nforce_filters = [{ kind = "notch", frequency = "72 Hz", damping = 0.1 }]
  26: control.state_feedback: kind = "fluidnc" has no state feedback; leave the key out
  27: control.jerk_feedforward: got 1; kind = "fluidnc" has only velocity_feedforward; write 0,
    or leave the key out
  28: control.reference_delay: kind = "fluidnc" has no balancing of the setpoint; leave the key
    out
  29: control.tcp_sensor: kind = "fluidnc" has no state feedback; leave the key out
  30: control.position_loop: got "control"; kind = "fluidnc" closes its position loop otherwise:
    write "drive", or leave the key out
  31: control.setpoint_filter: got "moving_average"; kind = "fluidnc" has no such setpoint
    filter: write "none"
  32: control.force_filters: got 1 filters; kind = "fluidnc" has 0 in the torque setpoint; write
    no more
"5 um"  ->  "5 um"\n[control]\nkind = "fluidnc"\n[today]\nacceleration = 1\njerk = 10
  28: today.jerk: kind = "fluidnc" has no jerk limit; leave the key out
"5 um"  ->  "5 um"\n[control]\nposition_gain = "5 kg"\nsetpoint_filter = { kind = "fir", taps = [0.5, 0.4], frequency = "1 m", zzz = 1 }\n[today]\nacceleration = 1\njerk = "1 kg"\nsetpoint_filter = { kind = "moving_average", damping = 7 }
  25: control.position_gain: got "5 kg"; must be in 1/s or (m/min)/mm
  26: control.setpoint_filter.spacing: missing: a filter with kind = "fir" needs it
  26: control.setpoint_filter.frequency: means nothing to a filter with kind = "fir": remove it
  26: control.setpoint_filter.zzz: unknown key; there are kind, time, second_time, frequency,
    damping, taps, spacing
  26: control.setpoint_filter.taps: got taps whose sum is 0.9, must be 1, or the axis would not
    arrive where it should: divide each by the sum
  29: today.jerk: got "1 kg"; must be in m/s^3 or mm/s^3
  30: today.setpoint_filter.time: missing: a filter with kind = "moving_average" needs it
  30: today.setpoint_filter.damping: means nothing to a filter with kind = "moving_average":
    remove it
"""  # noqa: E501
"""What is changed in the profile of the manipulator, and below it the line and what is said."""

FAULTS_OF_MODES = r"""
damping_ratio = 0.02  ->  damping_ratio = 1
  12: plant.modes[1].damping_ratio: got 1, must be >= 0 and < 1
"ram"  ->  "beam"
  15: plant.modes[2].name: got "beam" twice, names must differ
"ram"  ->  "the ram"
  15: plant.modes[2].name: got "the ram", must be letters, digits and _, not beginning with a
    digit
"2e-3 1/kg"  ->  "2e-3 kg"
  13: plant.modes[1].tcp_gain: got "2e-3 kg" (did you mean "1/kg"?); must be in 1/kg
damping_ratio = 0.02  ->  damping_ratio = 0.8
  24: requirements.damping_spread: got 0.3, which raises a damping ratio to 1.04 in the worst
    corner, where it must stay < 1; state at most 0.24 (24 %)
"80 Hz"\ndamping_ratio = "3 %"  ->  40.00000001\ndamping_ratio = 0.02
  16: plant.modes[2].frequency: modes beam and ram at 40 Hz: two modes have the same poles, so
    one force cannot bring both to rest independently; merge them into one mode (add their
    tcp_gain and measured_gain)
[[moves]]  ->  [moves]
  22: moves: got a table, must be an array; write the header as [[moves]]
"""
"""The same of the modal profile."""


def cases(text: str) -> list[tuple[str, str, list[str]]]:
    blocks = re.findall(r"^(\S.*)  ->  (.*)\n((?:  .*\n)+)", text, re.MULTILINE)
    return [
        (
            *(part.replace("\\n", "\n") for part in (old, new)),
            [
                f"p.toml:{' '.join(one.split())}"
                for one in re.split(r"^  (?=\d)", said, flags=re.M)[1:]
            ],
        )
        for old, new, said in blocks
    ]


@pytest.mark.parametrize(("old", "new", "expected"), cases(FAULTS))
def test_every_fault_has_its_line(old, new, expected):
    """All at once and in order; a control that lacks a key refuses it; a wrong kind hides none."""
    assert faults_in(changed(MANIPULATOR, old, new)) == expected


@pytest.mark.parametrize(("old", "new", "expected"), cases(FAULTS_OF_MODES))
def test_so_has_every_fault_of_modes(old, new, expected):
    assert faults_in(changed(MODAL, old, new)) == expected


def test_too_many_modes_are_refused():
    mode = '[[plant.modes]]\nname = "m{}"\nfrequency = 1{}\ndamping_ratio = 0\ntcp_gain = 0\n'
    assert faults_in(MODAL + "".join(mode.format(i, i) for i in range(7))) == [
        "p.toml:9: plant.modes: got too many elements, at most 8 allowed"
    ]


def test_missing_tables_are_asked_for():
    assert faults_in("schema = 1\n") == [
        "p.toml:1: machine: missing; add a table [machine]",
        "p.toml:1: plant: missing; add a table [plant]",
        "p.toml:1: drive: missing; add a table [drive]",
        "p.toml:1: moves: missing; add a table [[moves]]",
        "p.toml:1: requirements: missing; add a table [requirements]",
    ]


def test_a_fault_in_the_plant_raises_no_echo_in_the_peaks():
    text = changed(MANIPULATOR, '"manipulator"', '"robot"') + "peaks = { v_phi = 1 }\n"
    assert len(faults_in(text)) == 1


# Files


def fault_of_file(path: Path) -> Fault:
    with pytest.raises(InputError) as caught:
        read_profile(path)
    (fault,) = caught.value.faults
    return fault


@pytest.mark.parametrize(
    ("data", "line", "message"),
    [
        (b"", 1, "is empty; start from a shipped profile (mtcommission profiles list)"),
        (b"\x7fELF\0\0", 0, "is a binary or UTF-16 file; save the profile as UTF-8 text"),
        (
            b'schema = 1\n# \xb5m\n',
            2,
            "byte 0xb5 is not UTF-8; save the profile as UTF-8 text",
        ),
        (
            b"a = " + b"[" * 20000,
            1,
            "is nested too deeply; a profile needs no more than three levels",
        ),
        (b"#" * 200_001, 0, "is larger than 200000 bytes; that is no such file"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_profile(tmp_path, data, line, message):
    path = tmp_path / "p.toml"
    path.write_bytes(data)
    place = f"{path}:{line}" if line else str(path)
    assert str(fault_of_file(path)) == f"{place}: {message}"


def test_no_file_and_a_directory(tmp_path):
    assert (
        str(fault_of_file(tmp_path / "x"))
        == f"{tmp_path / 'x'}: there is no such file; check the name"
    )
    assert (
        str(fault_of_file(tmp_path)) == f"{tmp_path}: is a directory; name a profile (.toml) in it"
    )
    assert "cannot be read" in str(fault_of_file(Path("a\0b")))


def test_byte_order_mark_and_windows_line_ends_change_nothing(tmp_path):
    path = tmp_path / "p.toml"
    path.write_bytes(b"\xef\xbb\xbf" + MILLING.replace("\n", "\r\n").encode())
    assert read_profile(path) == parse_profile(MILLING, where="")
    broken = changed(MANIPULATOR, '"2 kN"', "0").replace("\n", "\r\n")
    assert faults_in(broken) == ["p.toml:19: drive.max_force: got 0 N, must be > 0 N"]


# Lines


def test_lines_survive_comments_strings_arrays_and_indented_tables():
    """A fault told at another line sends the user to a key that is right."""
    text = changed(MANIPULATOR, '"s"', '"""\n[drive]\nmax_force = 1\n"""  # [drive] in a comment')
    text = changed(text, '"2 kN"', "'C:\\'  # = [[moves]]")
    text += 'payload = [\n  "0 kg",  # ]\n  "-1 kg",\n]\nreserve = { band = 2, force = 3 }\n'
    text += '[[moves]]\ndistance = 1\n  [[moves]]\n  distance = -1\n[control]\n"kind" = 5\n'
    text = changed(text, "base_mass = ", "base_mass = 0 #").replace("[plant]\n", "[ plant ]\n")
    assert [fault.split(": ")[:2] for fault in faults_in(text)] == [
        ["p.toml:5", "machine.source"],
        ["p.toml:11", "plant.base_mass"],
        ["p.toml:22", "drive.max_force"],
        ["p.toml:27", "requirements.payload[2]"],
        ["p.toml:31", "requirements.reserve.band"],
        ["p.toml:31", "requirements.reserve.force"],
        ["p.toml:35", "moves[3].distance"],
        ["p.toml:37", "control.kind"],
    ]


def test_the_page_of_keys_is_the_schema():
    assert PAGE.read_text("utf-8") == write_page(), "run: python -m tests.profile_page"
