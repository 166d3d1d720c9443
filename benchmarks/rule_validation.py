"""The commissioning rule on random machines, against the searched optimum.

    python -m benchmarks.rule_validation --count 1000 --workers 2

Prints a table, and keeps the rows as CSV (--table). Each machine: tune the cascade, apply the rule,
search limits and filter, and judge both (and j = a f) over every size in every corner. With --read
it prints the CSV's table again; with --chart FILE it draws the chart of the rule alone. With
--rule-only the rule alone is applied and judged again, and the columns of search and j = a f, which
do not depend on it, stay as the CSV has them. Only what the estimate says of the searched limits is
left empty then.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, fields, replace
from math import hypot, nan
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.population import random_machine
from mtcommission.base.errors import ComputationError
from mtcommission.base.messages.catalogue import Catalogue
from mtcommission.controls.kind import MOVING_AVERAGE
from mtcommission.limits.choose import choose_limits
from mtcommission.limits.commissioning_rule import (
    ModeEstimate,
    apply_commissioning_rule,
    count_ramps,
    estimate_axis,
    passed_by_average,
    servo_sensitivity,
)
from mtcommission.limits.judge import evaluate
from mtcommission.limits.requirements import RESIDUAL_DEVIATION, SET_FORCE
from mtcommission.loop.tuning.tuned import TunedLoop
from mtcommission.loop.tuning.tuning import tune_loop
from mtcommission.machine.machine import Machine, corners, moving_mass
from mtcommission.machine.moves import Positioning
from mtcommission.machine.plant.plant import Plant, build_plant, dominant_mode
from mtcommission.setpoint.motion_limits import MotionLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One machine; times in s, deviations over the band, forces over F_max."""

    seed: int
    outcome: str
    is_positioning: bool
    n_modes: int
    payload_share: float
    spread: float
    visible_share: float
    rule_met: bool = False
    rule_time: float = nan
    rule_residual: float = nan
    rule_estimate: float = nan
    rule_force: float = nan
    rule_chosen: str = ""
    rule_bound_by: str = ""
    search_met: bool = False
    search_time: float = nan
    search_binding: str = ""
    textbook_met: bool = False
    textbook_time: float = nan


def machine_for_every_size(seed: int) -> Machine:
    """The machine of the population, asked for every size, its setpoint filter free."""
    machine = random_machine(seed)
    return replace(
        machine,
        requirements=replace(machine.requirements, every_size=True),
        control=replace(machine.control, seeks_setpoint_filter=True),
    )


def validate(seed: int) -> Row:
    """Return what rule, search and j = a f do on one machine."""
    machine = machine_for_every_size(seed)
    plant = build_plant(machine)
    try:
        tuned = tune_loop(machine)
    except ComputationError as error:
        return describe(seed, machine, plant, outcome=error.outcome.name)
    limits = choose_limits(machine, tuned).limits
    return compare(describe(seed, machine, plant, outcome=""), machine, plant, tuned, limits)


def describe(seed: int, machine: Machine, plant: Plant, *, outcome: str) -> Row:
    mass = moving_mass(machine)
    return Row(
        seed=seed,
        outcome=outcome,
        is_positioning=isinstance(machine.moves[0], Positioning),
        n_modes=len(plant.modes),
        payload_share=machine.requirements.payload[1] / mass,
        spread=machine.requirements.frequency_spread,
        visible_share=mass * sum(mode.measured_gain for mode in plant.modes),
    )


def compare(
    row: Row, machine: Machine, plant: Plant, tuned: TunedLoop, searched: MotionLimits
) -> Row:
    by_search = evaluate(machine, tuned, searched)
    heaviest = max(moving_mass(machine) + corner.payload for corner in corners(machine))
    a = machine.drive.motion_force / (1.2 * heaviest)
    naive = MotionLimits(acceleration=a, jerk=a * dominant_mode(plant).frequency_hz)
    textbook = evaluate(machine, tuned, naive)
    return replace(
        apply_rule(row, machine, plant, tuned),
        search_met=by_search.assessment.is_met,
        search_time=by_search.settling_time,
        search_binding=largest_part(machine, plant, tuned, searched),
        textbook_met=textbook.assessment.is_met,
        textbook_time=textbook.settling_time,
    )


