"""Measurements of planned and performed motions: arrival, smoothness, synchrony and tracking."""
