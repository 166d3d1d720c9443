"""The page that answers back gives the numbers of ``simulate``, in a real browser, offline.

If one of these fails, somebody types values into a control that the page called good.
"""

from __future__ import annotations

import json
import shlex
from dataclasses import dataclass, replace
from functools import cache
from math import inf, isfinite
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.limits.judge import assess, simulate_moves
from mtcommission.loop.model.assembly import build_loop
from mtcommission.loop.simulate import simulate
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import ForceFilter
from mtcommission.machine.machine import Corner, Machine, vary
from mtcommission.machine.mechanics import MachineState
from mtcommission.machine.moves import Move
from mtcommission.machine.plant.plant import Plant, build_plant
from mtcommission.machine.profile.shipped import read_shipped
from mtcommission.machine.setpoint_filter import SetpointFilter
from mtcommission.record.loop import what_if_part
from mtcommission.record.machine import MachineEntry, Profile
from mtcommission.record.shape import entry_of
from mtcommission.setpoint.motion_limits import MotionLimits
from mtcommission.setpoint.setpoint import plan_setpoint
from mtcommission.setpoint.smaller_moves import resize, size_of
from mtcommission.sheet.what_if import Panel, print_answers, what_if

from .test_sheet_browser import CHROMIUM, TELL, browse

PROFILES = Path(__file__).parent.parent / "profiles"
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="needs the browser chromium")

CASES = 12
SHAPER = SetpointFilter(kind="zvd", frequency_hz=31.0, damping_ratio=0.04)


@dataclass(frozen=True)
class Bench:
    """A machine with a loop by the classic rule, and its page."""

    machine: Machine
    plant: Plant
    tuned: TunedLoop
    panel: Panel
    html: str


TWO_STATES = "ball-screw, measured in two states"
SLOW_CYCLES = "honing-z, every millisecond"
"""Its force lag passes within a tenth of a velocity cycle, as with a control that runs on a PC."""


def read_machine(name: str) -> Machine:
    machine = read_shipped(name.split(",")[0]).machine
    if name == SLOW_CYCLES:
        control = replace(machine.control, position_cycle=1e-3, velocity_cycle=1e-3)
        drive = replace(machine.drive, force_lag=1e-4)
        machine = replace(machine, control=control, drive=drive)
    if name == TWO_STATES:
        (mode,) = machine.mechanics.modes
        mode = replace(mode, natural_frequency=0.7 * mode.natural_frequency, measured_gain=9e-4)
        far = replace(machine.mechanics, moving_mass=2700.0, modes=(mode,))
        machine = replace(machine, states=(MachineState(name="far", mechanics=far),))
    return machine


@cache
def build_bench(name: str) -> Bench:
    machine = read_machine(name)
    plant, tuned = build_plant(machine), tune_loop(machine)
    a = 0.5 * machine.drive.motion_force / plant.moving_mass
    recommended = MotionLimits(acceleration=a, jerk=a / 0.015, setpoint_filter=SHAPER)
    rotary, follows = machine.motion.value == "rotary", machine.drive.follows
    part = what_if_part(machine, plant, tuned, recommended, None)
    panel = what_if(part, Catalogue("en", rotary=rotary, follows=follows), profile=f"{name}.toml")
    profile = Profile(name=f"{name}.toml", sha256="0" * 64, text="")
    about = entry_of(MachineEntry, machine)
    html = print_answers(part, about, profile, created="2026-01-01", language="en")
    return Bench(machine, plant, tuned, panel, html)


@dataclass(frozen=True)
class Case:
    """What somebody tries."""

    limits: MotionLimits
    move: Move
    place: Corner


def draw_cases(bench: Bench, seed: int) -> list[Case]:
    rng, machine = np.random.default_rng(seed), bench.machine
    reached = machine.drive.motion_force / bench.plant.moving_mass
    fields = {item.key: (item.low, item.high) for item in bench.panel.fields}
    found = []
    for number in range(CASES):
        a = reached * rng.uniform(0.15, 1.05)
        ramp = 10 ** rng.uniform(np.log10(machine.control.position_cycle), -1.0)
        if "jerk" not in fields:
            ramp = machine.control.position_cycle
        average = SHAPER
        if "time" in fields:
            time = float(rng.uniform(*fields["time"]))
            average = SetpointFilter(kind="moving_average", time=time)
        limits = MotionLimits(
            acceleration=a, jerk=a / ramp, setpoint_filter=(None, average, SHAPER)[number % 3]
        )
        listed = machine.moves[0]
        move = resize(listed, size_of(listed) * float(10 ** rng.uniform(-1.5, 0.0)))
        load = float(rng.uniform(0.0, 0.4)) * bench.plant.moving_mass * (number % 2)
        error = float(rng.uniform(-0.15, 0.15)) * (number % 4 > 1)
        payload = load if "payload" in fields else 0.0
        found.append(Case(limits, move, Corner(payload=payload, frequency_factor=1.0 + error)))
    return found


