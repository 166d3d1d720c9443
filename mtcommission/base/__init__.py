"""What everything stands on: errors, messages, units, files, pages."""
