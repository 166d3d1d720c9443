"""The paper's claims about setpoints, and why the optimum is not fed forward, as sentences."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, pi

import numpy as np

from mtcommission.machine.machine import Machine, Motion
from mtcommission.machine.variations import NOMINAL
from mtcommission.study.comparison import ComparedControl
from mtcommission.study.feedforward import FedForward


def state_claims(controls: Sequence[ComparedControl]) -> list[str]:
    """Return overshoot and transfer time of the setpoints in the loop against the least time.

    Parameters
    ----------
    controls
        Rectangular and trapezoidal acceleration in the loop, then the time-optimal control.

    Returns
    -------
    list of str
        One sentence for each setpoint.
    """
    rectangular, trapezoidal, optimal = controls[:3]
    return [
        f"{subject} {_overshoot(control)} and {_transfer(control, optimal.transfer_time)}."
        for subject, control in (
            ("The rectangular acceleration setpoint", rectangular),
            ("The trapezoidal one with the recommended limits", trapezoidal),
        )
    ]


def _overshoot(control: ComparedControl) -> str:
    if control.overshoot < 5e-4:
        return "does not overshoot (less than 0.05 %)"
    return f"overshoots by {_plain(100.0 * control.overshoot)} %"


def _transfer(control: ComparedControl, least: float) -> str:
    if not isfinite(control.transfer_time):
        return f"does not settle, where the least time is {_milliseconds(least)}"
    return (
        f"takes {_milliseconds(control.transfer_time)}, {_plain(control.transfer_time / least)} "
        f"times the least time of {_milliseconds(least)}"
    )


def explain_why_not(
    machine: Machine, fed_forward: Sequence[tuple[str, Sequence[FedForward]]]
) -> list[str]:
    """Return what the fed-forward optimum does on the nominal machine and beside it.

    Parameters
    ----------
    machine
        Nominal; its band counts.
    fed_forward
        Names of optimal controls, and what each does, the nominal machine first; the last one
        is the setpoint with the recommended limits.

    Returns
    -------
    list of str
        One sentence for each way.
    """
    motion = machine.motion
    *optima, (_, ours) = fed_forward
    widest = max(abs(row.corner.frequency_factor - 1.0) for row in ours)
    sentences = [
        f"Fed forward, the {name} control {_outcome(rows)}, where it leaves "
        f"{_residual(rows, motion)}."
        for name, rows in optima
    ]
    return [
        *sentences,
        f"The setpoint with the recommended limits {_outcome(ours)}, where it leaves "
        f"{_residual(ours, motion)}.",
        f"The band is {_deviation(machine.requirements.tcp_deviation, motion)}, the machines "
        f"differ by up to {_plain(100.0 * widest)} % in frequency, and controls take acceleration "
        "and jerk, not a force every velocity cycle.",
    ]


def _outcome(rows: Sequence[FedForward]) -> str:
    nominal = next(row for row in rows if row.corner == NOMINAL)
    worst = max(row.settling_time for row in rows)
    return (
        f"settles after {_milliseconds(nominal.settling_time)} on the machine as stated and after "
        f"{_milliseconds(worst)} on the worst one"
    )


def _residual(rows: Sequence[FedForward], motion: Motion) -> str:
    return _deviation(max(row.residual_deviation for row in rows), motion)


_UNITS = {
    Motion.LINEAR: ((0.5, 1.0, "m"), (1e-3, 1e-3, "mm"), (0.1e-6, 1e-6, "um"), (0.0, 1e-9, "nm")),
    Motion.ROTARY: (
        (0.1 * pi / 180.0, pi / 180.0, "deg"),
        (0.0, pi / 180.0 / 3600.0, "arcsec"),
    ),
}
"""From which deviation on [SI], size [SI] and name of a unit; the first that fits is taken."""


def _deviation(value: float, motion: Motion) -> str:
    size, unit = next((size, unit) for least, size, unit in _UNITS[motion] if value >= least)
    return f"{_plain(value / size)} {unit}"


def _milliseconds(time: float) -> str:
    return f"{_plain(1e3 * time, digits=4)} ms" if isfinite(time) else "no time looked at"


def _plain(value: float, *, digits: int = 3) -> str:
    """Return a number with significant digits and never a power of ten."""
    return np.format_float_positional(float(f"{value:.{digits}g}"), trim="-")
