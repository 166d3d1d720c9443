"""Machine and its parts: frozen, in SI; its corners, variations and plausibility."""
