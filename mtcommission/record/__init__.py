"""Commissioning <-> JSON: the record that stays, and that every sheet is printed from.

schema/     the exact shape, a file for each of its parts, with the rules that a field must keep
rules.py    those rules: words, names, lengths, what must not be zero
shape.py    entries <-> JSON, and results -> entries: attributes of the same name
files.py    Record <-> text
build.py    Commissioning -> Record, by data.py, limits.py, loop.py, moves.py, robustness.py
            and what_if.py, which tell only what has another name or form there
read_back.py, verified.py    the machine and limits of a record; what ``verify`` found

Nothing is imported here: reading a record must not load the solvers.
"""
