# Numerical settings, by their names in the record.

setting-gain-margin-db = Gain margin demanded
setting-phase-margin-deg = Phase margin demanded
setting-reserve-deg = Phase kept in reserve for the state feedback
setting-sensitivity-peak = Sensitivity peak allowed
setting-position-ratios = Kv m / Kp tried
setting-integral-ratios = Tn Kp / m tried
setting-least-integral-share = Kp Kv / Tn over that of the classic rule, at least
setting-longest-integral-time = Longest Tn proposed, but by the classic rule
setting-mode-weights = Weights of the tool vibration tried for the state feedback
setting-reduction = Factor from one try of Kp to the next
setting-force-noise = { $axis ->
    [rotary] Torque noise of the observer, relative to F_max
   *[linear] Force noise of the observer, relative to F_max
}
setting-position-noise = Encoder noise of the observer
setting-samples = Machines drawn, at most
setting-seed = Seed of the random numbers
setting-frequency-range = Largest frequency error tried, relative
setting-frequency-points = Frequency errors tried
setting-largest-fraction = Kp tried first, over the symmetrical optimum
setting-mode-noise = Mode noise of the observer, relative to F_max
setting-cells = Cells of the move, at first
setting-parts = { $axis ->
    [rotary] Pieces of a cell at which the torque switches
   *[linear] Pieces of a cell at which the force switches
}
setting-gap = Gap to the proved bound at which refining ends, relative
setting-margin = Share of the band kept free between rows
setting-velocity-margin = Share of max_velocity kept free between points
setting-most-velocity-margin = Share of max_velocity kept free between points, at most
setting-exchanges = Rounds of exchange, at most
setting-time-tolerance = Relative accuracy of the time on given cells
setting-first-contacts = First rows per period of the slowest mode
setting-radians = Samples of the free motion, in radians
setting-most-samples = Samples of a free motion, at most
setting-steps = Steps of the simplex method, at most
setting-frequencies = Frequencies of the spread in the first program
setting-checked-frequencies = Frequencies of the spread that are checked
setting-robust-margin = Share of the band kept free between frequencies

## What they are for

settings-tuning = tuning
settings-robustness = robustness
settings-band = optimum with the band
