"""Motions read from and written to files."""
