"""Skin and face of the human figure, packed for page scripts."""
