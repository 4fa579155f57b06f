"""Searches designs of a robot: variants of its file, what each is worth, and which are not beaten."""
