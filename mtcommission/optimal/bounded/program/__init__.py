"""Linear programs, and the even grid that begins the search."""
