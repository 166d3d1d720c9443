"""One loop: what every engine computes with is the block diagram of python-control."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import pi

import control
import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.population import random_machine
from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.analysis import scan
from mtcommission.loop.model.assembly import INPUTS, as_state_space
from mtcommission.loop.model.diagram import build_lifted_model, build_open_loop
from mtcommission.loop.tuning.gains import design_observer, feedback_gains, is_seen
from mtcommission.loop.tuning.tuned import TunedLoop, close_loop, corner_plants
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.control import ForceFilter, StateFeedback
from mtcommission.machine.machine import Machine
from mtcommission.study.loops import LoopChoice
from tests.independent_loop import quiet_copy
from tests.machines import paper_machine

Array = NDArray[np.float64]

SEEDS = range(12)

NOTCH = ForceFilter(kind="notch", natural_frequency=2 * pi * 150.0, damping=0.2)
LOW_PASS = ForceFilter(kind="low_pass", natural_frequency=2 * pi * 900.0, damping=0.7)


def member(seed: int) -> Machine:
    """Every position loop, state feedback, filters, second encoders, reference models, delays."""
    machine = random_machine(seed)
    filters = ((), (NOTCH,), (), (NOTCH, LOW_PASS))[seed % 4]
    return quiet_copy(
        machine,
        state_feedback=StateFeedback.OFF,
        has_tcp_sensor=seed % 3 == 1,
        force_filters=filters,
        reference_model_time=machine.drive.force_lag if seed % 5 == 0 else 0.0,
        reference_delay=0.4 * machine.control.position_cycle if seed % 7 == 3 else None,
        position_loop=list(PositionLoop)[seed // 2 % 3],
        velocity_feedforward=0.8 if seed % 4 == 2 else 1.0,
        jerk_feedforward=0.5 if seed % 6 == 1 else 0.0,
    )


@cache
def tuned_member(seed: int) -> TunedLoop:
    """Every other one with feedback of a mode that its sensors see."""
    machine = member(seed)
    tuned = tune_loop(machine)
    plant, cascade = tuned.loops[0].plant, tuned.controller
    seen = [mode for mode in plant.modes if is_seen(mode, cascade.sensors)]
    if not seen or seed % 2 == 0:
        return tuned
    observer = design_observer(machine, plant, cascade)
    gains = feedback_gains(machine, plant, cascade, weight=0.3, observed=observer.states)
    fed_back = replace(cascade, state_gains=gains, observer=observer)
    return close_loop(corner_plants(machine), fed_back)


def assert_same(ours: Array, theirs: Array) -> None:
    """To 1e-11 of each entry; entries that are rounding beside their column count by it.

    The velocity is a difference of two positions, so the last digit or two are rounding.
    """
    floor = 1e-6 * np.max(np.abs(theirs), initial=0.0)
    assert np.max(np.abs(ours - theirs) / np.maximum(np.abs(theirs), floor or 1.0)) < 1e-11


def assert_is_the_diagram(tuned: TunedLoop) -> None:
    believed = tuned.loops[0].plant
    for loop in tuned.loops:
        ours = as_state_space(loop)
        theirs = build_lifted_model(loop.plant, tuned.controller, model=believed)
        assert (ours.dt, ours.states) == (theirs.dt, tuple(theirs.state_labels))
        n = len(INPUTS)
        assert tuple(theirs.input_labels[:n]) == INPUTS
        assert_same(ours.A, theirs.A)
        assert_same(ours.B, theirs.B[:, :n])
        assert_same(ours.C, theirs.C)
        assert_same(ours.D, theirs.D[:, :n])


@pytest.mark.parametrize("seed", SEEDS)
def test_every_loop_is_the_diagram_s(seed):
    """Every engine takes its matrices from the assembly, and margins are read off its open loop:
    they would all be wrong alike."""
    tuned = tuned_member(seed)
    assert_is_the_diagram(tuned)
    loop, T_v = tuned.loops[0], tuned.controller.velocity_cycle
    omega = np.geomspace(2 * pi * 0.3, 0.99 * pi / T_v, 60)
    ours = scan([loop.plant], tuned.controller, [omega])[0].open_loop(tuned.controller)
    theirs = build_open_loop(loop.plant, tuned.controller)(np.exp(1j * omega * T_v))
    assert np.max(np.abs(ours / theirs - 1.0)) < 1e-9


def test_model_of_a_tuned_loop_goes_on_in_python_control():
    """``found.loop.model`` is promised for bode plots; the tool must follow the setpoint."""
    tuned = tune_loop(paper_machine())
    model = LoopChoice(tuned=tuned, variants=()).model
    assert isinstance(model, control.StateSpace)
    assert tuple(model.input_labels) == ("x_ref", "v_ref", "a_ref", "j_ref", "disturbance")
    assert tuple(model.output_labels) == ("tcp", "encoder", "force")
    assert model["tcp", "x_ref"].dcgain() == pytest.approx(1.0)
    poles = np.exp(tuned.nominal.poles * model.dt)
    assert all(np.min(np.abs(model.poles() - pole)) < 1e-6 for pole in poles)
