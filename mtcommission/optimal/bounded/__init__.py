"""Time-optimal control under bounds on states and outputs: exact, and proved."""
