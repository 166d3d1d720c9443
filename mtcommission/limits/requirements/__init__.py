"""What is required of a move: one file for each requirement, and the register of all."""
