"""What each kind of control has: the loop is tuned, simulated and exported within that."""
