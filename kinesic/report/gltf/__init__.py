"""Writes a performance as glTF, for Blender, three.js, Unity and whatever else reads it."""
