"""Time-optimal control without limits on states: exact, and proved."""
