"""Rendering of the face from action units, to windows or files."""
