"""Turns faces, eyes and speech into tracks of action units."""
