"""Newton's method on a recognised sequence of bang arcs, boundary arcs and touch points."""
