"""What the chosen limits do: verdict, robustness, comparison, and what would be attainable."""
