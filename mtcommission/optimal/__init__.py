"""The physical optimum of a move on a plant."""
