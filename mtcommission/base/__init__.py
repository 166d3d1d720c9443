"""What everything stands on: errors, messages, units, files, pages; and the version."""

__version__ = "0.1.0"
