"""Turns BML text into behaviours with times."""
