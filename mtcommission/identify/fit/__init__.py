"""Responses of one state of the machine -> rigid mass, delay and modes with common poles.

fitted.py      what comes out
lines.py       what the fit sees of a response: lines in a band, with their standard errors
projection.py  least squares in the poles, everything linear eliminated; covariance
search.py      where another mode would explain most
order.py       how many modes
band.py        which lines
fit.py         the whole
"""
