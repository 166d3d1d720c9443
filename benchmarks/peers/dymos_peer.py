"""dymos (NASA) on OpenMDAO: Radau collocation, analytic and coloured derivatives.

The control may jump between segments, as dymos' bang-bang examples have it. The optimiser is
IPOPT through pyoptsparse if that is installed (it has no wheels), else SciPy's SLSQP. SLSQP is
dense, so with it the states are solved by Newton inside (``solve_segments``), which leaves it the
controls alone, and the grid stays coarse.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import dymos as dm
import numpy as np
import openmdao.api as om

from benchmarks.answer import Answer, grid_answer
from benchmarks.problems import Problem, Scaled

ORDER = 3


class Motion(om.ExplicitComponent):  # type: ignore[misc]
    """Rates of the states and, where wanted, the integrand and the bounded signals."""

    def initialize(self) -> None:
        self.options.declare("num_nodes", types=int)
        self.options.declare("given", types=Scaled)

    def setup(self) -> None:
        given, nodes = self.options["given"], self.options["num_nodes"]
        diagonal = np.arange(nodes)
        for i in range(given.order):
            self.add_input(f"x{i}", shape=(nodes,))
            self.add_output(f"rate{i}", shape=(nodes,), units="1/s")
        self.add_input("u", shape=(nodes,))
        for i in range(given.order):
            at = {"rows": diagonal, "cols": diagonal}
            for k in np.flatnonzero(given.A[i]):
                self.declare_partials(f"rate{i}", f"x{k}", val=given.A[i, k], **at)
            if given.B[i]:
                self.declare_partials(f"rate{i}", "u", val=given.B[i], **at)
        for k, row in enumerate(given.rows):
            self.add_output(f"signal{k}", shape=(nodes,))
            for i in np.flatnonzero(row):
                self.declare_partials(f"signal{k}", f"x{i}", val=row[i], **at)
        if given.weights.size:
            self.add_output("squares", shape=(nodes,), units="1/s")
            self.declare_partials("squares", "u", **at)
            for i in np.flatnonzero(given.weights):
                self.declare_partials("squares", f"x{i}", **at)

    def compute(self, inputs: Any, outputs: Any) -> None:
        given = self.options["given"]
        x = np.array([inputs[f"x{i}"] for i in range(given.order)])
        for i, rate in enumerate(given.A @ x + np.outer(given.B, inputs["u"])):
            outputs[f"rate{i}"] = rate
        for k, signal in enumerate(given.rows @ x):
            outputs[f"signal{k}"] = signal
        if given.weights.size:
            outputs["squares"] = inputs["u"] ** 2 + given.weights @ x**2

    def compute_partials(self, inputs: Any, partials: Any) -> None:
        given = self.options["given"]
        if given.weights.size:
            partials["squares", "u"] = 2.0 * inputs["u"]
            for i in np.flatnonzero(given.weights):
                partials["squares", f"x{i}"] = 2.0 * given.weights[i] * inputs[f"x{i}"]


def prepare(problem: Problem, cells: int) -> Callable[[], Answer]:
    """Return the solver of a model that is set up once, its colouring included in the solve."""
    given, n = problem.scaled(), problem.plant.order
    model = om.Problem(reports=False)
    model.driver, inside = _driver()
    radau = dm.Radau(num_segments=cells, order=ORDER, compressed=True, solve_segments=inside)
    phase = dm.Phase(ode_class=Motion, ode_init_kwargs={"given": given}, transcription=radau)
    model.model.add_subsystem("phase", phase)
    free = given.minimises_time
    phase.set_time_options(fix_initial=True, fix_duration=not free, duration_bounds=(0.1, 10.0))
    for i in range(n):
        phase.add_state(
            f"x{i}",
            rate_source=f"rate{i}",
            targets=[f"x{i}"],
            fix_initial=True,
        )
        if given.fixed[i]:
            phase.add_boundary_constraint(f"x{i}", loc="final", equals=given.target[i])
    phase.add_control(
        "u", targets=["u"], lower=-1.0, upper=1.0, continuity=False, rate_continuity=False
    )
    for k in range(given.rows.shape[0]):
        phase.add_path_constraint(f"signal{k}", lower=-1.0, upper=1.0)
    if free:
        phase.add_objective("time", loc="final")
    else:
        phase.add_state("cost", rate_source="squares", fix_initial=True)
        phase.add_objective("cost", loc="final")
    model.setup()

    def solve() -> Answer:
        phase.set_time_val(initial=0.0, duration=1.0)
        for i in range(n):
            phase.set_state_val(f"x{i}", [0.0, given.target[i]])
        phase.set_control_val("u", [0.5, 0.5])
        if not free:
            phase.set_state_val("cost", [0.0, 1.0])
        result = model.run_driver()
        if not result.success:
            raise RuntimeError(result.exit_status)
        force = np.asarray(model.get_val("phase.controls:u")).reshape(cells, ORDER)
        inner = radau.grid_data.node_stau[:ORDER]
        powers = np.vander((inner + 1.0) / 2.0, increasing=True)
        coefficients = np.linalg.solve(powers, force.T).T
        time = model.get_val("phase.t_duration")[0] if free else 1.0
        cost = np.nan if free else model.get_val("phase.timeseries.cost")[-1, 0]
        return grid_answer(problem, coefficients, time=time, cost=cost)

    return solve


def _driver() -> tuple[Any, str | bool]:
    """Return the driver, and whether states are solved inside."""
    try:
        import pyoptsparse  # noqa: F401
    except ImportError:
        driver = om.ScipyOptimizeDriver(optimizer="SLSQP", tol=1e-9, maxiter=500, disp=False)
        driver.declare_coloring(show_summary=False)
        return driver, "forward"
    driver = om.pyOptSparseDriver(optimizer="IPOPT", print_results=False)
    driver.opt_settings["print_level"] = 0
    driver.declare_coloring(show_summary=False)
    return driver, False
