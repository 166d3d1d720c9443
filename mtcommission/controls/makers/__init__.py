"""One file for each control: what it has and where that was read, its rows, its notes."""
