"""A move recorded on the machine beside the record of a run: did it work, and if not, why."""
