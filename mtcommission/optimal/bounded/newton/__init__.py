"""Solving and editing an exact sequence."""
