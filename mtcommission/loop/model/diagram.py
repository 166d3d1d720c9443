"""The loop as a block diagram of python-control: its definition, and what it says of a loop.

Read beside the diagram in docs/feedback-loop.md. The blocks of the velocity cycle are connected
first and lifted: N velocity cycles become one position cycle, with every signal once for each of
them (``tcp[0]``, ``tcp[1]``, ...). To that the blocks of the position cycle are connected; the
weights of what they hand down are those of ``assembly.hand_down``.

To build it takes some 30 ms, to import python-control more than a second; so what tunes,
searches and simulates takes its matrices from ``assembly``, which a test holds to this model.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, pi

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mtcommission.controls.kind import PositionLoop
from mtcommission.loop.model.assembly import (
    INPUTS,
    CrossCheck,
    HandedDown,
    SampledLoop,
    StateSpace,
    hand_down,
)
from mtcommission.loop.model.controller import Controller, filter_polynomials
from mtcommission.machine.plant.plant import Plant

Array = NDArray[np.float64]

DRIVE = ("asked", "velocity", "feedforward", "push")
"""What enters a velocity cycle: the output of the position controller, or Kv times the wanted
position where the drive has that controller; velocity and force fed forward; a force on the line of
the drive."""


def build_model(plant: Plant, controller: Controller, *, model: Plant) -> control.StateSpace:
    """Return the loop as the position controller samples it, from setpoint to tool and force.

    From ``x_ref``, ``v_ref``, ``a_ref``, ``j_ref`` and ``disturbance``, a force on the line of the
    drive, to ``tcp``, ``encoder`` and ``force`` (F_set), at the position cycle. The plant may be in
    a corner; ``model`` is what the controller believes it to be, for its reference state.

    Examples
    --------
    >>> from mtcommission.loop.tuning.tuning import tune_loop
    >>> from mtcommission.machine.profile.shipped import read_shipped
    >>> loop = tune_loop(read_shipped("modal-two-modes").machine).loops[0]
    >>> model = build_model(loop.plant, loop.controller, model=loop.plant)
    >>> abs(model["tcp", "x_ref"].dcgain()).round(6)
    np.float64(1.0)
    """
    whole = build_lifted_model(plant, controller, model=model)
    seen = ["tcp", "encoder", "force"]
    part = whole[[f"{name}[0]" for name in seen], :]
    return control.ss(part, states=whole.state_labels, outputs=seen, name="loop")


def as_open_loop_model(axis: StateSpace) -> control.StateSpace:
    """Return an open-loop axis with the outputs of ``build_model``: there is no loop to draw."""
    A, B, C, D = axis.A, axis.B, axis.C[:3], axis.D[:3]
    signals = {"inputs": list(INPUTS), "outputs": ["tcp", "encoder", "force"]}
    return control.ss(A, B, C, D, axis.dt, **signals, name="loop")


def build_lifted_model(plant: Plant, controller: Controller, *, model: Plant) -> control.StateSpace:
    """Return the loop of ``build_model`` with its outputs at every velocity cycle.

    ``tcp[0]``, ``encoder[0]``, ``force[0]``, the plant's states ``state_0[0]``, ..., then the same
    one velocity cycle later, ``tcp[1]``, ...
    """
    outputs = ["tcp", "encoder", "force", *(f"state_{k}" for k in range(plant.order))]
    blocks = _blocks_of_the_velocity_cycle(plant, controller)
    drive = _lift(_connect(blocks, inputs=DRIVE, outputs=outputs), controller.cycles)
    return _connect(
        [drive, *_position_cycle(controller, hand_down(controller, model))],
        inputs=[*INPUTS, "disturbance"],
        outputs=drive.output_labels,
    )


def build_open_loop(plant: Plant, controller: Controller) -> control.StateSpace:
    """Return the loop cut at F_set, at the velocity cycle: L, unstable where 1 + L = 0.

    A position loop that closes in the control is taken in the base band: what is handed down is
    the mean of the last N samples, N velocity cycles late.
    """
    N, T_v = controller.cycles, controller.velocity_cycle
    blocks = _blocks_of_the_velocity_cycle(plant, controller, acting="acting")
    if controller.position_loop is PositionLoop.DRIVE:
        return -_connect(blocks, inputs=["acting"], outputs=["force"])
    states = [f"encoder[-{k}]" for k in range(1, 2 * N)]
    A, B = np.eye(2 * N - 1, k=-1), np.eye(2 * N - 1)[:, :1]
    C = -controller.position_gain / N * (np.arange(2 * N - 1) >= N - 1)
    base_band = _block(["encoder"], ["asked"], A=A, B=B, C=C, states=states, dt=T_v)
    return -_connect([*blocks, base_band], inputs=["acting"], outputs=["force"])


def _blocks_of_the_velocity_cycle(
    plant: Plant, controller: Controller, *, acting: str = "force"
) -> list[control.StateSpace]:
    """Plant, velocity controller, dead time, filters, observer; ``acting`` moves the plant."""
    T_v, encoder = controller.velocity_cycle, plant.row("encoder")
    Kp, Tn, observer = controller.velocity_gain, controller.integral_time, controller.observer
    # A disturbance on the line of the drive force enters like the force state, without its lag.
    push = plant.A[:, plant.force].copy()
    push[plant.force] = 0.0
    axis = control.ss(
        plant.A,
        np.column_stack([plant.B, push]),
        np.vstack([plant.row("tcp"), encoder, np.eye(plant.order)]),
        np.zeros((2 + plant.order, 2)),
        inputs=[acting, "push"],
        outputs=["tcp", "encoder", *(f"state_{k}" for k in range(plant.order))],
        states=[f"plant.{name}" for name in plant.states],
    ).sample(T_v, "zoh")

    def block(
        inputs: str, outputs: str, states: str = "", **matrices: ArrayLike
    ) -> control.StateSpace:
        return _block(inputs.split(), outputs.split(), states=states.split(), dt=T_v, **matrices)

    # Only the correction passes the reference model: the fed-forward velocity arrives in time.
    B = T_v / Tn * np.array([1.0, 1.0, -1.0])
    integral = block("modelled velocity rate", "integral", "integrator", A=1.0, B=B, C=Kp)
    model = block("correction", "modelled", D=1.0)
    if controller.reference_model_time:
        kept = exp(-T_v / controller.reference_model_time)
        model = block("correction", "modelled", "reference_model", A=kept, B=1.0 - kept, C=1.0)
    dead_time = block("filtered", "force", "pending_force", A=0.0, B=1.0, C=1.0)
    rate = block("encoder", "rate", "last_encoder", A=0.0, B=1.0, C=-1.0 / T_v, D=1.0 / T_v)
    in_drive = controller.position_loop is PositionLoop.DRIVE
    Kv = controller.position_gain if in_drive else 0.0
    position = block("asked encoder", "correction", D=[1.0, -Kv])
    summed = "correction velocity rate integral feedforward feedback"
    demand = block(summed, "demand", D=[Kp, Kp, -Kp, 1.0, 1.0, -1.0])
    estimates = " ".join(f"observer.{plant.states[i]}" for i in observer.states)
    feedback = block(
        " ".join([acting, *controller.sensors]),
        "feedback",
        estimates,
        A=observer.A - observer.L @ observer.C,
        B=np.column_stack([observer.B, observer.L]),
        C=controller.state_gains[list(observer.states)],
    )
    filters = _force_filters(controller)
    return [axis, integral, dead_time, rate, position, model, demand, *filters, feedback]


def _force_filters(controller: Controller) -> list[control.StateSpace]:
    """Set-force filters one after another, sampled by the bilinear transform."""
    items, T_v = controller.force_filters, controller.velocity_cycle
    signals = ["demand", *(f"filtered_{i}" for i in range(len(items) - 1)), "filtered"]
    if not items:
        return [_block(["demand"], ["filtered"], D=1.0, dt=T_v)]
    found = []
    for i, item in enumerate(items):
        b, a = filter_polynomials(item)
        A, C = np.array([-a[1:], [1.0, 0.0]]), b[1:] - b[0] * a[1:]
        states = [f"filter[{i}].{k}" for k in range(2)]
        inputs, outputs = [signals[i]], [signals[i + 1]]
        form = _block(inputs, outputs, A=A, B=[1.0, 0.0], C=C, D=b[0], states=states, dt=0.0)
        found.append(form.sample(T_v, "bilinear"))
    return found


def _position_cycle(controller: Controller, handed_down: HandedDown) -> list[control.StateSpace]:
    """Memory of the setpoint, what is computed of it, dead time, and how the drive reads it."""
    T_p, names, kept = controller.position_cycle, handed_down.names, handed_down.kept
    n, unit, new = 4 * kept, np.eye(len(names)), [f"new_{name}" for name in names]
    known = [f"by_setpoint_{name}" for name in names]
    memory = _block(
        INPUTS,
        known,
        A=np.eye(n, k=-4),
        B=np.eye(n, 4),
        C=handed_down.by_setpoint[:, 4:],
        D=handed_down.by_setpoint[:, :4],
        states=[f"{name}[-{k}]" for k in range(1, kept + 1) for name in INPUTS],
        dt=T_p,
    )
    D = np.column_stack([handed_down.by_encoder, unit])
    compare = _block(["encoder[0]", *known], new, D=D, dt=T_p)
    dead_time = _block(new, names, A=0.0 * unit, B=unit, C=unit, states=names, dt=T_p)
    # Per velocity cycle the three signals that are read, and the disturbance as it is.
    rows = np.array([handed_down.correction, handed_down.velocity, handed_down.force])
    D = np.zeros((controller.cycles, 4, len(names) + 1))
    D[:, 3, -1] = 1.0
    for i in range(controller.cycles):
        D[i, :3, :-1] = rows @ np.linalg.matrix_power(handed_down.advance, i)
    read_by = [f"{name}[{i}]" for i in range(controller.cycles) for name in DRIVE]
    read = _block([*names, "disturbance"], read_by, D=D, dt=T_p)
    return [read, dead_time, memory, compare]


def _lift(system: control.StateSpace, cycles: int) -> control.StateSpace:
    """N steps of a system as one, every signal once for each step."""
    A, B, C, D = system.A, system.B, system.C, system.D
    powers = [np.linalg.matrix_power(A, k) for k in range(cycles + 1)]
    markov = [D, *(C @ power @ B for power in powers), np.zeros_like(D)]
    each = range(cycles)
    return control.ss(
        powers[cycles],
        np.hstack([powers[cycles - 1 - i] @ B for i in each]),
        np.vstack([C @ powers[i] for i in each]),
        np.block([[markov[i - j] if i >= j else markov[-1] for j in each] for i in each]),
        cycles * system.dt,
        inputs=[f"{name}[{i}]" for i in each for name in system.input_labels],
        outputs=[f"{name}[{i}]" for i in each for name in system.output_labels],
        states=system.state_labels,
        remove_useless_states=False,
    )


def _block(
    inputs: Sequence[str],
    outputs: Sequence[str],
    *,
    A: ArrayLike = (),
    B: ArrayLike = (),
    C: ArrayLike = (),
    D: ArrayLike = 0.0,
    states: Sequence[str] = (),
    dt: float,
) -> control.StateSpace:
    """A block whose signals are connected by their names; at 0 s continuous."""
    n, m, p = len(states), len(inputs), len(outputs)
    direct = np.zeros((p, m)) if np.ndim(D) == 0 and not D else np.reshape(D, (p, m))
    signals = {"inputs": list(inputs), "outputs": list(outputs), "states": list(states)}
    A, B, C = np.reshape(A, (n, n)), np.reshape(B, (n, m)), np.reshape(C, (p, n))
    return control.ss(A, B, C, direct, dt, **signals, remove_useless_states=False)


def _connect(
    blocks: Sequence[control.StateSpace], *, inputs: Sequence[str], outputs: Sequence[str]
) -> control.StateSpace:
    """The blocks with equal names connected, as plain matrices; states keep their own names."""
    signals = {"inputs": list(inputs), "outputs": list(outputs)}
    whole = control.interconnect(blocks, **signals, check_unused=False)
    states = [name for block in blocks for name in block.state_labels]
    matrices = whole.A, whole.B, whole.C, whole.D, whole.dt
    return control.ss(*matrices, **signals, states=states, remove_useless_states=False)


DEAD_TIME_RADIUS = 1e-3
"""Several dead times are one defective pole, spread by rounding: not compared within it."""


def check_by_blocks(loop: SampledLoop, frequency_hz: Array) -> CrossCheck:
    """Return what the block diagram says of the nominal loop; margins on the same frequencies."""
    plant, controller = loop.plant, loop.controller
    whole = build_lifted_model(plant, controller, model=plant)
    n = len(loop.states)  # behind them the kept setpoints, which have no dynamics
    ours, theirs = np.linalg.eigvals(loop.lifted.A), np.linalg.eigvals(whole.A[:n, :n])
    alive = ours[np.abs(ours) > DEAD_TIME_RADIUS]
    omega = 2.0 * pi * frequency_hz
    cut = build_open_loop(plant, controller)(np.exp(1j * omega * controller.velocity_cycle))
    answer = control.frd(cut, omega, smooth=True)
    gains, phases, *_ = control.stability_margins(answer, returnall=True)
    return CrossCheck(
        pole_difference=float(np.max(np.min(np.abs(alive[:, None] - theirs), axis=1))),
        gain_margin_db=float(np.min(np.abs(20.0 * np.log10(gains)))) if len(gains) else None,
        phase_margin_deg=float(np.min(np.abs(phases))) if len(phases) else None,
    )
