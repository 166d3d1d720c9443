"""Makes the two files that README's commands begin and end with.

    python -m tests.measured_example response > profiles/modal-two-modes.csv
    python -m tests.measured_example move out/record.json > profiles/modal-two-modes-move.csv

For the response a second program plays the drive: scipy simulates the gantry in time, with a mass,
modes and viscous friction of its own, under the force of a multisine and noise of the encoder;
NumPy averages the periods. Nothing of the package is used. The move is that of the record of
README's ``run`` on a machine that is a little heavier and softer than the one that was identified:
made anew where the recommended limits change.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, dlsim

from mtcommission.record.read_back import read_limits
from mtcommission.record.record import load_record
from mtcommission.verify.prediction import rebuild
from tests.recorded_traces import Spoilt, record_moves

MASS, FRICTION = 338.0, 150.0
"""[kg; N s/m]."""
MODES = ((36.6, 0.019, 7.4e-4), (83.5, 0.031, 1.6e-4))
"""Frequency [Hz], damping ratio and gain at the encoder [1/kg]."""
STEP, SIZE, PERIODS = 5e-4, 4096, 8
LOWEST_HZ, HIGHEST_HZ = 3.0, 300.0
FORCE, NOISE = 150.0, 1e-4
"""RMS of the force and of the encoder's velocity [N; m/s]."""
SAYS = """\
# Computed, not measured: tests/measured_example.py simulates the gantry of modal-two-modes.toml
# with a mass and modes of its own, under a multisine, and averages eight periods.
# sensor = encoder
# averages = 8
frequency_hz,re [m/s/N],im [m/s/N],coherence
"""

PAYLOAD, SOFTER = 30.0, 0.985
"""Of the machine that moves: mass on the axis [kg], and its frequencies by the identified ones."""
MOVED = """\
# Computed, not measured: tests/measured_example.py simulates a move with the limits that README's
# run recommends, with 30 kg on the axis and frequencies 1.5 % lower than identified.
t [ms],x_ref [mm],encoder [mm],tcp [mm],force [N]
"""

Array = NDArray[np.float64]


def simulate(force: Array) -> Array:
    """Velocity of the encoder, the force held between samples."""
    size = 1 + 2 * len(MODES)
    A, B, C = np.zeros((size, size)), np.zeros((size, 1)), np.zeros((1, size))
    A[0, 0], B[0, 0], C[0, 0] = -FRICTION / MASS, 1.0 / MASS, 1.0
    for place, (hertz, zeta, gain) in zip(range(1, size, 2), MODES, strict=True):
        omega = 2 * np.pi * hertz
        A[place, place + 1] = 1.0
        A[place + 1, place : place + 2] = -(omega**2), -2 * zeta * omega
        B[place + 1, 0], C[0, place + 1] = 1.0, gain
    discrete = cont2discrete((A, B, C, np.zeros((1, 1))), STEP)
    return np.asarray(dlsim(discrete, force[:, None])[1][:, 0])


def table() -> str:
    """The file."""
    rng = np.random.default_rng(5)
    f = np.fft.rfftfreq(SIZE, STEP)
    lines = np.flatnonzero((f >= LOWEST_HZ) & (f <= HIGHEST_HZ))
    spectrum = np.zeros(f.size, dtype=complex)
    spectrum[lines] = np.exp(2j * np.pi * rng.uniform(size=lines.size))
    force = np.fft.irfft(spectrum)
    force *= FORCE / force.std()
    # The first two periods are left to settle.
    velocity = simulate(np.tile(force, PERIODS + 2))[2 * SIZE :].reshape(PERIODS, SIZE)
    velocity = velocity + NOISE * rng.normal(size=velocity.shape)
    U, Y = np.fft.rfft(force)[lines], np.fft.rfft(velocity)[:, lines]
    H = Y.mean(axis=0) / U
    noise = np.var(Y, axis=0, ddof=1)
    gamma2 = 1.0 / (1.0 + noise / np.abs(Y.mean(axis=0)) ** 2)
    columns = zip(f[lines], H.real, H.imag, gamma2, strict=True)
    rows = (f"{a:.6g},{b:.5e},{c:.5e},{d:.6f}\n" for a, b, c, d in columns)
    return SAYS + "".join(rows)


def move(record: Path) -> str:
    """The file of a move, sampled at the position cycle."""
    loaded = load_record(record)
    how = Spoilt(payload=PAYLOAD, frequency=SOFTER, noise=2e-7, step=1e-3, dwell=1.0, seed=1)
    columns = record_moves(rebuild(loaded), read_limits(loaded.limits.recommended), how)
    rows = zip(*columns.values(), strict=True)
    return MOVED + "".join(
        f"{1e3 * t:.0f},{1e3 * x:.5f},{1e3 * encoder:.5f},{1e3 * tcp:.4f},{force:.0f}\n"
        for t, x, encoder, tcp, force in rows
    )


if __name__ == "__main__":
    kind, *files = sys.argv[1:]
    sys.stdout.write(table() if kind == "response" else move(Path(files[0])))
