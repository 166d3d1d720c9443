"""Sec. 3 and 7: the feedback loop, and the conclusions."""

from __future__ import annotations

from collections.abc import Sequence
from math import log

from mtcommission.validate.cases import Cases, LoopCase
from mtcommission.validate.row import Row, claim_row, judge_claim

VISIBLE_OVERSHOOT = 0.01
"""Overshoot of the velocity that counts as one [-] (empirical: what a plot shows)."""
MUCH_LARGER = 2.0
"""Ratio of times from which one is "much larger" [-]."""
CLEARLY = 2.0
"""So many times more, on a logarithmic scale, the jerk follows the dominating mode than the other
when either frequency is changed by ``FREQUENCY_FACTORS`` (empirical)."""
LOOP_BASIS = "our loop"


def loop_rows(cases: Cases) -> tuple[Row, ...]:
    """Return the claims on feedback control, beside simulated loops."""
    return (
        _active_damping(cases),
        _overshoot(cases),
        _transfer_time(cases),
        _smoothness(cases),
        _frequency(cases),
    )


def conclusion_rows(cases: Cases) -> tuple[Row, ...]:
    """Return the conclusions of sec. 7, beside ours."""
    return (_damping_by_bounds(cases), _hints(cases))


def _describe(case: LoopCase) -> str:
    return f"a = {case.limits.acceleration:.3g} m/s², j = {case.limits.jerk:.3g} m/s³"


def _overshoot(cases: Cases) -> Row:
    rough, smooth = cases.rectangular.measured.overshoot, cases.trapezoidal.measured.overshoot
    typical = [case.measured.overshoot for case in cases.condensed]
    return claim_row(
        "sec. 3, (i)",
        "terminal overshoot under feedback",
        printed="the terminal position is not attained precisely: overshooting",
        ours=(
            f"tool velocity overshoots by {100.0 * rough:.1f} % (rectangular), "
            f"{100.0 * min(typical):.1f} to {100.0 * max(typical):.1f} % (trapezoids as short as "
            f"the optima), {100.0 * smooth:.1f} % (trapezoid chosen for the loop)"
        ),
        basis=LOOP_BASIS,
        verdict=judge_claim(holds=min(rough, *typical) > VISIBLE_OVERSHOOT),
        reason="It depends on the jerk: limits chosen for the loop avoid it almost entirely.",
    )


def _transfer_time(cases: Cases) -> Row:
    least = cases.time.t_f
    times = [cases.trapezoidal.measured.transfer_time, cases.rectangular.measured.transfer_time]
    return claim_row(
        "sec. 3, (ii)",
        "transfer time under feedback",
        printed="much larger than the minimal transfer time",
        ours=(
            f"settled within 5 µm after {1e3 * times[0]:.1f} ms (trapezoid chosen for the loop) "
            f"to {1e3 * times[1]:.1f} ms (rectangular): {times[0] / least:.1f} to "
            f"{times[1] / least:.1f} times {1e3 * least:.2f} ms"
        ),
        basis=LOOP_BASIS,
        verdict=judge_claim(
            holds=min(times) > MUCH_LARGER * least, refuted=min(times) <= MUCH_LARGER * least
        ),
        reason=(
            f"Counted as much larger: {MUCH_LARGER:g} times. How far a loop comes down depends on "
            "its tuning, of which the paper says nothing."
        ),
    )


def _smoothness(cases: Cases) -> Row:
    index = cases.plant.signals.index("v_phi")
    rough = float(cases.rectangular.measured.peaks[index])
    smooth = float(cases.trapezoidal.measured.peaks[index])
    faster = cases.trapezoidal.measured.transfer_time < cases.rectangular.measured.transfer_time
    return claim_row(
        "sec. 3",
        "productivity with damping asks for jerk control",
        printed="optimum productivity with suitable damping for significant jerk control",
        ours=(
            f"{_describe(cases.trapezoidal)}: peak |v_phi| {1e3 * smooth:.1f} instead of "
            f"{1e3 * rough:.1f} mrad/s without jerk limit, and settled sooner"
            if faster
            else "the jerk limit does not pay"
        ),
        basis=LOOP_BASIS,
        verdict=judge_claim(holds=faster and smooth < rough),
    )


