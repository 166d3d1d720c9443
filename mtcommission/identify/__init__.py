"""Measured responses of an axis -> its mass, delay and modes, with intervals."""
