"""The record's exact shape, a file for each of its parts; ``record.py`` is the whole."""
