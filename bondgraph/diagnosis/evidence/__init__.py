"""Evidence: candidates on data they were not fitted to, and which to believe."""
