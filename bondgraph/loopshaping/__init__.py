"""Loopshaping."""
