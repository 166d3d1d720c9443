"""Columns and responses of files -> quantities in SI, with what the user says about them.

What leaves something open, contradicts itself or cannot be true raises InputError with every fault.
"""