TRY = """
const type = (key, value) => {
  const box = document.getElementById(`wi-${key}`);
  box.value = String(value);
  box.dispatchEvent(new Event("input", {bubbles: true}));
};
const choose = key => {
  const box = document.getElementById("wi-filter");
  box.value = key;
  box.dispatchEvent(new Event("change", {bubbles: true}));
};
addEventListener("load", () => {
  const found = CASES.map(one => {
    choose(one.filter);
    for (const [key, value] of Object.entries(one.fields)) type(key, value);
    whatIf.compute(false);
    const {tried} = whatIf.state;
    return {
      complaint: document.getElementById("wi-complaint").textContent,
      met: tried.met, checks: tried.checks, command: null,
      responses: tried.responses.map(r => ({
        settling: Number.isFinite(r.settling) ? r.settling : null, residual: r.residual,
        peak: r.peak, force: r.maxForce, rms: r.rms, saturated: r.saturated, contour: r.contour,
      })),
    };
  });
  tell(found);
});
"""


def as_typed(bench: Bench, case: Case) -> dict[str, Any]:
    """The case as it is typed into the fields, in their units, to all digits."""
    sizes = {item.key: item.size for item in bench.panel.fields}
    units = bench.panel.data["units"]
    is_step = not hasattr(case.move, "distance")
    sizes["size"] = units["velocity" if is_step else "distance"]["size"]
    item = case.limits.setpoint_filter
    values = {
        "acceleration": case.limits.acceleration,
        "jerk": case.limits.jerk,
        "size": size_of(case.move),
        "payload": case.place.payload,
        "error": case.place.frequency_factor - 1.0,
    }
    keys = list(dict(bench.panel.filters))
    chosen = "none" if item is None else item.kind
    if item is not None and item.kind != "moving_average":
        chosen = next(key for key in keys if key.startswith(item.kind))
    elif item is not None:
        values["time"] = item.time
    return {
        "filter": chosen,
        "fields": {key: repr(value / sizes[key]) for key, value in values.items() if key in sizes},
    }


def run_in_page(bench: Bench, cases: list[Case], folder: Path) -> Any:
    typed = json.dumps([as_typed(bench, case) for case in cases])
    found, console = browse(bench.html, folder, TELL + TRY.replace("CASES", typed))
    assert console == ""
    return found


@needs_browser
@pytest.mark.parametrize(
    "name", ["milling-manipulator", "rotary-table", SLOW_CYCLES, TWO_STATES, "printer-belt"]
)
def test_random_settings_give_what_simulate_gives(name, tmp_path):
    """Residual to 1 % of the band, settling to 0.1 ms, force and verdict, in all corners."""
    bench = build_bench(name)
    machine, band = bench.machine, bench.machine.requirements.tcp_deviation
    cases, seen = draw_cases(bench, seed=11), 0
    for case, found in zip(cases, run_in_page(bench, cases, tmp_path), strict=True):
        assert found["complaint"] == ""
        own = replace(machine, moves=(case.move,))
        (result,) = simulate_moves(own, bench.tuned, case.limits)
        expected = list(result.responses)
        if case.place != Corner():
            plant = build_plant(vary(machine, case.place))
            loop = build_loop(plant, bench.tuned.controller, model=bench.plant)
            setpoint = plan_setpoint(case.move, case.limits)
            expected.insert(0, simulate(loop, setpoint, drive=machine.drive, band=band))
        else:
            verdict = assess(machine, bench.plant, bench.tuned.corners, [result.values])
            assert found["met"] == verdict.is_met
            assert len(found["checks"]) == len(verdict.checks)
        assert len(found["responses"]) == len(expected)
        for got, want in zip(found["responses"], expected, strict=True):
            assert got["saturated"] == want.saturated
            assert got["force"] == pytest.approx(want.max_force, rel=1e-6)
            if want.saturated:
                continue
            seen += 1
            assert abs(got["residual"] - want.residual_deviation) <= 0.01 * band
            assert abs(got["peak"] - want.peak_deviation) <= 0.01 * band
            settling = inf if got["settling"] is None else got["settling"]
            assert isfinite(settling) == isfinite(want.settling_time)
            if isfinite(settling):
                assert abs(settling - want.settling_time) <= 1e-4
            assert got["rms"] == pytest.approx(want.rms_force, rel=1e-3)
    assert seen > 20, "nearly everything saturates: nothing was compared"


