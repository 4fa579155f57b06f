"""Fit of servo parameters to the log of a performance."""
