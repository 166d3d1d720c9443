"""The paper's claims about setpoints, and why the optimum is not fed forward, as sentences."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from mtcommission.comparison import ComparedControl
from mtcommission.feedforward import FedForward
from mtcommission.machine import NOMINAL, Machine, Motion


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
    return f"overshoots by {100.0 * control.overshoot:.3g} %"


def _transfer(control: ComparedControl, least: float) -> str:
    if not isfinite(control.transfer_time):
        return f"does not settle, where the least time is {1e3 * least:.4g} ms"
    return (
        f"takes {1e3 * control.transfer_time:.4g} ms, {control.transfer_time / least:.3g} times "
        f"the least time of {1e3 * least:.4g} ms"
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
    unit = "um" if machine.motion is Motion.LINEAR else "urad"
    band = 1e6 * machine.requirements.tcp_deviation
    *optima, (_, ours) = fed_forward
    widest = max(abs(row.corner.frequency_factor - 1.0) for row in ours)
    sentences = [
        f"Fed forward, the {name} control {_outcome(rows)}, where it leaves "
        f"{_residual(rows):.3g} {unit}."
        for name, rows in optima
    ]
    return [
        *sentences,
        f"The setpoint with the recommended limits {_outcome(ours)}, where it leaves "
        f"{_residual(ours):.3g} {unit}.",
        f"The band is {band:.3g} {unit}, the machines differ by up to {100.0 * widest:.3g} % in "
        "frequency, and controls take acceleration and jerk, not a force every velocity cycle.",
    ]


def _outcome(rows: Sequence[FedForward]) -> str:
    nominal = next(row for row in rows if row.corner == NOMINAL)
    worst = max(row.settling_time for row in rows)
    return (
        f"settles after {_milliseconds(nominal.settling_time)} on the machine as stated and after "
        f"{_milliseconds(worst)} on the worst one"
    )


def _residual(rows: Sequence[FedForward]) -> float:
    return 1e6 * max(row.residual_deviation for row in rows)


def _milliseconds(time: float) -> str:
    return f"{1e3 * time:.4g} ms" if isfinite(time) else "no time looked at"
