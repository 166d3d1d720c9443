"""Responses of one state of the machine -> rigid mass, delay and modes with common poles.

fitted.py      what comes out
lines.py       what the fit sees of a response: lines in a band, with their standard errors
projection.py  least squares in the poles, everything linear eliminated; covariance
noise.py       what a residual is worth
order.py       how many modes, and where another one would explain most
band.py        which lines
fit.py         the whole
peaks.py       the peaks of a spectrum without phase and force
"""