NOTCHES = """
addEventListener("load", () => {
  tell(NOTCHES.map(notch => whatIf.model.corners.map(corner => {
    const {scan, before} = whatIf.scanOf(corner), finite = x => Number.isFinite(x) ? x : null;
    const {gain, phase, peak, stable} = engine.marginsOf(scan, notch, before.turns);
    return {gain: finite(gain), phase: finite(phase), peak, stable};
  })));
});
"""


@needs_browser
@pytest.mark.parametrize("name", ["milling-manipulator", TWO_STATES])
def test_margins_with_any_notch_are_those_of_the_loop_with_it(name, tmp_path):
    """To 0.1 dB and 0.5 degrees; and a notch that makes the loop unstable is called so."""
    bench, rng = build_bench(name), np.random.default_rng(5)
    slowest = min(mode.natural_frequency for mode in bench.plant.modes)
    notches = [
        ForceFilter(
            kind="notch",
            natural_frequency=slowest * float(10 ** rng.uniform(-0.8, 0.8)),
            damping=width * float(10 ** rng.uniform(-1.5, -0.1)),
            width=width,
        )
        for width in (0.05, 0.2, 0.5, 0.9, 0.9, 0.9)
    ]
    asked = [
        {
            "frequency_hz": item.natural_frequency / (2 * np.pi),
            "damping": item.damping,
            "width": item.width,
        }
        for item in notches
    ]
    script = TELL + NOTCHES.replace("NOTCHES", json.dumps(asked))
    found: Any
    found, console = browse(bench.html, tmp_path, script)
    assert console == ""
    verdicts: list[bool] = []
    for item, corners in zip(notches, found, strict=True):
        controller = replace(bench.tuned.controller, force_filters=(item,))
        closed = close_loop(corner_plants(bench.machine), controller)
        for got, want in zip(corners, closed.analyses, strict=True):
            verdicts.append(want.is_stable)
            assert got["stable"] is want.is_stable
            gain = inf if got["gain"] is None else got["gain"]
            phase = inf if got["phase"] is None else got["phase"]
            assert gain == pytest.approx(want.gain_margin_db, abs=0.1)
            assert phase == pytest.approx(want.phase_margin_deg, abs=0.5)
            assert got["peak"] == pytest.approx(want.sensitivity_peak, rel=0.01)
    assert any(verdicts)


POINT = """
addEventListener("load", () => {
  const {state} = whatIf, margin = () => document.getElementById("wi-margin-phase-1").textContent;
  const touch = (key, across, down, type = "pointerdown") => {
    const svg = document.getElementById(`wi-${key}`), box = svg.getBoundingClientRect();
    const at = {clientX: box.left + across * box.width, clientY: box.top + down * box.height};
    svg.dispatchEvent(new PointerEvent(type, {...at, bubbles: true, cancelable: true}));
  };
  const seen = {}, values = () => [state.acceleration, state.jerk, state.size];
  seen.before = values();
  touch("landscape", 0.5, 0.5);
  touch("landscape", 0.5, 0.5, "pointerup");
  seen.landscape = values();
  touch("sizes", 0.5, 0.5);
  touch("sizes", 0.4, 0.5, "pointerup");
  touch("sizes", 0.2, 0.5, "pointermove");
  seen.sizes = values();
  seen.margins = [margin()];
  touch("bode", 0.5, 0.5);
  touch("bode", 0.6, 0.7, "pointermove");
  seen.notch = [state.notch_frequency, state.notch_depth];
  const box = document.getElementById("wi-jerk");
  box.value = "many";
  box.dispatchEvent(new Event("input", {bubbles: true}));
  const complaint = document.getElementById("wi-complaint");
  seen.wrong = [box.getAttribute("aria-invalid"), complaint.textContent];
  seen.kept = values();
  const slider = document.getElementById("wi-acceleration-slider");
  slider.value = 900;
  slider.dispatchEvent(new Event("input", {bubbles: true}));
  seen.slid = [state.acceleration, document.getElementById("wi-acceleration").value];
  const label = box.closest(".knob").querySelector("label");
  const mark = () => [box.value, getComputedStyle(label, "::after").content, complaint.textContent];
  seen.still = mark();
  document.getElementById("wi-load-0").click();
  seen.loaded = mark();
  requestAnimationFrame(() => requestAnimationFrame(() => {
    seen.margins.push(margin());
    tell(seen);
  }));
});
"""


