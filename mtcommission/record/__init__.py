"""Commissioning <-> JSON: the record that stays, and that every sheet is printed from.

values.py, machine.py, moves.py, limits.py, loop.py, optima.py, robustness.py, what_if.py,
identified.py    a part each: its tables, and what fills them from results
record.py        the whole: built, and read back
shape.py         tables <-> JSON, results -> tables; rules.py: what a field must keep
files.py         JSON files, sealed by a checksum
read_back.py, verified.py    the machine and limits of a record; what ``verify`` found

A field of a table has the name of the result's attribute, or says where that is found (``of``).
"""
