"""Reads and writes all servos of a bus in one cycle, whatever goes wrong on its wire."""
