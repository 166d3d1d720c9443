"""Where another mode would explain most of what is left."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mtcommission.identify.fit.lines import Lines
from mtcommission.identify.fit.projection import Projected, weighed_rows

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

RATIOS = (0.003, 0.012, 0.045, 0.15)
"""Damping ratios of the candidates; least squares finds those between."""
STEP = 1.6
"""Distance of the candidates' frequencies, in ζ f."""
MOST_LINES = 3000
"""Of a response with more, every second, third, ... line is searched."""


class Candidates:
    """Poles on a grid, against which residuals are matched."""

    __slots__ = ("_powers", "_shapes", "omega", "zeta")

    def __init__(self, responses: Sequence[Lines]) -> None:
        self.omega, self.zeta = _grid(responses)
        self._shapes: dict[int, ComplexArray] = {}
        self._powers: dict[int, Array] = {}
        for lines in responses:
            grid = id(lines.frequency_hz)
            if grid not in self._shapes:
                shapes = self._shape(lines.s[_chosen(lines)])
                self._shapes[grid] = shapes
                self._powers[grid] = shapes.real**2 + shapes.imag**2

    def _shape(self, s: ComplexArray) -> ComplexArray:
        """1/(s² + 2 ζ ω s + ω²) of all candidates, shape (n_lines, n_candidates)."""
        denominators: ComplexArray = s[:, None] * (2 * self.zeta * self.omega)
        denominators += (s * s)[:, None] + self.omega**2
        return np.reciprocal(denominators, out=denominators)

    def best(
        self, responses: Sequence[Lines], known: Projected, *, most: int
    ) -> list[tuple[float, float]]:
        """Return ω and ζ of the modes that would lower the misfit most, best first.

        The misfit that a mode of given pole takes away is (c · r)²/(c · c), with c its column less
        what b, the known modes and R can do: a matched filter on all poles of a grid, so that a
        mode between two lines is found by its flanks.
        """
        fall = np.zeros(self.omega.size)
        for place, (lines, residual) in enumerate(zip(responses, known.residuals, strict=True)):
            grid, chosen = id(lines.frequency_hz), _chosen(lines)
            rows = weighed_rows(lines, known.poles, place)[:, chosen]
            # The last row is the weight alone: that of R.
            weight, half = rows[-1], rows.shape[1]
            stacked = np.concatenate([rows.real, rows.imag], axis=1).T
            q, _ = np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))
            turned = np.conj(weight)[:, None] * np.column_stack(
                [q[:half] + 1j * q[half:], residual[chosen]]
            )
            along = (np.conj(turned.T) @ self._shapes[grid]).real
            before = np.abs(weight) ** 2 @ self._powers[grid]
            after = before - np.sum(along[:-1] ** 2, axis=0)
            good = after > 1e-6 * before
            fall[good] += along[-1, good] ** 2 / after[good]
        found: list[tuple[float, float]] = []
        for i in np.argsort(fall)[::-1]:
            w, z = float(self.omega[i]), float(self.zeta[i])
            if all(abs(np.log(w / other)) > max(0.02, z + y) for other, y in found):
                found.append((w, z))
                if len(found) == most:
                    break
        return found


def _chosen(lines: Lines) -> slice:
    return slice(None, None, 1 + lines.size // MOST_LINES)


def _grid(responses: Sequence[Lines]) -> tuple[Array, Array]:
    """ω and ζ of all candidates, shape (n_candidates,)."""
    low = 2 * np.pi * min(float(lines.frequency_hz[0]) for lines in responses)
    high = 2 * np.pi * max(float(lines.frequency_hz[-1]) for lines in responses)
    omegas, zetas = [], []
    for zeta in RATIOS:
        count = max(2, int(np.log(high / low) / np.log1p(STEP * zeta)))
        omegas.append(np.geomspace(low, high, count))
        zetas.append(np.full(count, zeta))
    return np.concatenate(omegas), np.concatenate(zetas)
