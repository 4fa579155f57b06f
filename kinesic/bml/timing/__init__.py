"""Solves the constraints between sync points, so that each has its time."""
