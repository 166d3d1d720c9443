"""Many operating points: ``plan``, ``columns``, ``solve``, ``store``, ``engine``, ``table``.

``plan.Plan`` says what varies, ``engine.run_sweep`` computes what is not on disk yet, and
``table.read_table`` returns the columns; ``library.sweep`` is all of it. Nothing is imported here,
so that a worker loads no more than its work needs. With ``Engine(workers=2)`` a script needs the
``if __name__ == "__main__"`` guard of multiprocessing.
"""
