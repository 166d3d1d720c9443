"""The search behind ``choose``: where (``region``), what (``bench``), how (``explore``, ``rounding``).

Nothing is imported here; ``choose.choose_limits`` is the door.
"""
