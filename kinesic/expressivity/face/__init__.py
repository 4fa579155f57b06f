"""Conversion of face behaviours, gaze and speech to action unit tracks."""
