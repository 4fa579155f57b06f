"""Mesh, skin and expression shapes of the head."""