@needs_browser
def test_map_sizes_and_notch_answer_to_a_finger_and_wrong_entries_are_said(tmp_path):
    """Only the sliders would be left to try values with."""
    found, console = browse(build_bench("ball-screw").html, tmp_path, TELL + POINT)
    assert console == ""
    before, landscape, sizes = (found[key] for key in ("before", "landscape", "sizes"))
    assert landscape[0] != before[0]
    assert landscape[1] != before[1]
    assert landscape[2] == before[2]
    assert sizes[:2] == landscape[:2]
    assert 0.0 < sizes[2] < before[2]
    assert found["notch"][1] > 0.0
    assert found["margins"][0] != found["margins"][1]
    assert found["wrong"][0] == "true"
    assert found["wrong"][1].startswith("Jerk: a number from ")
    # As long as it stands there it is marked, and what is computed instead is said.
    entry, sign, complaint = found["still"]
    assert entry == "many"
    assert "✗" in sign
    assert complaint == found["wrong"][1]
    assert "computed with " in complaint
    assert found["loaded"][0] != "many"
    assert found["loaded"][1:] == ["none", ""]
    assert found["kept"] == sizes
    assert found["slid"][0] == pytest.approx(float(found["slid"][1]), rel=1e-9)


TAKE = """
addEventListener("load", () => {
  document.getElementById("wi-load-0").click();
  for (const [key, value] of Object.entries(FIELDS)) {
    const box = document.getElementById(`wi-${key}`);
    box.value = value;
    box.dispatchEvent(new Event("input", {bubbles: true}));
  }
  whatIf.compute(false);
  document.getElementById("wi-take").click();
  const {tried} = whatIf.state;
  tell({
    command: document.getElementById("wi-command").value.split("\\n"),
    corners: tried.responses.slice(1).map(one => [one.residual, one.settling]),
    own: [tried.responses[0].residual, tried.responses[0].settling],
    shown: document.getElementById("wi-cell-residual-1").textContent,
  });
});
"""


@needs_browser
def test_limits_opens_the_page_and_its_command_line_gives_its_numbers(run, tmp_path):
    """What an engineer copies from the page is simulated with exactly these values."""
    controller = tune_loop(read_shipped("modal-two-modes").machine).controller
    keys = ("position_gain", "velocity_gain", "integral_time")
    gains = "".join(f"{key} = {getattr(controller, key)!r}\n" for key in keys)
    profile, page = tmp_path / "axis with space.toml", tmp_path / "page.html"
    text = read_shipped("modal-two-modes").text
    profile.write_text(text.replace("[control]\n", f"[control]\n{gains}"), "utf-8")
    code, out, _ = run("limits", profile, "--page", page)
    assert code in (0, 1)
    assert str(page) in out
    typed = {"acceleration": "3.21", "jerk": "123", "payload": "12", "error": "-4"}
    script = TELL + TAKE.replace("FIELDS", json.dumps(typed))
    found, console = browse(page.read_text("utf-8"), tmp_path, script)
    assert console == ""
    words = shlex.split(found["command"][0])
    assert words[:3] == ["mtcommission", "simulate", profile.name]
    code, out, _ = run("simulate", profile, *words[3:], "--json", "-")
    simulated = json.loads(out)["corners"]
    band = read_shipped("modal-two-modes").machine.requirements.tcp_deviation
    pages = [*found["corners"], found["own"]]  # the machine besides comes last in simulate
    assert len(simulated) == len(pages)
    for one, (residual, settling) in zip(simulated, pages, strict=True):
        assert abs(one["residual_deviation"] - residual) <= 0.01 * band
        assert abs(one["settling_time"] - settling) <= 1e-4


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--filter", "hum:4", '--filter: got "hum:4", must be one of: none, 8ms'),
        ("--filter", "moving_average:99s", "--filter: "),
        ("--move", "0", "--move: got 0, the profile has moves 1 to"),
        ("--size", "3kg", '--size: got "3kg"'),
        ("--payload", "-3", "--payload: got -3, must be 0 to 1000000"),
        ("--frequency-error", "80%", "--frequency-error: got 80%, must be -0.5 to 0.5"),
    ],
)
def test_what_cannot_be_tried_is_said(option, value, said, run):
    profile = PROFILES / "modal-two-modes.toml"
    code, _, err = run(
        "simulate", profile, "--acceleration", "1", "--jerk", "9", f"{option}={value}"
    )
    assert code == 2
    assert said in err
