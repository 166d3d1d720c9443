"""Where another mode would explain most of what is left."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.lines import Lines
from mtcommission.identify.fit.projection import Projected

Array = NDArray[np.float64]

RATIOS = (0.003, 0.012, 0.045, 0.15)
"""Damping ratios of the candidates; least squares finds those between."""
STEP = 1.6
"""Distance of the candidates' frequencies, in ζ f."""


def candidate_poles(responses: Sequence[Lines]) -> tuple[Array, Array]:
    """Return ω and ζ of all candidates, shape (n_candidates,)."""
    low = 2 * np.pi * min(float(lines.frequency_hz[0]) for lines in responses)
    high = 2 * np.pi * max(float(lines.frequency_hz[-1]) for lines in responses)
    omegas, zetas = [], []
    for zeta in RATIOS:
        count = max(2, int(np.log(high / low) / np.log1p(STEP * zeta)))
        omegas.append(np.geomspace(low, high, count))
        zetas.append(np.full(count, zeta))
    return np.concatenate(omegas), np.concatenate(zetas)


def find_candidates(
    responses: Sequence[Lines], known: Projected, *, most: int
) -> list[tuple[float, float]]:
    """Return ω and ζ of the modes that would lower the misfit most, best first.

    The misfit that a mode of given pole takes away is (c · r)²/(c · c), with c its column less what
    b, the known modes and R can do: a matched filter on all poles of a grid, so that a mode between
    two lines is found by its flanks.

    Parameters
    ----------
    responses
        Of one state of the machine.
    known
        Best fit so far.
    most
        At most so many, each apart from those before by a third of an octave or their widths.
    """
    omega, zeta = candidate_poles(responses)
    gain = np.zeros(omega.size)
    for lines, residual, delay in zip(
        responses, known.residuals, known.poles.delays.tolist(), strict=True
    ):
        s = lines.s
        weigh = np.exp(-s * delay) * s**lines.derivative / lines.error
        basis = np.column_stack(
            [
                weigh / (s * (s + known.poles.drag)),
                *(
                    weigh / (s * s + 2 * z * w * s + w * w)
                    for w, z in zip(known.poles.omega, known.poles.zeta, strict=True)
                ),
                weigh,
            ]
        )
        stacked = np.concatenate([basis.real, basis.imag])
        q, _ = np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))
        columns = weigh[:, None] / ((s * s)[:, None] + np.outer(s, 2 * zeta * omega) + omega**2)
        flat = np.concatenate([columns.real, columns.imag])
        before = np.einsum("ij,ij->j", flat, flat)
        shares = q.T @ flat
        after = before - np.einsum("ij,ij->j", shares, shares)
        along = flat.T @ np.concatenate([residual.real, residual.imag])
        good = after > 1e-6 * before
        gain[good] += along[good] ** 2 / after[good]
    found: list[tuple[float, float]] = []
    for i in np.argsort(gain)[::-1]:
        w, z = float(omega[i]), float(zeta[i])
        if all(abs(np.log(w / other)) > max(0.02, z + y) for other, y in found):
            found.append((w, z))
            if len(found) == most:
                break
    return found
