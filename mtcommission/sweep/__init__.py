"""Thousands of operating points: cases, engine, store, table.

``Plan`` says what varies, ``run_sweep`` computes what is not on disk yet, ``read_table`` returns
the columns.

    plan = Plan(profile_text=text, where="machine.toml", axes=(read_axis(...),))
    store = run_sweep(plan, folder=Path("sweep"), engine=Engine(workers=2))
    frame = read_table(plan, store).frame
"""
