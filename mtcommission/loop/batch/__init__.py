"""Thousands of setpoints, or of machines, at once."""
