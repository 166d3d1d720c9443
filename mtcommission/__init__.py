"""Acceleration and jerk limits for machine tool axes, from the mechanical model."""

__version__ = "0.1.0"
