"""Perform plans in simulated twins and on servos."""
