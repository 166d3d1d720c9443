"""Optima, rules and search -> the acceleration and jerk limits to type in."""
