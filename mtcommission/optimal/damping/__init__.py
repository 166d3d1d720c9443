"""Damping-optimal control: the saturated linear-quadratic problem."""
