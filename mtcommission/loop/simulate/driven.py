"""Any setpoint through the loop: samples at the position cycle, friction and force limit."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from mtcommission.loop.model.assembly import SampledLoop, advance_cycle
from mtcommission.loop.model.friction import Friction

Array = NDArray[np.float64]


def drive_loop(
    loop: SampledLoop,
    references: Array,
    *,
    force_limit: float = inf,
    friction: Friction | None = None,
) -> Array:
    """Return the loop's outputs at every velocity cycle, at rest before the first one.

    Parameters
    ----------
    loop
        Under its controller.
    references
        x_ref, v_ref, a_ref, j_ref at each position cycle, shape (n, 4).
    force_limit
        Saturation of the set force [N].
    friction
        Of the loop's plant, if any.

    Returns
    -------
    ndarray, shape (n cycles, n_outputs)
        Columns as ``SampledLoop.outputs``.
    """
    if friction is None:
        outputs = _linear(loop, references)
        if float(np.max(np.abs(outputs[:, 2]))) <= force_limit:
            return outputs
    X, pieces = np.zeros((len(loop.states), 1)), []
    for r in references:
        X, Y = advance_cycle(loop, X, r[:, None], force_limit=force_limit, friction=friction)
        pieces.append(Y[:, :, 0])
    return np.vstack(pieces)


def _linear(loop: SampledLoop, references: Array) -> Array:
    lifted = loop.lifted
    pushed = references @ lifted.B.T
    history, X = np.empty((len(references), len(lifted.A))), np.zeros(len(lifted.A))
    for k, push in enumerate(pushed):
        history[k] = X
        X = lifted.A @ X + push
    outputs = history @ lifted.C.T + references @ lifted.D.T
    return np.asarray(outputs.reshape(-1, len(loop.outputs)))
