"""Equations: from a causal graph to sorted assignments and state equations."""
