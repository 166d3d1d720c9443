"""Results to a printed page: ratios first, then times; failures in their own words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isnan, nan
from statistics import median
from typing import Any

from benchmarks.child import Measurement
from benchmarks.limits_quality import GRID, SEARCH, Score, rank
from benchmarks.problems import FORCES, MAIN, MEANING, MODES, REST
from benchmarks.race import LADDER_SHARE
from benchmarks.tools import LINES_RULE, TOOLS, user_lines

OURS = TOOLS[0].name

Results = dict[str, Any]


def compose_report(results: Results) -> str:
    """Return the page; sections that never ran are left out."""
    lines = ["# Side by side", "", INTRODUCTION, ""]
    if "race" in results:
        rows = sorted((measurement(row) for row in results["race"]["rows"]), key=_place)
        lines += ["## Optimal controls", "", provenance(results["race"]), "", RACE, ""]
        lines += [_limit(results["race"]), ""]
        lines += [*_main_tables(rows), *_ladders(rows), *_users(rows)]
    if "quality" in results:
        scores = [Score(**_numbers(row)) for row in results["quality"]["rows"]]
        lines += ["## Limits from every source, on random machines", ""]
        lines += [provenance(results["quality"]), "", *_quality(scores)]
    if "jobs" in results:
        lines += ["## Whole jobs", "", provenance(results["jobs"]), "", JOBS, ""]
        lines += _jobs(results["jobs"]["rows"])
    return "\n".join(lines).rstrip() + "\n"


INTRODUCTION = """\
Everything here is printed by one command, `python -m benchmarks` (`--quick` for a small
selection). The peers are optional:
`pip install ".[peers]"`; one that is missing is shown as missing. All times are **processor
time**, with one thread: the clock of a machine that others use says little, and even processor
time shifts by some ten per cent when caches are shared. Hence ratios first; they compare within one
run. Your machine will give other times, and ratios in the same range."""

RACE = f"""\
Every tool is handed the same matrices: states scaled by what F_max could cause, the force by F_max,
time by a guess of the final time. Each runs in a process of its own, with a limit of processor
time. The control that it returns is then integrated **exactly**, by matrix exponentials, by code in
which no tool has a part.

- *ratio*: median warm solve over ours. *solve*: median, least and most of the warm solves, or the
  first answer where there was no time for another (marked ¹). *set-up*: first answer less a warm
  solve. A "warm" solve repeats a prepared solver from the same first guess; none starts from its
  own solution.
- *t_f error*: against our certified final time, which is proved to be within 1e-9 of the least
  possible (the proof comes with every solve). A negative one claims the impossible: the
  discretised machine is not the machine. For P3, where t_f is given, the error of the cost.
- *end*: largest deviation of a state from its target at t_f, in units of what F_max could cause.
  *tool*: amplitude with which the tool then vibrates on.
- *over*: largest excess over the limit of force or state anywhere, also between grid points, "–"
  where there is none.
- *MB*: peak memory of the process, interpreter and imports included.
- {LINES_RULE}

