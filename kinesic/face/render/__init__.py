"""Draws the head with OpenGL, pass by pass."""
