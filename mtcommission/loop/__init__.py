"""Plant + controller + Setpoint -> LoopResponse: what of a setpoint reaches the tool.

controller.py  the cascade with every gain resolved
sampled.py     one position cycle of the loop, as arithmetic and as matrices
response.py    a setpoint through the loop, judged by the definitions of the interface
tables.py      what thousands of setpoints at once need of a loop
settling.py    their settling times and residuals
extremes.py    their peaks and forces
analysis.py    poles, margins, bandwidth
cascade_tuning.py  the cascade that the profile leaves out
tuning.py      the same with state feedback
continuous.py  the loop without sampling: the only door to python-control
"""
