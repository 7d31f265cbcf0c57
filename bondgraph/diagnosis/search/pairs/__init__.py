"""Two laws at once, where none alone is supported."""
