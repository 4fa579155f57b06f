"""Fits the twin to the log of a performance: which figures, which can be told apart, and their values."""
