"""Limits through the loop, judged: the same moves, corners and requirements for all limits."""
