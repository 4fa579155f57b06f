"""Sweeps of one parameter with measurements in the twin."""
