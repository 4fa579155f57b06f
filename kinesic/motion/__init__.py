"""Conditions a motion of hinges under limits: key postures in, a certified B-spline out."""
