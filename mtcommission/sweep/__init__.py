"""Thousands of operating points: ``cases``, ``pieces``, ``engine``, ``store``, ``table``, ``page``.

``cases.Plan`` says what varies, ``engine.run_sweep`` computes what is not on disk yet, and
``table.read_table`` returns the columns; its example is a whole sweep. Nothing is imported here,
so that a worker loads no more than its work needs. With ``Engine(workers=2)`` a script needs the
``if __name__ == "__main__"`` guard of multiprocessing.

A Dask cluster on this machine takes two commands, ``dask scheduler`` and
``dask worker tcp://127.0.0.1:8786 --nworkers 2 --nthreads 1``; then
``Engine(scheduler="tcp://127.0.0.1:8786")`` or ``--scheduler`` uses it.
"""