The IPOPT and MUMPS in all of them is the one that CasADi brings, with default tolerances; gekko
brings its own. dymos has SciPy's SLSQP, unless pyoptsparse is installed. What was tuned for a peer,
and why, stands at the top of its module."""

JOBS = """\
The machine is the paper's (`profiles/milling-manipulator.toml`). Stages and parts are measured
warm, in one process; `run` and the floor in processes of their own. Where the time goes is read
from the stages: no stage can be faster than the imports before it."""


def provenance(section: Results) -> str:
    """Return when, where and with what a section ran, and which rows were renewed later."""
    versions = ", ".join(
        f"{name} {version}" if version != "not installed" else f"{name} not installed"
        for name, version in section["versions"].items()
    )
    load = section["load"][0]
    renewed = "".join(
        f" Renewed {part['date']}, commit {part['commit']}, load {part['load'][0]}, at most "
        f"{part['seconds']:g} s each: {', '.join([*part['tools'], *part['problems']])}."
        for part in section.get("renewed", [])
    )
    return (
        f"*{section['date']}, commit {section['commit']}, {section['machine']} "
        f"(load {load} at the start, {section['workers']} processes at a time). {versions}."
        f"{renewed}{section.get('remark', '')}*"
    )


def _limit(section: Results) -> str:
    seconds = section["seconds"]
    return (
        f"A solve was stopped after {seconds:g} s of processor time "
        f"({LADDER_SHARE * seconds:g} s on the ladders), set-up included; `--seconds` gives more, "
        "and then more grids end with an answer."
    )


def measurement(row: dict[str, Any]) -> Measurement:
    """Return a measurement from its JSON object, null read as nan."""
    values = _numbers(row)
    return Measurement(**{**values, "warm": tuple(values["warm"])})


def _place(row: Measurement) -> tuple[int, int]:
    """Order of the tables, whichever process ended first."""
    return [tool.name for tool in TOOLS].index(row.tool), row.cells


def _numbers(row: dict[str, Any]) -> dict[str, Any]:
    return {key: nan if value is None else value for key, value in row.items()}


def _main_tables(rows: Sequence[Measurement]) -> Iterator[str]:
    for problem in MAIN:
        part = [row for row in rows if row.problem == problem]
        if not part:
            continue
        yield f"### {problem}: {MEANING[problem]}"
        yield ""
        what = "cost error" if problem == "P3" else "t_f error"
        yield f"| tool | N | ratio | {what} | end | tool [µm] | over | solve | set-up | MB |"
        yield "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
        ours = _ours(part, problem)
        for row in part:
            yield _main_row(row, ours)
        yield ""
        bound = ours.lower_bound if ours else nan
        if ours and not isnan(bound):
            gap = (ours.t_f - bound) / ours.t_f
            yield (
                f"Certified: t_f = {1e3 * ours.t_f:.9f} ms; the proved lower bound is below it by "
                f"{max(gap, 1e-15):.0e} of t_f at most."
            )
            yield ""


def _ours(rows: Sequence[Measurement], problem: str) -> Measurement | None:
    found = [row for row in rows if row.tool == OURS and row.problem == problem]
    return found[0] if found and not found[0].failure else None


def _main_row(row: Measurement, ours: Measurement | None) -> str:
    grid = f"{row.cells:,}".replace(",", " ") if row.cells else "none"
    if row.failure:
        return f"| {row.tool} | {grid} | {_plain(row.failure)} | | | | | | | |"
    ratio = f"{_short(row.solve / ours.solve)} ×" if ours else "?"
    over = f"{row.violation:.1e}" if row.violation > 1e-9 else "–"
    setup = _time(max(row.first - row.solve, 0.0)) if row.warm else "in it"
    return (
        f"| {row.tool} | {grid} | {ratio} | {_error(row, ours)} | {row.terminal_error:.1e} | "
        f"{1e6 * row.residual:.1e} | {over} | {_spread(row)} | {setup} | "
        f"{row.megabytes:.0f} |"
    )


def _error(row: Measurement, ours: Measurement | None) -> str:
    if ours is None:
        return "?"
    if row is ours:
        return "certified" if not isnan(row.lower_bound) else "reference"
    if isnan(ours.cost):
        return f"{row.t_f / ours.t_f - 1.0:+.1e}"
    return f"{row.cost / ours.cost - 1.0:+.1e}"


def _spread(row: Measurement) -> str:
    if not row.warm:
        return f"{_time(row.first)} ¹"
    return f"{_time(row.solve)} ({_time(min(row.warm))} – {_time(max(row.warm))})"


def _ladders(rows: Sequence[Measurement]) -> Iterator[str]:
    shown = [tool for tool in TOOLS if any(row.tool == tool.name for row in rows)]
    for title, problems in (
        ("A ladder of forces", FORCES),
        ("A ladder of modes", MODES),
        ("Rest to rest", REST),
    ):
        if not any(row.problem in problems for row in rows):
            continue
        yield f"### {title}"
        yield ""
        yield "Ratio of times (error of t_f); for ours the time itself."
        yield ""
        heads = [
            tool.name + (f", N = {tool.ladder_cells}" if tool.ladder_cells else "")
            for tool in shown
        ]
        yield "| | " + " | ".join(heads) + " |"
        yield "|---|" + "--:|" * len(shown)
        for problem in problems:
            ours = _ours(rows, problem)
            cells = []
            for tool in shown:
                found = [r for r in rows if r.tool == tool.name and r.problem == problem]
                cells.append(_cell(found[0], ours) if found else "not run")
            yield f"| {problem} | " + " | ".join(cells) + " |"
        yield ""


def _cell(row: Measurement, ours: Measurement | None) -> str:
    if row.failure:
        return _plain(row.failure)
    if row is ours:
        return _time(row.solve)
    ratio = f"{_short(row.solve / ours.solve)} ×" if ours else "?"
    return f"{ratio} ({_error(row, ours)})"


def _users(rows: Sequence[Measurement]) -> Iterator[str]:
    yield "### What a user writes, and where a peer is better"
    yield ""
    yield "| tool | lines | better than this package in |"
    yield "|---|--:|---|"
    for tool in TOOLS:
        yield f"| {tool.name} | {user_lines(tool)} | {tool.better or '–'} |"
    yield ""
    yield (
        "This package solves linear axes (rigid mass, force lag, decoupled modes) and nothing "
        "else: what it knows of their structure is what makes it fast and lets it prove. "
        "Everybody else takes nonlinear plants as well."
    )
    yield ""
    best = _best_peer(rows)
    if best:
        yield best
        yield ""


def _best_peer(rows: Sequence[Measurement]) -> str:
    """Say in which problem some peer comes nearest in time, or beats us."""
    found = []
    for problem in dict.fromkeys(row.problem for row in rows):
        ours = _ours(rows, problem)
        peers = [r for r in rows if r.problem == problem and r.tool != OURS and not r.failure]
        if ours and peers:
            peer = min(peers, key=lambda row: row.solve)
            found.append((peer.solve / ours.solve, problem, peer))
    if not found:
        return ""
    beaten = [item for item in found if item[0] < 1.0]
    ratio, problem, peer = min(found, key=lambda item: item[0])
    middle = median(item[0] for item in found)
    text = (
        f"The fastest peer of each problem, whatever its accuracy, takes {_short(middle)} times as "
        f"long as this package in the median of {len(found)} problems. It comes nearest in "
        f"{problem}: {peer.tool}, N = {peer.cells}, {_short(ratio)} times"
    )
    if not beaten:
        return text + ". No peer was faster in any problem."
    names = ", ".join(f"{item[1]} ({item[2].tool}, N = {item[2].cells})" for item in beaten)
    return f"{text}. **Faster than this package: {names}.**"


def _quality(scores: Sequence[Score]) -> Iterator[str]:
    machines = len({score.seed for score in scores})
    possible = len({score.seed for score in scores if score.is_met})
    yield (
        "The machines are those of `benchmarks.population`, seeds 0 ... "
        f"{max(score.seed for score in scores)}; {machines} of them have a loop that can be tuned, "
        f"and on {possible} some source meets all requirements: those count. Same loop, corners "
        "and judgement "
        f"for all. The brute force is a {GRID} × {GRID} grid over acceleration and ramp time, "
        "coarser than the search. The shapers get the limits that suit each best, "
        "so that they get more than a user would give them."
    )
    yield ""
    yield (
        "*later*: settling time above that of our search, where both meet everything: median and "
        "95 % quantile. *sooner*: machines on which the source settles sooner than our search by "
        "more than 0.5 %. *time*: processor time to find the limits, median (– : a formula)."
    )
    yield ""
    yield "| source | machines | all met | later, median | later, 95 % | sooner | time |"
    yield "|---|--:|--:|--:|--:|--:|--:|"
    for item in rank(scores):
        later = [
            "–" if isnan(ratio) else f"{100 * (ratio - 1):+.1f} %"
            for ratio in (item.ratio, item.ratio_high)
        ]
        if item.source == SEARCH:
            later = ["reference", "reference"]
        yield (
            f"| {item.source} | {item.machines} | {100 * item.share_met:.0f} % | {later[0]} | "
            f"{later[1]} | {100 * item.sooner:.0f} % | "
            f"{_time(item.seconds) if item.seconds else '–'} |"
        )
    yield ""
    yield (
        "A source that is sooner than our search is not wrong: shapers change the setpoint itself, "
        "which limits of acceleration and jerk cannot."
    )
    yield ""


def _jobs(rows: Sequence[dict[str, Any]]) -> Iterator[str]:
    rows = [_numbers(row) for row in rows]
    whole = next((row["seconds"] for row in rows if row["group"] == "run"), nan)
    yield "| job | share of `run` | time (least – most) | MB |"
    yield "|---|--:|--:|--:|"
    for row in rows:
        if row["group"] == "sweep":
            continue
        share = f"{100 * row['seconds'] / whole:.1f} %"
        if row["group"] == "part" or isnan(whole):
            share = ""
        memory = "" if isnan(row["megabytes"]) else f"{row['megabytes']:.0f}"
        spread = f"{_time(row['low'])} – {_time(row['high'])}"
        kind = {"stage": "stage: ", "part": "part: ", "floor": "floor: "}.get(row["group"], "")
        yield f"| {kind}{row['name']} | {share} | {_time(row['seconds'])} ({spread}) | {memory} |"
    yield ""
    sweeps = [row for row in rows if row["group"] == "sweep"]
    if sweeps:
        yield "Sweeps over F_max, two workers, processes started anew for each:"
        yield ""
        yield "| sweep | time | each | MB |"
        yield "|---|--:|--:|--:|"
        for row in sweeps:
            each = row["seconds"] / int(row["name"].split()[0])
            memory = f"{row['megabytes']:.0f}"
            yield f"| {row['name']} | {_time(row['seconds'])} | {_time(each)} | {memory} |"
        yield ""


def _time(seconds: float) -> str:
    if seconds >= 1.0:
        return f"{_short(seconds)} s"
    return f"{_short(1e3 * seconds)} ms"


def _short(value: float) -> str:
    """Two digits, or all before the point."""
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def _plain(text: str) -> str:
    return text.replace("|", "/").replace("<", "‹")
