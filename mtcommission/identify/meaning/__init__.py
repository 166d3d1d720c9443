"""Columns and responses of files -> quantities in SI, with what the user says about them."""
