"""Fastest controls to a state from which the free motion keeps the tool within a band."""
