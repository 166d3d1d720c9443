"""The paper's numbers and claims beside ours.

paper.py   what the paper prints: numbers and claims; one line of the comparison, and its verdict
cases.py   its problems, solved
adjoint.py the adjoint equation apart from the solvers
free.py    rows of secs. 2 to 5.1: plant, time-optimal control, its switches over the force
bounded.py rows of secs. 5.2 and 6: bound on the tower's rate, damping-optimal control
loops.py   rows of secs. 3 and 7: the feedback loop
page.py    all rows: in 80 columns, as JSON, as one offline page with Figs. 4 and 5
"""