def apply_rule(row: Row, machine: Machine, plant: Plant, tuned: TunedLoop) -> Row:
    """The row with what the rule does; the other columns stay."""
    found = apply_commissioning_rule(machine, tuned)
    by_rule = evaluate(machine, tuned, found.limits)
    sizes = {check.requirement: check.value for check in by_rule.sizes}
    return replace(
        row,
        rule_met=by_rule.assessment.is_met,
        rule_time=by_rule.settling_time,
        rule_residual=sizes[RESIDUAL_DEVIATION] / machine.requirements.tcp_deviation,
        rule_estimate=found.best.residual_deviation / machine.requirements.tcp_deviation,
        rule_force=sizes[SET_FORCE] / machine.drive.motion_force,
        rule_chosen=Catalogue().say(found.best.name).split(",")[0],
        rule_bound_by=Catalogue().say(found.best.bound_by),
    )


def renew(row: Row) -> Row:
    """The row with today's rule beside the search as it was; its limits are not in the row."""
    if row.outcome:
        return row
    machine = machine_for_every_size(row.seed)
    bare = replace(row, search_binding="")
    return apply_rule(bare, machine, build_plant(machine), tune_loop(machine))


def largest_part(machine: Machine, plant: Plant, tuned: TunedLoop, limits: MotionLimits) -> str:
    """The part of the estimated residual that is largest at these limits."""
    axis, item = estimate_axis(machine, plant, tuned.controller), limits.setpoint_filter
    average = item.time if item and item.kind == MOVING_AVERAGE else 0.0
    modes = [
        2.0 * count_ramps(machine.moves) * mode.jerk_sensitivity * passed_by_average(mode, average)
        for mode in axis.modes
    ]
    parts = {
        "servo": servo_sensitivity(axis, average),
        "payload": axis.servo.drag,
        "vibration": hypot(*modes),
    }
    return max(parts, key=lambda name: parts[name])


def run(work: Callable[[Any], Row], items: Sequence[Any], *, workers: int) -> list[Row]:
    """A row for each of some seeds, or of some rows."""
    start = perf_counter()
    rows = []
    with ProcessPoolExecutor(max_workers=workers) as pool:
        for row in pool.map(work, items, chunksize=4):
            rows.append(row)
            if len(rows) % 50 == 0:
                print(f"{len(rows)} of {len(items)}, {perf_counter() - start:.0f} s", flush=True)
    return rows


def write_rows(rows: Sequence[Row], path: Path) -> None:
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Row)])
        writer.writeheader()
        for row in rows:
            writer.writerow(
                {k: f"{v:.5g}" if isinstance(v, float) else v for k, v in asdict(row).items()}
            )


def read_rows(path: Path) -> list[Row]:
    kinds: dict[str, Callable[[str], Any]] = {
        "int": int,
        "float": float,
        "str": str,
        "bool": lambda text: text == "True",
    }
    with path.open() as file:
        return [
            Row(**{field.name: kinds[str(field.type)](line[field.name]) for field in fields(Row)})
            for line in csv.DictReader(file)
        ]


def summarise(rows: Sequence[Row]) -> Iterator[str]:
    """Lines of the printed table (Markdown)."""
    tuned = [row for row in rows if not row.outcome]
    possible = [row for row in tuned if row.search_met]
    yield "| | |"
    yield "|---|---|"
    yield f"| machines | {len(rows)} |"
    yield f"| not tunable (named outcome) | {len(rows) - len(tuned)} |"
    yield f"| search found limits that meet every requirement | {len(possible)} |"
    yield f"| **rule meets every requirement** | **{_share([r.rule_met for r in possible])}** |"
    textbook = _share([row.textbook_met for row in possible])
    yield f"| j = a f (dominant mode, a = F/1.2 m) does | {textbook} |"
    residual = np.array([row.rule_residual for row in possible])
    yield f"| rule: residual above the band | {_share(residual > 1)} |"
    yield f"| rule: residual above 1.25 bands | {_share(residual > 1.25)} |"
    yield f"| rule: residual above 2 bands | {_share(residual > 2)} |"
    yield f"| rule: force above F_max | {_share([r.rule_force > 1 for r in possible])} |"
    ratios = _ratios(possible)
    for percent in (5, 25, 50, 75, 90, 95, 99):
        yield (
            f"| time above the optimum where met, {percent} % of machines below | "
            f"{100 * (np.quantile(ratios, percent / 100) - 1):+.0f} % |"
        )
    true = np.array([row.rule_residual / row.rule_estimate for row in possible])
    low, middle, high = np.quantile(true, [0.05, 0.5, 0.95])
    yield (
        "| simulated over estimated residual at the rule's limits: 5 %, 50 %, 95 % quantile | "
        f"{low:.2f}, {middle:.2f}, {high:.2f} |"
    )
    times = np.log([[row.rule_time, row.search_time] for row in possible if row.rule_met])
    fit = np.corrcoef(times.T)[0, 1] ** 2
    yield f"| share of the variance of log settling time that the rule explains | {fit:.3f} |"
    known = [row.search_binding for row in possible if row.search_binding]
    for part_name in ("vibration", "servo", "payload") if known else ():
        share = _share([name == part_name for name in known])
        yield f"| largest part of the residual at the searched optimum: {part_name} | {share} |"
    for name, part in _groups(possible):
        if part:
            more = 100 * (np.median(_ratios(part)) - 1)
            met = _share([row.rule_met for row in part])
            yield f"| {name} ({len(part)}): met; median time above optimum | {met}; {more:+.0f} % |"


