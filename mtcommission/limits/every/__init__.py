"""Limits that hold for every smaller move of each listed one, over the continuum of sizes."""
