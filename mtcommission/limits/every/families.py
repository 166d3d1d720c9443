"""The worst of all sizes of a move, from the echo of one jerk step.

All smaller moves of a listed one form families with one free time. With y the echo, D^t a delay by
t, and the first ramp B = (1 - D^t_j) y, per unit of the jerk:

- velocity steps: (1 - D^T) B with T = v/a >= t_j, or (1 - D^t)² y with t = sqrt(v/j) <= t_j where
  a is not reached;
- positioning: (1 - D^T2) of such a change to max_velocity and T2 = L/v; or, where that is not
  reached, (1 - D^(T + t_j)) (1 - D^T) B and (1 - D^2t) (1 - D^t)² y.

Where the free time enters by one delay only, the worst of a family is the largest difference of two
values of one function, at least (and at most) so far apart: two sliding extremes, no search over
sizes. All is linear in the jerk.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from mtcommission.allowance import spend

Array = NDArray[np.float64]


KEPT_RAMPS = 5_000_000
"""Numbers in the ramps that are kept for other times, all together."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """Echoes that are bounded, as shares of what is allowed, per unit of the jerk.

    Parameters
    ----------
    answers
        Shape (n_rows, n_samples) [1 per m/s³]; what has come to rest stays, or grows on as at
        their end.
    wait
        Sample after the last step of the jerk from which a row is judged; less than 0: always.
    longest
        Samples of the longest motion that is looked at.
    """

    answers: Array
    wait: int
    longest: int
    _ramps: dict[int, Array] = field(default_factory=dict)

    def ramp(self, k: int) -> Array:
        """Return the echo of a ramp that takes ``k`` samples; of a step of the jerk for none.

        Shape (n_rows, 2 longest + n_samples): nothing for ``longest`` samples, then the echo, and
        ``longest`` samples beyond its end.
        """
        if 0 not in self._ramps:
            y = self.answers
            slope = y[:, -1:] - y[:, -2:-1]
            later = y[:, -1:] + slope * np.arange(1, self.longest + 1)
            self._ramps[0] = np.hstack([np.zeros((len(y), self.longest)), y, later])
        if k not in self._ramps:
            step = self._ramps[0]
            spend(3.0 * step.size)
            found = step.copy()
            found[:, k:] -= step[:, :-k]
            self._ramps[k] = found
            while len(self._ramps) * step.size > KEPT_RAMPS and len(self._ramps) > 2:
                del self._ramps[list(self._ramps)[1]]  # the oldest behind the step itself
        return self._ramps[k]

    def forget_ramps(self) -> None:
        """Free what can be computed again."""
        self._ramps.clear()

    def worst(self, y: Array, lags: dict[int, float], *, length: int) -> float:
        """Return the largest magnitude of a sum of delayed echoes where it is judged.

        Parameters
        ----------
        y
            From ``ramp``.
        lags
            Weight of each delay [samples].
        length
            Samples from the first to the last step of the jerk.

        Returns
        -------
        float
            [share per m/s³].
        """
        if length > self.longest:
            return 0.0
        begin = self.longest + (length + self.wait if self.wait >= 0 else 0)
        end = self.longest + length + self.answers.shape[1]
        if begin >= end:
            return 0.0  # judged from when all has come to rest
        total = np.zeros((len(y), end - begin))
        spend(total.size * (0.3 * len(lags) + 0.8), calls=len(lags))
        for lag, weight in lags.items():
            part = y[:, begin - lag : end - lag]
            if weight == 1.0:  # without an array in between: most of the search is spent here
                total += part
            elif weight == -1.0:
                total -= part
            else:
                total += weight * part
        return float(max(total.max(initial=0.0), -total.min(initial=0.0)))

    def worst_difference(self, y: Array, *, length: int, least: int, most: int) -> float:
        """Return the largest |(1 - D^T) y| over all T from ``least`` to ``most``.

        Parameters
        ----------
        y
            A sum of echoes on the grid of ``ramp``.
        length
            Samples from the first to the last step of the jerk in ``y``.
        least, most
            Samples.

        Returns
        -------
        float
            [share per m/s³].
        """
        spend(12.0 * y.size)
        worst = 0.0
        most = min(most, self.longest)
        if self.wait < 0:
            # Until T has passed there is y alone.
            alone = y[:, self.longest : self.longest + most]
            worst = float(max(alone.max(initial=0.0), -alone.min(initial=0.0)))
        begin = self.longest + (length + self.wait if self.wait >= 0 else 0)
        end = min(self.longest + length + self.answers.shape[1], y.shape[1])
        if begin >= end or most < least:
            return worst
        first, place = y[:, begin:end], np.arange(begin, end) + least
        place = np.minimum(place, y.shape[1] - 1)
        width = most - least + 1
        origin = -(width // 2)  # the window begins at its sample
        high = maximum_filter1d(y, width, axis=1, mode="nearest", origin=origin)
        low = minimum_filter1d(y, width, axis=1, mode="nearest", origin=origin)
        return max(
            worst,
            float((high[:, place] - first).max(initial=0.0)),
            float((first - low[:, place]).max(initial=0.0)),
        )
