"""Commissioning <-> JSON: the record that stays, and that every sheet is printed from.

machine.py, moves.py, optima.py, limits.py, loop.py, identified.py
                 a part each: its tables, and what fills them from results
record.py        the whole: built, and read back
shape.py         results -> tables <-> JSON files, sealed by a checksum
read_back.py     the machine and limits of a record; what ``verify`` found

A field of a table has the name of the result's attribute, or says where that is found (``of``).
"""
