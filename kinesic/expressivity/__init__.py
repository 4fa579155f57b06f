"""Decides where hands, gaze, torso and face go, and in which manner."""
