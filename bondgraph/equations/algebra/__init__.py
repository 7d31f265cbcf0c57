"""Algebra: exact work on expressions, rows and matrices, without graphs."""
