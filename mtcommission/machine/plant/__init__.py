"""Machine -> Plant: the state space that optimiser and simulation share."""
