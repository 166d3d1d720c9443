"""Files of drives, controls and analysers -> records, responses and spectra in SI.

Read alike by all that put a machine beside its model, with the least squares that they share.
"""
