"""Axes that move together: one setpoint filter, one delay, limits; circle and corner.

Read ``group.py`` first: from two or three machines to what the control is told, and what circles
and corners then do.
"""
