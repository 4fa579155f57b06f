"""Scheduling and merging of several BML blocks, as pure functions."""
