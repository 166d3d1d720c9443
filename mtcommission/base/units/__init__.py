"""Every conversion factor, the symbols that people write, and the units of an axis."""
