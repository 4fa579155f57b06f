"""Solves one arm: shoulder, elbow and wrist in closed form, and a polish inside the limits."""
