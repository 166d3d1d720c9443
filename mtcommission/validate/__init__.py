"""The paper's numbers and claims beside ours.

printed.py what the paper prints: its numbers, and a table of its claims
cases.py   its problems, solved
row.py     one number or claim, and how it is judged
adjoint.py the adjoint equation apart from the solvers
free.py    rows of secs. 2 to 5.1: plant, time-optimal control, its switches over the force
bounded.py rows of secs. 5.2 and 6: bound on the tower's rate, damping-optimal control
loops.py   rows of secs. 3 and 7: the feedback loop
page.py    all rows: in 80 columns, as JSON, as one offline page with Figs. 4 and 5
"""
