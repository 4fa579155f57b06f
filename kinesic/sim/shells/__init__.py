"""Smooth housings that robots are drawn in: baked from their descriptions, read, and put into pictures."""
