"""Adequate or not: whether what a fit leaves is noise, or follows the machine."""
