"""Fitting: parameters from recordings, with what is and is not known."""
