"""Rendering of robot pictures: camera framing, face screen, light and shadow."""
