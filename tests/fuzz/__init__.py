"""Fuzzing of every reader of bytes and text."""
