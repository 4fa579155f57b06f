"""Pacing of gestures: spacing, rhythm, and variety over time."""
