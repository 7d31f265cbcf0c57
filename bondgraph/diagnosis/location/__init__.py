"""Where something is missing: signals recovered at every place, and their laws.

A free signal explains anything anywhere; only at the true place is it a law of what is
local there.
"""