def _share(flags: Sequence[bool] | np.ndarray) -> str:
    return f"{100 * np.mean(flags):.1f} %"


def _ratios(rows: Sequence[Row]) -> np.ndarray:
    found = [row.rule_time / row.search_time for row in rows if row.rule_met]
    return np.array(found or [np.nan])


def _groups(rows: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    return [
        ("velocity step", [row for row in rows if not row.is_positioning]),
        ("positioning", [row for row in rows if row.is_positioning]),
        *((f"{n} mode(s)", [row for row in rows if row.n_modes == n]) for n in (1, 2, 3)),
        ("no payload", [row for row in rows if row.payload_share == 0]),
        ("payload", [row for row in rows if row.payload_share > 0]),
        *(
            (f"spread {100 * s:g} %", [r for r in rows if r.spread == s])
            for s in (0, 0.02, 0.05, 0.1)
        ),
        ("encoder sees no mode", [row for row in rows if row.visible_share == 0]),
        ("encoder sees little, sum m c < 0.5", [r for r in rows if 0 < r.visible_share < 0.5]),
        ("encoder sees much, sum m c >= 0.5", [r for r in rows if r.visible_share >= 0.5]),
        *(
            (f"optimum bound by {k}", [r for r in rows if r.search_binding == k])
            for k in ("vibration", "servo", "payload")
        ),
        *((f"chosen: {k}", [r for r in rows if r.rule_chosen == k]) for k in _chosen(rows)),
        *((f"bound by {k}", [r for r in rows if r.rule_bound_by == k]) for k in ("force", "reach")),
    ]


def _chosen(rows: Sequence[Row]) -> list[str]:
    return sorted({row.rule_chosen for row in rows})


def draw_chart(path: Path) -> None:
    """The chart of the rule: what a moving average lets through of a mode."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "mtcommission"
    import matplotlib.pyplot as plt

    figure, axis = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
    cycles = np.linspace(0.02, 3.2, 640)
    for spread, colour in ((0.0, "#1f4e79"), (0.05, "#c07b1a"), (0.1, "#b03a2e")):
        for damping, style in ((0.01, "-"), (0.05, "--")):
            mode = ModeEstimate(
                name="",
                low_hz=1.0 - spread,
                high_hz=1.0 + spread,
                damping=damping,
                jerk_sensitivity=1.0,
            )
            values = [passed_by_average(mode, x) for x in cycles]
            label = f"spread {100 * spread:g} %, ζ = {damping:g}"
            axis.plot(cycles, values, style, color=colour, linewidth=1.2, label=label)
    axis.set(
        xlabel="f T_F, length of the average in periods of the mode",
        ylabel="W, share of the vibration that is left",
        yscale="log",
        ylim=(5e-3, 1.2),
        xlim=(0, 3.2),
    )
    axis.grid(alpha=0.3, which="both")
    axis.legend(fontsize=8, ncols=3)
    figure.savefig(path, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--table", type=Path, default=Path("build") / "commissioning-rule.csv")
    parser.add_argument("--read", action="store_true", help="print the CSV, compute nothing")
    parser.add_argument("--chart", type=Path, help="draw the chart of the rule, compute nothing")
    parser.add_argument("--rule-only", action="store_true", help="keep the CSV's search")
    arguments = parser.parse_args()
    if arguments.chart:
        draw_chart(arguments.chart)
        return
    table = arguments.table
    table.parent.mkdir(parents=True, exist_ok=True)
    if arguments.read:
        rows = read_rows(table)
    else:
        seeds = range(arguments.first, arguments.first + arguments.count)
        if arguments.rule_only:
            known = [row for row in read_rows(table) if row.seed in seeds]
            rows = run(renew, known, workers=arguments.workers)
        else:
            rows = run(validate, seeds, workers=arguments.workers)
        write_rows(rows, table)
    print("\n".join(summarise(rows)))


if __name__ == "__main__":
    main()
