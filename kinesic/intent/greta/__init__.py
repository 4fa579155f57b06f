"""Greta's settings: lexicons of intentions, baselines and qualifiers."""
