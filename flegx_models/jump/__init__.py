"""The jump."""