def _active_damping(cases: Cases) -> Row:
    """Compare the loop with a second encoder near the tool with that of the motor's alone."""
    own = [mode.damping_ratio for mode in cases.plant.modes]
    with_one, with_two = cases.as_printed, cases.sensed
    ratios = [f"{a:.2g}, {b:.2g}" for a, b in (own, with_one.damping, with_two.damping)]
    least = cases.time.t_f
    times = [with_one.rectangular_time, with_two.rectangular_time]
    return claim_row(
        "sec. 3",
        "structural vibration damped by feedback",
        printed="possible with sensors quite near to the TCP, but the achievable damping is not "
        "sufficient",
        ours=(
            f"damping ratios of base and tower: {ratios[0]} without feedback, {ratios[1]} with "
            f"the encoder alone, {ratios[2]} with a second one near the tool; without jerk limit "
            f"settled within 5 µm after {1e3 * times[0]:.0f} and {1e3 * times[1]:.0f} ms"
        ),
        basis=LOOP_BASIS,
        verdict=judge_claim(
            holds=bool(min(with_two.damping / own) > 1.0) and min(times) > MUCH_LARGER * least
        ),
        reason=(
            "The loop is ours, since Fig. 2 has no numbers. The encoder alone cannot see the "
            "tower: base and tower do not couple. A second one lets the loop damp it, and still "
            "it is the setpoint that decides how soon the axis settles."
        ),
    )


def _frequency(cases: Cases) -> Row:
    """Change one eigenfrequency at a time: the jerk must follow that of one mode."""
    base = (cases.softer_base, cases.as_printed, cases.stiffer_base)
    tower = (cases.softer_tower, cases.as_printed, cases.stiffer_tower)
    jerks = [[loop.limits.jerk for loop in loops] for loops in (base, tower)]
    hertz = [[loop.frequencies[i] for loop in loops] for i, loops in enumerate((base, tower))]
    told = [
        f"{name} at {', '.join(f'{value:.1f}' for value in at)} Hz: j = "
        f"{', '.join(f'{value:.1f}' for value in found)} m/s³"
        for name, at, found in zip(("base", "tower"), hertz, jerks, strict=True)
    ]
    other, leading = sorted(jerks, key=_growth)
    follows = leading == sorted(leading) and _growth(leading) > CLEARLY * _growth(other)
    return claim_row(
        "sec. 3",
        "what the possible jerk depends on",
        printed="the eigenfrequency of the dominating mode; no commissioning rules up to now",
        ours="; ".join(told),
        basis=f"limits chosen anew for each machine; {LOOP_BASIS}",
        verdict=judge_claim(holds=follows),
        reason=(
            "Here the base dominates, the mode that the encoder sees. A rule is "
            "derived in docs/commissioning-rule.md and printed on the sheet."
        ),
    )


def _growth(jerks: Sequence[float]) -> float:
    """Logarithm of the ratio of the largest to the least jerk."""
    return log(max(jerks) / min(jerks))


def _damping_by_bounds(cases: Cases) -> Row:
    index = cases.plant.signals.index("v_phi")
    free, bounded = float(cases.time.peaks[index]), float(cases.bounded.peaks[index])
    return claim_row(
        "sec. 7",
        "state constraints improve the damping",
        printed="significantly improved by suitable state constraints",
        ours=(
            f"peak |v_phi| {100.0 * (1.0 - bounded / free):.0f} % lower for "
            f"{100.0 * (cases.bounded.t_f / cases.time.t_f - 1.0):.0f} % more time"
        ),
        basis="the two certified controls",
        verdict=judge_claim(holds=bounded < 0.5 * free),
    )


def _hints(cases: Cases) -> Row:
    jerks = ", ".join(f"{case.limits.jerk:.0f}" for case in cases.condensed)
    chosen = cases.trapezoidal
    soonest = min(case.measured.transfer_time for case in cases.condensed)
    better = chosen.measured.transfer_time < soonest
    return claim_row(
        "sec. 7",
        "optimal controls give hints for the jerk limit",
        printed="concrete hints for suitable jerk limitations",
        ours=(
            f"profiles closest to the optima have j = {jerks} m/s³ and settle in the loop after "
            f"{1e3 * soonest:.0f} ms at best; {_describe(chosen)} after "
            f"{1e3 * chosen.measured.transfer_time:.0f} ms"
        ),
        basis=LOOP_BASIS,
        verdict=judge_claim(
            holds=not better,
            refuted=better
            and chosen.limits.jerk < min(case.limits.jerk for case in cases.condensed),
        ),
        reason=(
            "An optimal force cancels vibration by its switches, which no jerk-limited profile "
            "has. So the hints are bounds from above and starting points; the limits themselves "
            "have to be searched with the loop closed."
        ),
    )
