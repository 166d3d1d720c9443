"""The paper's numbers and claims beside ours.

paper.py        a number or claim that the paper prints, and its verdict beside ours
cases.py        its problems, solved
time_optimal.py rows of secs. 2, 5 and 5.1: plant, time-optimal control, its switches over the force
state_bound.py  rows of sec. 5.2: bound on the tower's rate
damping.py      rows of secs. 4 and 6: damping-optimal control, vibration
feedback.py     rows of secs. 3 and 7: the feedback loop, conclusions
page.py         all rows: as JSON, and as one offline page with Figs. 4 and 5
"""
