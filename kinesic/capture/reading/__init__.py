"""Readers of motion files: pure functions from bytes to a clip."""
