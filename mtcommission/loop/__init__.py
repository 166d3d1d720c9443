"""Plant + controller + Setpoint -> LoopResponse: what of a setpoint reaches the tool.

controller.py   the cascade with every gain resolved
sampled.py      one position cycle of the loop, as arithmetic and as matrices
response.py     a setpoint through the loop, judged by the definitions of the interface
superposition.py  the same for thousands of setpoints at once
analysis.py     poles, margins, bandwidth                 } the only doors
tuning.py       what the profile leaves out               } to python-control
"""
