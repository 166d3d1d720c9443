"""Commissioning <-> JSON: the record that stays, and that every sheet is printed from.

schema/     the exact shape, a file for each part
build.py    Commissioning -> Record, one part each by data.py, optima.py, limits.py, loop.py,
            moves.py, comparisons.py
files.py    Record <-> text

Nothing is imported here: reading a record must not load the solvers.
"""
