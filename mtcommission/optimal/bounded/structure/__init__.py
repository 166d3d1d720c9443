"""Structure arcs and touch points from constraint points."""
