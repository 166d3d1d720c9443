"""What each column of a sweep's table holds, in words: for the metadata and the page."""

from __future__ import annotations

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
