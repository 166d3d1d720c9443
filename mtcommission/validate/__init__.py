"""The paper's numbers and claims beside ours.

paper.py         what the paper prints
cases.py         its problems, solved
*_rows.py        number by number, claim by claim
structure.py     five switches for all forces?
adjoint.py       the adjoint equation apart from the solvers
row.py           one line, and how it is judged
report.py        all rows; JSON
table.py         rows in 80 columns
figures.py       Figs. 4 and 5 again
page.py          rows and figures as one offline page
"""
