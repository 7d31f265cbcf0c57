"""Diagnosis: is a model adequate; if not, where it fails, what is missing, how sure."""
