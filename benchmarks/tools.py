"""Who takes part, on which grids, and how many lines a user writes."""

from __future__ import annotations

import ast
import importlib.util
import io
import tokenize
from dataclasses import dataclass
from pathlib import Path

PEERS = Path(__file__).parent / "peers"

LINES_RULE = (
    "Lines: code lines of the module in `benchmarks/peers/` that turns the given problem into a "
    "control, without docstrings, comments, blank lines and imports; the statement of the "
    "problem itself (plant, scaling, target) is handed to everybody and not counted."
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """One way to the control.

    Parameters
    ----------
    name
        In the table.
    module
        In ``benchmarks/peers``.
    package, install
        What it imports, and the command that installs it.
    cells
        Grids for the main problems, coarse to fine; 0 stands for no grid. A finer one is not
        tried where a coarser one had no answer in time.
    ladder_cells
        Grid for the ladders.
    better
        Where it is better than this package.
    """

    name: str
    module: str
    package: str
    install: str
    cells: tuple[int, ...]
    ladder_cells: int
    better: str


TOOLS = (
    Tool(
        name="mtcommission",
        module="ours",
        package="mtcommission",
        install="pip install .",
        cells=(0,),
        ladder_cells=0,
        better="",
    ),
    Tool(
        name="HiGHS, linear programs",
        module="highs_reach",
        package="scipy",
        install="pip install scipy",
        cells=(1000, 10_000),
        ladder_cells=1000,
        better="any linear bound, also on combinations and one-sided; no structure to search",
    ),
    Tool(
        name="CasADi/IPOPT, tuned",
        module="tuned_transcription",
        package="casadi",
        install="pip install casadi",
        cells=(1000, 10_000),
        ladder_cells=1000,
        better="bounds in the damping-optimal problem as well; nonlinear with little change",
    ),
    Tool(
        name="CasADi/IPOPT, Euler",
        module="casadi_euler",
        package="casadi",
        install="pip install casadi",
        cells=(1000, 10_000),
        ladder_cells=1000,
        better="nonlinear plants, any cost and constraint",
    ),
    Tool(
        name="CasADi/IPOPT, collocation",
        module="casadi_collocation",
        package="casadi",
        install="pip install casadi",
        cells=(200, 1000, 10_000),
        ladder_cells=200,
        better="nonlinear plants, any cost and constraint, stiff ones too",
    ),
    Tool(
        name="rockit",
        module="rockit_peer",
        package="rockit",
        install="pip install rockit-meco",
        cells=(200, 1000, 10_000),
        ladder_cells=200,
        better="nonlinear plants, several phases, and the shortest statement of all",
    ),
    Tool(
        name="pyomo.dae",
        module="pyomo_peer",
        package="pyomo",
        install="pip install pyomo",
        cells=(100, 1000, 10_000),
        ladder_cells=100,
        better="nonlinear and differential-algebraic plants, integer decisions, any AMPL solver",
    ),
    Tool(
        name="gekko",
        module="gekko_peer",
        package="gekko",
        install="pip install gekko",
        cells=(200, 1000),
        ladder_cells=100,
        better="nonlinear and differential-algebraic plants, estimation and control online",
    ),
    Tool(
        name="dymos",
        module="dymos_peer",
        package="dymos",
        install="pip install dymos",
        cells=(20, 50),
        ladder_cells=20,
        better="nonlinear plants made of many disciplines, several phases, the machine's own "
        "dimensions as unknowns",
    ),
)


def find_tool(name: str) -> Tool:
    """Return a tool by its name; KeyError if there is none."""
    return {tool.name: tool for tool in TOOLS}[name]


def is_installed(tool: Tool) -> bool:
    """Whether its package can be imported."""
    return importlib.util.find_spec(tool.package) is not None


def user_lines(tool: Tool) -> int:
    """Lines that a user writes, by LINES_RULE."""
    text = (PEERS / f"{tool.module}.py").read_text(encoding="utf-8")
    silent = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
    written: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in silent and token.type != tokenize.ENDMARKER:
            written.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import | ast.ImportFrom | ast.Expr) and not _is_call(node):
            written.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return len(written)


def _is_call(node: ast.stmt) -> bool:
    """Whether an expression that stands alone does something; else it is a docstring."""
    return isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant)
