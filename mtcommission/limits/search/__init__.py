"""The search behind ``choose``: ``region``, ``bench``, ``explore``, then ``rounding``.

Nothing is imported here; ``choose.choose_limits`` is the door.
"""
