"""The moves of a record beside their optima."""

from __future__ import annotations

from dataclasses import dataclass

from mtcommission.record.schema.values import Words


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedEntry:
    """One way of doing a move, in the loop or by an optimal control on the plant."""

    name: Words
    transfer_time: float | None
    overshoot: float
    peaks: dict[str, float]
    max_force: float
    heat: float
    work: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FedForwardEntry:
    """An optimal control fed forward while the loop corrects, or the limits, on one machine."""

    control: Words
    payload: float
    frequency_factor: float
    damping_factor: float
    state: str = ""  # as the profile names it
    settling_time: float | None
    residual_deviation: float | None
    peak_deviation: float
    saturated_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparisonEntry:
    """One move in the loop and by its optima."""

    controls: list[ComparedEntry]
    fed_forward: list[FedForwardEntry]
    claims: list[Words]  # of the paper, measured: overshoot, and a transfer time far from the least
    why_not_the_optimum: list[Words]  # what each optimum does when it is fed forward
