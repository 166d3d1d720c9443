"""What a sweep computed and what its columns hold, in words: for the metadata and the page."""

from __future__ import annotations

from mtcommission.plant.plant import build_plant
from mtcommission.profile.read import parse_profile
from mtcommission.sweep.cases import Plan, Quantity
from mtcommission.sweep.rows import PEAK, Column

MEANINGS = {
    "case": "Number of the case, from 0; of a grid the last key runs fastest.",
    "inputs": "SHA-256 of all that the row depends on: version, profile, quantity, varied values.",
    "t_f": "Least time of the move to exact rest, time-optimal; of the slowest move for limits.",
    "t_f_lower_bound": "No control is quicker than this: proved by the adjoint.",
    "relative_gap": "(t_f - t_f_lower_bound) / t_f.",
    "certified": "Whether the gap is at most 1e-9.",
    "switches": "Number of switches of the time-optimal control.",
    "switching_times": "Times of its switches, separated by blanks.",
    "acceleration": "Recommended acceleration limit.",
    "jerk": "Recommended jerk limit.",
    "jerk_time": "Acceleration limit over jerk limit.",
    "settling_time": "From start until the tool stays in its band; slowest move, worst corner.",
    "residual_deviation": "Greatest deviation of the tool after the setpoint's end, worst corner.",
    "peak_deviation": "Greatest deviation of the tool at any time, worst corner.",
    "requirements_met": "Whether all requirements are met in every corner.",
    "bound_by": "What keeps the recommended limits from being higher.",
    "obstacle": "The requirement that is not met; empty where all are.",
    "record": "Record of the whole run, beside this table.",
    "outcome": '"done", or how the computation ended.',
    "message": "Why there is no result, and what to do.",
}


def meaning_of(column: Column) -> str:
    """Return what a column holds.

    Parameters
    ----------
    column
        Of a sweep's table.

    Examples
    --------
    >>> meaning_of(Column(name="peak_v_phi", unit="rad/s"))
    'Greatest magnitude of v_phi during the move and after it.'
    >>> meaning_of(Column(name="drive.max_force", unit="N"))
    'Varied key of the profile.'
    """
    if column.name in MEANINGS:
        return MEANINGS[column.name]
    if column.name.startswith(PEAK):
        signal = column.name.removeprefix(PEAK)
        return f"Greatest magnitude of {signal} during the move and after it."
    return "Varied key of the profile."


def describe_request(plan: Plan) -> str:
    """Return what was computed for every case, as a sentence.

    Parameters
    ----------
    plan
        Its profile can be read as it is.

    Returns
    -------
    str
        Quantity; for ``optimal`` the move and the bounds that are the same in all cases.

    Examples
    --------
    >>> from mtcommission.optimal.solution import Bound
    >>> from mtcommission.profile.shipped import read_shipped
    >>> text = read_shipped("milling-manipulator").text
    >>> bounds = (Bound(name="v_phi", value=0.005),)
    >>> describe_request(Plan(profile_text=text, where="p.toml", axes=(), bounds=bounds))
    'Quantity: optimal, move 1 of 1, |v_phi| at most 0.005 rad/s.'
    """
    parts = [f"Quantity: {plan.quantity.value}"]
    if plan.quantity is Quantity.OPTIMAL:
        machine = parse_profile(plan.profile_text, where=plan.where)
        plant = build_plant(machine)
        units = dict(zip(plant.signals, plant.signal_units, strict=True))
        parts.append(f"move {plan.move} of {len(machine.moves)}")
        parts += [
            f"|{item.name}| at most {item.value:g} {units[item.name]}" for item in plan.bounds
        ]
    return ", ".join(parts) + "."
