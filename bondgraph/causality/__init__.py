"""Causality: which end of every bond receives effort, and why."""
