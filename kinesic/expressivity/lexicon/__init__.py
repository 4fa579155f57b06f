"""Reads gestures from files: form, hand shape, path and meaning of each."""
