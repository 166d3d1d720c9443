"""Optimal control on a grid by direct transcription: the cross-check; only door to CasADi."""
